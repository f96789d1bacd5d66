#include <algorithm>
#include <cmath>
#include <string>

#include <accdec/gcode/move_state.hpp>

namespace accdec {
namespace {

constexpr const char* no_feed = "no feed: an F word must come before this move; G94 forgets the feed before it";
constexpr const char* zero_feed = "the feed is zero: F must be greater before this move";

/// m: how precisely an arc in an exact path mode is followed. With chords as fine as the sagitta between two samples of
/// the arc's fastest motion, the arc is driven at nearly that speed. Chord, rounding of the chords' ends, and sagitta
/// between samples take one part each. It is never more than 2 um, except for coarser chords.
double exact_arc_tolerance(double arc_tolerance) {
  return std::min(3.0 * arc_tolerance, std::max(2e-6, arc_tolerance));
}

}  // namespace

double MoveState::chord_distance() const {
  constexpr double least = 1e-9;  // m
  if (control != PathControl::blend) return std::min(arc_tolerance_, exact_arc_tolerance(arc_tolerance_) / 3.0);
  return tolerance > 0.0 ? std::min(arc_tolerance_, std::max(least, tolerance / 8.0)) : arc_tolerance_;
}

void MoveState::send(const ProgramPoint& to, bool rapid, bool inside_arc, std::size_t column) {
  Move move;
  move.to = to;
  move.tolerance = tolerance;
  move.merge = merge;
  move.control = control;
  if (inside_arc && control != PathControl::blend) {
    // Chord ends are no corners of the program.
    move.control = PathControl::blend;
    move.tolerance = exact_arc_tolerance(arc_tolerance_);
  }
  move.plane = plane;
  move.rapid = rapid;
  move.inside_arc = inside_arc;
  move.line = source_.line_number();
  move.column = static_cast<std::uint32_t>(source_.column(column));
  if (!rapid) {
    const double feed_unit = rotary_only(position, to) ? 1e-3 : unit;
    move.duration = feed_duration(position, to, feed * feed_unit / 60.0);
  }
  sink_.move(move);
  position = to;
}

void MoveState::require_feed(std::size_t column) const {
  if (feed <= 0.0) source_.fail(column, fed ? zero_feed : no_feed);
}

void MoveState::straight(const ProgramPoint& to, bool rapid, std::size_t column) {
  if (!rapid) require_feed(column);
  send(to, rapid, false, column);
}

void MoveState::arc(Arc arc, bool clockwise, int turns, const double* radius, std::size_t column) {
  require_feed(column);
  arc.from = position;
  arc.first = first_axis(plane);
  arc.second = second_axis(plane);
  arc.rounding = unit > 2e-3 ? arc_rounding_inch : arc_rounding_mm;
  const ArcProblem problem =
      radius != nullptr ? arc_by_radius(arc, clockwise, *radius, turns) : arc_by_center(arc, clockwise, turns);
  const auto distance = [&](const ProgramPoint& p) {
    return std::hypot(p[arc.first] - arc.center_first, p[arc.second] - arc.center_second) / unit;
  };
  switch (problem) {
    case ArcProblem::none: break;
    case ArcProblem::radius_zero: source_.fail(column, "impossible arc: its radius is 0 (below 0.00127 mm)");
    case ArcProblem::radius_differs:
      source_.fail(column, "impossible arc: radius " + std::to_string(distance(arc.from)) + " at its start, " +
                               std::to_string(distance(arc.to)) + " at its end, more apart than " +
                               std::to_string(arc.rounding / unit) + " and 0.1 %");
    case ArcProblem::radius_too_small:
      source_.fail(column, "impossible arc: its ends are more than twice the radius apart");
    case ArcProblem::same_end:
      source_.fail(column, "impossible arc: a full circle needs its centre (I J K), not a radius");
  }
  const int chords = chord_count(arc, chord_distance());
  if (chords == 0) source_.fail(column, "arc of more than 10 million chords: the arc tolerance is too small for it");
  sink_.arc(arc, chords);
  for (int i = 1; i <= chords; ++i) send(chord_end(arc, i, chords), false, i < chords, column);
}

void MoveState::spline(const std::vector<ControlPoint>& control, int order, std::size_t column) {
  require_feed(column);
  const auto points = flatten_spline(control, order, chord_distance());
  if (points.empty())
    source_.fail(column, "spline of more than 10 million chords: the arc tolerance is too small for it");
  ProgramPoint to = position;
  for (const auto& point : points) {
    to[0] = point[0];
    to[1] = point[1];
    send(to, false, &point != &points.back(), column);
  }
}

}  // namespace accdec
