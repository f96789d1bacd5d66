#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/gcode/arc_sequence.hpp>
#include <accdec/gcode/move_sink.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/machine/position_unit.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/simulate.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double longest = 1e9;    // s, of a move or a dwell
constexpr double nothing = 1e-12;  // m; moves shorter than this have no direction worth the name

/// Notes the path mode of the next block where it changes.
void keep_mode(Toolpath& path, const Move& move) {
  if (!path.modes.empty()) {
    const Toolpath::Mode& last = path.modes.back();
    if (last.control == move.control && last.tolerance == move.tolerance && last.merge == move.merge) return;
  }
  path.modes.push_back({static_cast<std::uint32_t>(path.blocks()), move.control, move.tolerance, move.merge});
}

class Builder : public MoveSink {
 public:
  /// @param spline_distance  m, of the chords of splines from them at most
  Builder(const LineSource& source, const Machine& machine, const ToolpathOptions& options, double spline_distance)
      : source_(source), options_(options), spline_distance_(spline_distance) {
    for (std::size_t a = 0; a < program_axis_count; ++a) limits_[a] = find_axis(machine, a);
    given_.limited = !machine.axes.empty();
    given_.servo = has_servo(machine);
  }

  void begin(const ProgramPoint& at) override { path_.begin = position_ = at; }
  void move(const Move& move) override;
  void arc(const Arc& arc, int chords) override { arcs_.begin(arc, chords); }
  void stop(double dwell) override {
    if (!(dwell <= longest)) source_.fail(1, "the dwell takes more than 1e9 s");
    if (dwell > 0.0) keep("G4 P" + plain_number(dwell, 9), true);
    before_.stopped = before_.stopped || dwell == 0.0 || !options_.dwells_before_filter;
    if (dwell > 0.0 && path_.blocks() == 0) path_.dwell_first += dwell;
    if (dwell > 0.0 && path_.blocks() > 0) path_.dwell.emplace_back(path_.blocks() - 1, dwell);
  }
  void pass(std::string_view words, bool with_move) override { keep(std::string(words), false, with_move); }
  void select(std::string_view word) override {
    if (word != "G43")
      system_ = {std::string(word), source_.line_number()};
    else if (!path_.length_at)
      path_.length_at = source_.line_number();
  }
  void frame(bool percent, std::string_view label, std::string_view end) override {
    path_.percent = percent;
    path_.label = label;
    path_.end = end;
  }
  Toolpath finish();

 private:
  void keep(std::string words, bool dwell, bool with_block = false) {
    path_.kept_words.push_back({static_cast<std::uint32_t>(path_.blocks()), std::move(words), dwell, with_block});
  }
  void add_axes(unsigned moving);
  double rapid_duration(const Move& move) const;
  double limited_duration(const Move& move);
  void close_joint(const Move& next, double off);
  double beside_curves(double tolerance, Joint joint, const Move& next, double off);
  double exact_tolerance(std::size_t b) const;
  void give_delay(std::size_t b);
  void keep_arc(std::size_t b);
  void keep_system() {
    const auto same = [&](const Toolpath::Selected& known) { return known.word == system_.word; };
    if (std::none_of(path_.systems.begin(), path_.systems.end(), same)) path_.systems.push_back(system_);
  }
  [[noreturn]] void fail(const Move& move, const std::string& message) const {
    throw ReadError(source_.name(), move.line, move.column, message);
  }
  Joint classify(const double* in, const double* out) const;

  const LineSource& source_;
  const ToolpathOptions& options_;
  const double spline_distance_;
  std::array<const Axis*, program_axis_count> limits_{};
  struct {
    bool limited = false, servo = false;
  } given_;  // by the machine
  Toolpath path_;
  Toolpath::Selected system_{"G54"};  // as controls are when they are switched on
  ProgramPoint position_{};
  ProgramPoint start_{};
  unsigned used_ = 0;  // bit a: axis a has moved
  Move last_;
  struct {
    double off = 0.0;                  // m, of the last block from its arc or spline at most
    std::array<double, 3> feed_way{};  // m, of every plane
    bool stopped = false;
  } before_;
  ArcSequence arcs_;
};

