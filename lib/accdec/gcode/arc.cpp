#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/gcode/arc.hpp>

namespace accdec {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double relative_rounding = 1e-3;
constexpr double smallest_radius = 0.00005 * 0.0254;  // m
constexpr double radius_rounding = 1e-5;              // m, half the excess of a chord over the diameter
constexpr double circle_fuzz = 1e-6;                  // rad

struct Polar {
  double radius, angle;
};
Polar polar(const Arc& arc, const ProgramPoint& p) {
  const double x = p[arc.first] - arc.center_first, y = p[arc.second] - arc.center_second;
  return {std::hypot(x, y), std::atan2(y, x)};
}

/// A spiral r(w) bends by at most |p''(w)| = hypot(r, 2 r').
double largest_bend(const Arc& arc) {
  const double a = polar(arc, arc.from).radius, b = polar(arc, arc.to).radius;
  return std::hypot(std::max(a, b), 2.0 * (b - a) / arc.angle);
}

}  // namespace

ArcProblem arc_by_center(Arc& arc, bool clockwise, int turns) {
  const Polar a = polar(arc, arc.from), b = polar(arc, arc.to);
  if (!(a.radius >= smallest_radius && b.radius >= smallest_radius)) return ArcProblem::radius_zero;
  const double larger = std::max(a.radius, b.radius), difference = std::abs(a.radius - b.radius);
  if (!(difference <= std::max(arc.rounding, relative_rounding * larger) && difference <= 100.0 * arc.rounding)) {
    return ArcProblem::radius_differs;
  }
  double angle = clockwise ? a.angle - b.angle : b.angle - a.angle;
  if (angle < 0.0) angle += full_turn;
  if (angle < std::max(circle_fuzz, arc.same / larger)) angle += full_turn;
  angle += full_turn * (turns - 1);
  arc.angle = clockwise ? -angle : angle;
  return ArcProblem::none;
}

ArcProblem arc_by_radius(Arc& arc, bool clockwise, double radius, int turns) {
  const double x = arc.to[arc.first] - arc.from[arc.first], y = arc.to[arc.second] - arc.from[arc.second];
  const double chord = std::hypot(x, y), r = std::abs(radius);
  if (!(r >= smallest_radius)) return ArcProblem::radius_zero;
  if (chord <= arc.same) return ArcProblem::same_end;
  if (!(0.5 * chord <= r + radius_rounding)) return ArcProblem::radius_too_small;
  const double height = std::sqrt(std::max(0.0, (r - 0.5 * chord) * (r + 0.5 * chord)));
  // Up to half a turn clockwise has the centre to the right of the chord; each of the other choices changes sides.
  const double side = (clockwise == (radius > 0.0)) ? 1.0 : -1.0;
  arc.center_first = arc.from[arc.first] + 0.5 * x + side * height * y / chord;
  arc.center_second = arc.from[arc.second] + 0.5 * y - side * height * x / chord;
  // Not from the angles of the ends: those of a short chord on a large circle cancel.
  const double half = 2.0 * std::atan2(0.5 * chord, height);
  const double angle = (radius > 0.0 ? half : full_turn - half) + full_turn * (turns - 1);
  arc.angle = clockwise ? -angle : angle;
  return ArcProblem::none;
}

int chord_count(const Arc& arc, double tolerance) {
  const double r = largest_bend(arc);
  // 2 acos(1 - t/r) without its cancellation.
  const double step = std::min(4.0 * std::asin(std::sqrt(std::min(1.0, 0.5 * tolerance / r))), 0.5 * std::numbers::pi);
  const double count = std::ceil(std::abs(arc.angle) / step - 1e-9);
  return count <= 1e7 ? std::max(1, static_cast<int>(count)) : 0;
}

double chord_distance(const Arc& arc, int chords) {
  const double sine = std::sin(0.25 * arc.angle / chords);
  return 2.0 * largest_bend(arc) * sine * sine;
}

ProgramPoint chord_end(const Arc& arc, int i, int n) {
  if (i == n) return arc.to;
  const Polar a = polar(arc, arc.from), b = polar(arc, arc.to);
  const double t = static_cast<double>(i) / n, radius = a.radius + t * (b.radius - a.radius);
  const double angle = a.angle + t * arc.angle;
  ProgramPoint p;
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = arc.from[k] + t * (arc.to[k] - arc.from[k]);
  p[arc.first] = arc.center_first + radius * std::cos(angle);
  p[arc.second] = arc.center_second + radius * std::sin(angle);
  return p;
}

}  // namespace accdec
