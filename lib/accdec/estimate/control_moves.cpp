#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <accdec/estimate/control_moves.hpp>

namespace accdec {
namespace {

Vector point_at(const Toolpath& path, std::size_t i) {
  Vector point(path.begin[0], path.begin[1], path.begin[2]);
  for (std::size_t a = 0; a < path.axes.size() && path.axes[a] < 3; ++a)
    point[static_cast<Eigen::Index>(path.axes[a])] = path.point(i)[a];
  return point;
}

OtherAxes others_way(const Toolpath& path, std::size_t from, std::size_t to) {
  OtherAxes way{};
  for (std::size_t a = 0; a < path.axes.size(); ++a) {
    if (path.axes[a] > 2) way[path.axes[a] - 3] = path.point(to)[a] - path.point(from)[a];
  }
  return way;
}

/// Whether words hold an M code, comments left out.
bool has_m_code(std::string_view words) {
  int depth = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const char c = words[i];
    if (c == ';') return false;
    if (c == '(') ++depth;
    if (c == ')') --depth;
    if (depth == 0 && (c == 'M' || c == 'm')) return true;
  }
  return false;
}

/// A block that is a line.
ControlMove line_of(const Toolpath& path, std::size_t b) {
  ControlMove move;
  move.from = point_at(path, b);
  move.to = point_at(path, b + 1);
  move.length = (move.to - move.from).norm();
  move.first = move.last = move.length > 0.0 ? Vector((move.to - move.from) / move.length) : Vector::UnitX();
  move.others = others_way(path, b, b + 1);
  const auto& [turn_a, turn_b, turn_c, u, v, w] = move.others;
  if (move.length == 0.0) move.length = std::hypot(u, v, w);
  if (move.length == 0.0) move.length = std::hypot(turn_a, turn_b, turn_c);
  move.feed = move.length / path.duration[b];
  move.rapid = path.rapid[b] != 0;
  return move;
}

/// The direction at a part of an arc's angle.
Vector tangent(const ControlMove& arc, double part) {
  const Vector out = arc_point(arc, part) - arc.center;
  Vector turn = (arc.to - arc.from) / std::abs(arc.angle);
  turn[arc.x] = arc.angle > 0.0 ? -out[arc.y] : out[arc.y];
  turn[arc.y] = arc.angle > 0.0 ? out[arc.x] : -out[arc.x];
  return turn.normalized();
}

ControlMove arc_of(const Toolpath& path, const PathArc& from) {
  ControlMove move;
  move.arc = true;
  move.from = point_at(path, from.first);
  move.to = point_at(path, from.last + 1);
  move.others = others_way(path, from.first, from.last + 1);
  move.x = static_cast<Eigen::Index>(path.axes[from.x]);
  move.y = static_cast<Eigen::Index>(path.axes[from.y]);
  move.center[move.x] = from.center_x;
  move.center[move.y] = from.center_y;
  move.radius = from.radius;
  double chords = 0.0, duration = 0.0;
  for (std::size_t b = from.first; b <= from.last; ++b) {
    const Vector p = point_at(path, b) - move.center, q = point_at(path, b + 1) - move.center;
    const double cross = p[move.x] * q[move.y] - p[move.y] * q[move.x];
    move.angle += std::atan2(cross, p[move.x] * q[move.x] + p[move.y] * q[move.y]);
    chords += (q - p).norm();
    duration += path.duration[b];
  }
  Vector rise = move.to - move.from;
  rise[move.x] = rise[move.y] = 0.0;
  move.length = std::hypot(move.radius * move.angle, rise.norm());
  move.feed = chords / duration;
  move.first = tangent(move, 0.0);
  move.last = tangent(move, 1.0);
  return move;
}

}  // namespace

Vector arc_point(const ControlMove& arc, double part) {
  const double turn = part * arc.angle, c = std::cos(turn), s = std::sin(turn);
  const Vector start = arc.from - arc.center;
  Vector point = arc.from + part * (arc.to - arc.from);
  point[arc.x] = arc.center[arc.x] + c * start[arc.x] - s * start[arc.y];
  point[arc.y] = arc.center[arc.y] + s * start[arc.x] + c * start[arc.y];
  return point;
}