void Builder::add_axes(unsigned moving) {
  used_ |= moving;
  const std::vector<std::size_t> old = path_.axes;
  path_.axes.clear();
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    if ((used_ & (1U << a)) != 0U) path_.axes.push_back(a);
  }
  std::vector<double> points;
  const std::size_t rows = path_.blocks() + 1;
  points.reserve(rows * path_.axes.size() * 2);
  for (std::size_t i = 0; i < rows; ++i) {
    for (const std::size_t a : path_.axes) {
      const auto column = std::find(old.begin(), old.end(), a);
      points.push_back(column == old.end()
                           ? start_[a]
                           : path_.points[i * old.size() + static_cast<std::size_t>(column - old.begin())]);
    }
  }
  path_.points = std::move(points);
  const auto moved = [&](std::size_t& column) {
    column =
        static_cast<std::size_t>(std::find(path_.axes.begin(), path_.axes.end(), old[column]) - path_.axes.begin());
  };
  for (PathArc& arc : path_.arcs) {
    moved(arc.x);
    moved(arc.y);
  }
}

double Builder::rapid_duration(const Move& move) const {
  double duration = 0.0;
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    const double distance = std::abs(move.to[a] - position_[a]);
    if (distance == 0.0) continue;
    if (limits_[a] == nullptr || !(limits_[a]->velocity_max < unlimited)) {
      fail(move, fmt::format("a rapid move needs the velocity limit of axis {} in the task", program_axes[a]));
    }
    duration = std::max(duration, distance / limits_[a]->velocity_max);
  }
  return duration;
}

/// Duration of a feed move: by its feed or, if this is clamped, by the velocity limits.
double Builder::limited_duration(const Move& move) {
  // The digits of coordinates turn a block of a few micrometres by this angle: a feed at a limit would then be above
  // it.
  constexpr double rounding = 1e-5;
  double duration = move.duration;
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    if (limits_[a] == nullptr) continue;
    const double distance = std::abs(move.to[a] - position_[a]), least = distance / limits_[a]->velocity_max;
    if (move.duration * (1.0 + 1e-9) >= least) continue;
    if (!options_.clamp_feeds && move.duration * (1.0 + rounding) < least) {
      fail(move, fmt::format("the feed moves axis {} at {:.6g} mm/s, its limit is {:.6g}", program_axes[a],
                             distance / move.duration * 1e3, limits_[a]->velocity_max * 1e3));
    }
    duration = std::max(duration, least);
  }
  const auto line = static_cast<std::uint32_t>(move.line);
  if (duration > move.duration * (1.0 + (options_.clamp_feeds ? 0.0 : rounding)) &&
      (path_.clamped.empty() || path_.clamped.back() != line))
    path_.clamped.push_back(line);
  return duration;
}

Joint Builder::classify(const double* in, const double* out) const {
  double dot = 0.0, a = 0.0, b = 0.0, cross = 0.0;
  const std::size_t n = path_.dimensions();
  for (std::size_t i = 0; i < n; ++i) {
    dot += in[i] * out[i];
    a += in[i] * in[i];
    b += out[i] * out[i];
    for (std::size_t j = i + 1; j < n; ++j) {
      const double c = in[i] * out[j] - in[j] * out[i];
      cross += c * c;
    }
  }
  if (dot <= 0.0) return Joint::corner;
  // Sine and cosine of the turn, both scaled by the lengths.
  const double sine = std::sqrt(cross), scale = std::sqrt(a * b);
  if (sine <= 1e-9 * scale) return Joint::straight;
  return sine < std::sin(smooth_turn) * scale ? Joint::smooth : Joint::corner;
}

/// Combines the dwells at the end of block b into one delay of its joint; they are removed from the words to write
/// back.
void Builder::give_delay(std::size_t b) {
  double delay = 0.0;
  for (; !path_.dwell.empty() && path_.dwell.back().first == b; path_.dwell.pop_back())
    delay += path_.dwell.back().second;
  if (delay == 0.0) return;
  path_.given_delays.emplace_back(b, delay);
  auto& passed = path_.kept_words;
  auto from = passed.end();
  while (from != passed.begin() && std::prev(from)->block == b + 1) --from;
  passed.erase(std::remove_if(from, passed.end(), [](const Toolpath::KeptWords& p) { return p.dwell; }), passed.end());
}

