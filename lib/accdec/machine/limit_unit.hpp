#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>

// Internal: limits of an axis as people read them. Axes a, b and c turn: they are in degrees where others are in
// millimetres, and have torques where others have forces. Results in JSON and Python are in SI: rad and N m.

namespace accdec {

/// Whether an axis of this name turns.
constexpr bool is_rotary(std::string_view axis_name) {
  return axis_name.size() == 1 && std::string_view("abcABC").find(axis_name) != std::string_view::npos;
}

struct LimitUnit {
  std::string_view name;
  double per_si = 1.0;  ///< value in the unit = per_si * value in SI
};
/// @param axis  its name, empty where a limit is of none
constexpr LimitUnit limit_unit(LimitKind kind, std::string_view axis) {
  const LimitName& linear = limit_name(kind);
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> rotary{
      {{"mm/s", "deg/s"}, {"mm/s^2", "deg/s^2"}, {"mm/s^3", "deg/s^3"}, {"N", "N m"}, {"um", "mdeg"}}};
  if (is_rotary(axis)) {
    for (const auto& [from, to] : rotary) {
      if (from == linear.unit) return {to, find_unit(to)->divisor};
    }
  }
  return {linear.unit, linear.per_si};
}

/// A value of a result file or of Python, in SI, over the value inside, where an axis that turns counts a degree as a
/// millimetre (files/units.hpp). It is in rad for what is moved, in N m for forces.
/// @param axis  its name, empty where a limit is of none
constexpr double si_over_inside(LimitKind kind, std::string_view axis) {
  if (!is_rotary(axis)) return 1.0;
  switch (kind) {
    case LimitKind::velocity:
    case LimitKind::acceleration:
    case LimitKind::jerk:
    case LimitKind::residual: return radians_per_metre;
    case LimitKind::force:
    case LimitKind::force_speed: return 1.0 / radians_per_metre;
    default: return 1.0;  // powers are the same, and ratios
  }
}

/// Why a recorded bound of an axis that turns is not the task's, if it is that of a file from before `si_over_inside`;
/// else empty. @param recorded, found  as inside
inline std::string unit_of_before(LimitKind kind, std::string_view axis, double recorded, double found) {
  const double factor = si_over_inside(kind, axis), then = recorded * factor;
  if (factor == 1.0 || !(std::abs(then - found) <= 1e-12 * std::abs(found))) return "";
  return fmt::format(
      "limits of axis {} are in metres and newtons, a degree for a millimetre, as earlier builds wrote them; they "
      "must be in rad and N m",
      axis);
}

/// The limit's name for people, as in results: "force_speed".
constexpr std::string_view limit_word(LimitKind kind, std::string_view axis) {
  if (is_rotary(axis) && kind == LimitKind::force) return "torque";
  if (is_rotary(axis) && kind == LimitKind::force_speed) return "torque_speed";
  return to_string(kind);
}
/// The key of a limit of an axis in task files.
inline std::string limit_key(const AxisLimit& limit, std::string_view axis) {
  if (!is_rotary(axis)) return std::string(limit.key);
  if (limit.kind == LimitKind::force_speed) return std::string(torque_speed_key);
  return fmt::format("{}_max{}", limit_word(limit.kind, axis), find_unit(limit_unit(limit.kind, axis).name)->suffix);
}

}  // namespace accdec