std::vector<ControlMove> control_moves(const Toolpath& path, std::string_view control) {
  for (const std::size_t axis : path.axes) {
    if (axis > 2 && control != "linuxcnc-2.9")
      throw std::invalid_argument(
          fmt::format("the estimate for {} knows moves of X, Y and Z only; the program also moves {}", control,
                      program_axes[axis]));
  }
  std::vector<ControlMove> moves;
  auto arc = path.arcs.begin();
  auto mode = path.modes.begin();
  auto words = path.kept_words.begin();
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const bool curve = arc != path.arcs.end() && arc->first == b;
    ControlMove& move = moves.emplace_back(curve ? arc_of(path, *arc) : line_of(path, b));
    if (curve) b = (arc++)->last;
    while (mode != path.modes.end() && std::next(mode) != path.modes.end() && std::next(mode)->block <= b) ++mode;
    if (mode != path.modes.end()) {
      move.control = mode->control;
      move.tolerance = std::max(0.0, mode->tolerance);
      move.merge = mode->merge < 0.0 ? move.tolerance : mode->merge;
    }
    for (const auto& [block, time] : path.dwells_at(b)) move.dwell += time;
    move.dwells = !path.dwells_at(b).empty();
    while (words != path.kept_words.end() && words->block <= b) ++words;
    for (auto next = words; next != path.kept_words.end() && next->block == b + 1; ++next)
      move.waits = move.waits || (!next->dwell && has_m_code(next->words));
  }
  moves.back().ends = true;
  return moves;
}

ControlLimits control_limits(const Toolpath& path, const Machine& machine, std::string_view control) {
  ControlLimits limits{Vector::Constant(unlimited), Vector::Constant(unlimited)};
  limits.other_velocity.fill(unlimited);
  limits.other_acceleration.fill(unlimited);
  for (std::size_t a = 0; a < program_axis_count; ++a) {
    const Axis* axis = find_axis(machine, a);
    const bool moves = std::find(path.axes.begin(), path.axes.end(), a) != path.axes.end();
    if (axis != nullptr) {
      const auto i = static_cast<Eigen::Index>(a);
      (a < 3 ? limits.velocity[i] : limits.other_velocity[a - 3]) = axis->velocity_max;
      (a < 3 ? limits.acceleration[i] : limits.other_acceleration[a - 3]) = axis->acceleration_max;
    }
    if (moves && !(axis != nullptr && axis->acceleration_max < unlimited))
      throw std::invalid_argument(fmt::format("the estimate for {} needs acceleration_max_mm_s2 of axis {} in the task",
                                              control, program_axes[a]));
  }
  return limits;
}

double along(const Vector& direction, const Vector& limits) {
  double most = unlimited;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double part = std::abs(direction[a]);
    if (part > 0.0) most = std::min(most, limits[a] / part);
  }
  return most;
}

bool moves_others(const ControlMove& move) {
  return std::any_of(move.others.begin(), move.others.end(), [](double way) { return way != 0.0; });
}

double along_others(const ControlMove& move, const OtherAxes& limits) {
  double most = unlimited;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (move.others[i] != 0.0) most = std::min(most, limits[i] * move.length / std::abs(move.others[i]));
  }
  return most;
}

double trapezoid_time(double length, double from, double cruise, double to, double acceleration) {
  if (length <= 0.0) return 0.0;
  if (std::abs(to * to - from * from) >= 2.0 * acceleration * length) return 2.0 * length / (from + to);
  const double peak =
      std::min(std::max({cruise, from, to}), std::sqrt(acceleration * length + 0.5 * (from * from + to * to)));
  const double ramps = (2.0 * peak * peak - from * from - to * to) / (2.0 * acceleration);
  return (2.0 * peak - from - to) / acceleration + std::max(0.0, length - ramps) / peak;
}

}  // namespace accdec