/// The tolerance of a joint so that a motion is within the program's of arcs and splines if it is within this of their
/// chords. If a curve begins or ends without a corner, its own tolerance holds from there on.
double Builder::beside_curves(double tolerance, Joint joint, const Move& next, double off) {
  if (!options_.room_for_chords) return tolerance;
  if (joint != Joint::corner && off > 0.0 && next.tolerance >= 0.0) tolerance = std::min(tolerance, next.tolerance);
  const double room = std::min(std::max(off, before_.off), 0.5 * tolerance);
  if (!(room > 0.0 && tolerance < unlimited)) return tolerance;
  path_.narrowed = std::max(path_.narrowed, room);
  return tolerance - room;
}

/// Decides on the joint between the last block kept and the one being added, whose end point is already stored.
/// @param off  m, of the next block from its arc or spline at most
void Builder::close_joint(const Move& next, double off) {
  const std::size_t b = path_.blocks() - 1, n = path_.dimensions();
  const double* p = path_.point(b);
  std::array<double, program_axis_count> in{}, out{};
  for (std::size_t i = 0; i < n; ++i) {
    in[i] = p[n + i] - p[i];
    out[i] = p[2 * n + i] - p[n + i];
  }
  Joint joint = classify(in.data(), out.data());
  // No motion behind a servo passes exactly through a corner: there the control waits for the command.
  const bool waits =
      given_.servo && last_.control == PathControl::exact_path && joint != Joint::straight && !arcs_.goes_on();
  const bool stop = before_.stopped || waits || last_.control == PathControl::exact_stop ||
                    (options_.rapid_stops && last_.rapid != next.rapid);
  double tolerance = unlimited;
  if (stop) {
    joint = Joint::stop;
    if (given_.servo && options_.error_max) tolerance = *options_.error_max;
  } else {
    const bool exact = last_.control == PathControl::exact_path;
    tolerance = exact ? exact_tolerance(b) : last_.tolerance;
    if (tolerance < 0.0 && options_.error_max) tolerance = *options_.error_max;
    // The contour then bounds the corners by itself.
    if (tolerance < 0.0 && (joint == Joint::straight || options_.contour_max < unlimited)) tolerance = unlimited;
    if (tolerance < 0.0) {
      fail(last_,
           "the corner at the end of this move has no tolerance; write, in the program before it,\n  G64 P0.01\nor in "
           "the task\n  [program]\n  error_max_um = 10\n(10 um here: the largest error you accept)");
    }
    if (tolerance > 0.0 && tolerance < position_floor)
      fail(last_,
           fmt::format("a tolerance of {:g} mm is less than a simulation can tell from 0; allowed is 0 or {:g} mm "
                       "and more",
                       1e3 * tolerance, 1e3 * position_floor));
    if (!exact) tolerance = beside_curves(tolerance, joint, next, off);
  }
  if (options_.dwells_before_filter && !stop) give_delay(b);
  path_.joint.back() = joint;
  path_.tolerance.back() = tolerance;
}

/// If an arc goes on along the circle of the last one, the path is exact as inside an arc. Else no error is granted.
double Builder::exact_tolerance(std::size_t b) const {
  return arcs_.goes_on() && b > 0 && path_.inside_arc[b - 1] != 0 ? path_.tolerance[b - 1] : 0.0;
}

/// Block b is a chord of the present arc.
void Builder::keep_arc(std::size_t b) {
  const Arc& from = arcs_.arc();
  const auto column = [&](std::size_t axis) {
    return static_cast<std::size_t>(std::find(path_.axes.begin(), path_.axes.end(), axis) - path_.axes.begin());
  };
  const auto block = static_cast<std::uint32_t>(b);
  // An axis of the plane that never moves has no column; then only the chords represent the arc.
  if (column(from.first) == path_.axes.size() || column(from.second) == path_.axes.size()) return;
  const bool same = !path_.arcs.empty() && path_.arcs.back().last + 1 == b && b > 0 && path_.inside_arc[b - 1] != 0;
  if (!same) {
    PathArc& arc = path_.arcs.emplace_back();
    arc.first = block;
    arc.x = column(from.first);
    arc.y = column(from.second);
    arc.center_x = from.center_first;
    arc.center_y = from.center_second;
    const auto radius = [&](const ProgramPoint& p) {
      return std::hypot(p[from.first] - from.center_first, p[from.second] - from.center_second);
    };
    arc.radius = 0.5 * (radius(from.from) + radius(from.to));
    arc.angle = from.angle;
  }
  path_.arcs.back().last = block;
}

void Builder::move(const Move& move) {
  const bool of_arc = arcs_.take();
  unsigned moving = 0;
  double length2 = 0.0;
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    const double distance = move.to[a] - position_[a];
    if (distance == 0.0) continue;
    moving |= 1U << a;
    length2 += distance * distance;
  }
  if (length2 < nothing * nothing) {
    ++path_.empty_moves;
    return;
  }
  if ((moving & ~used_) != 0U) {
    for (std::size_t a = 0; a < program_axis_count; ++a) {
      if ((moving & (1U << a)) != 0U && given_.limited && limits_[a] == nullptr) {
        fail(move, fmt::format("axis {0} is not among the axes of the task{1}", program_axes[a],
                               rotary_axis(a) ? fmt::format(": it is rotary and takes no limits from others; add an "
                                                            "[[axis]] with name = \"{}\": velocity_max_deg_s, "
                                                            "acceleration_max_deg_s2",
                                                            static_cast<char>(program_axes[a] | 0x20))
                                              : ""));
      }
    }
    if (path_.blocks() == 0) start_ = position_;
    add_axes(moving);
  }
  if (path_.blocks() == UINT32_MAX || move.line > UINT32_MAX) fail(move, "more than 4294967295 blocks or lines");
  keep_system();
  const double duration = move.rapid ? rapid_duration(move) : limited_duration(move);
  if (!(duration > 0.0 && duration < longest)) fail(move, "the move takes more than 1e9 s or no time at all");
  for (const std::size_t a : path_.axes) path_.points.push_back(move.to[a]);
  const bool of_spline = !of_arc && (move.inside_arc || (path_.blocks() > 0 && path_.inside_arc.back() != 0));
  const double off = of_arc ? arcs_.distance() : of_spline ? spline_distance_ : 0.0;
  if (path_.blocks() > 0) close_joint(move, off);
  keep_mode(path_, move);
  path_.duration.push_back(duration);
  path_.tolerance.push_back(unlimited);
  path_.joint.push_back(Joint::stop);
  path_.rapid.push_back(move.rapid ? 1 : 0);
  path_.inside_arc.push_back(move.inside_arc ? 1 : 0);
  if (of_arc) keep_arc(path_.blocks() - 1);
  path_.line.push_back(static_cast<std::uint32_t>(move.line));
  if (!move.rapid) before_.feed_way[static_cast<std::size_t>(move.plane)] += std::sqrt(length2);
  position_ = move.to;
  last_ = move;
  before_.off = off;
  arcs_.moved(of_arc);
  before_.stopped = false;
}

Toolpath Builder::finish() {
  if (path_.blocks() == 0) {
    throw ReadError(source_.name(), std::max<std::int64_t>(1, source_.line_number()), 1, "the program does not move");
  }
  path_.plane =
      static_cast<Plane>(std::max_element(before_.feed_way.begin(), before_.feed_way.end()) - before_.feed_way.begin());
  path_.widen_arcs = options_.widen_arcs;
  path_.contour_max = options_.contour_max;
  return std::move(path_);
}

/// Leaves room in the contour for rounding positions to whole numbers of the control's unit.
void round_contour(Toolpath& path, const Machine& machine, const LineSource& source) {
  const double given = path.contour_max;
  path.contour_max = contour_in_units(given, machine, path.dimensions());
  if (path.contour_max > 0.0 || !(machine.position_unit > 0.0)) return;
  throw ReadError(
      source.name(), std::max<std::int64_t>(1, source.line_number()), 1,
      fmt::format("contour_max_um = {:g} of the task leaves nothing beside its position_unit_um = {:g}: "
                  "rounding moves a position by up to {:.4g} um",
                  1e6 * given, 1e6 * machine.position_unit, 1e6 * unit_rounding(machine, path.dimensions())));
}

}  // namespace

Toolpath read_toolpath(LineSource& source, const Machine& machine, const ToolpathOptions& options) {
  auto reading = options.read;
  // As under G64 P, see MoveState.
  const double bound = options.error_max.value_or(options.contour_max);
  if (bound > 0.0) reading.arc_tolerance = std::min(reading.arc_tolerance, std::max(1e-9, bound / 8.0));
  Builder builder(source, machine, options, reading.arc_tolerance);
  read_program(source, reading, builder);
  Toolpath path = builder.finish();
  round_contour(path, machine, source);
  return path;
}

}  // namespace accdec
