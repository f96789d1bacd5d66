#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <accdec/files/units.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/considered_by.hpp>
#include <accdec/machine/force_speed.hpp>

namespace accdec {

/// The state of one axis at one sample, SI.
struct AxisState {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0;  ///< m/s, m/s^2, m/s^3
  double force = 0.0;                                     ///< N, m a + c v + dry friction
  double motoring = 0.0, braking = 0.0;                   ///< W, F v and -F v
  double standstill = 0.0;                                ///< N, the force scaled along the force-speed curve
};
/// Part of the feed below which an axis stands still: its dry friction then takes whatever part of the force helps.
inline constexpr double still_part = 1e-9;

/// Dry friction, N, of an axis that moves with a velocity and needs `moving` N without it. @param still  m/s
inline double dry_friction(const Axis& axis, double velocity, double moving, double still) {
  if (std::abs(velocity) > still) return std::copysign(axis.coulomb, velocity);
  return -std::clamp(moving, -axis.coulomb, axis.coulomb);
}

/// @param still  m/s, up to which the axis stands still
inline AxisState axis_state(const Axis& axis, double velocity, double acceleration, double jerk, double still = 0.0) {
  const double moving = axis.mass * acceleration + axis.damping * velocity;
  const double force = axis.coulomb > 0.0 ? moving + dry_friction(axis, velocity, moving, still) : moving;
  const double power = force * velocity;
  return {velocity, acceleration, jerk, force, power, -power, at_standstill(axis, velocity, force)};
}

/// The same with the load of another motion, that behind the servo (response.hpp).
inline AxisState with_load(AxisState command, const Axis& axis, double velocity, double acceleration,
                           double still = 0.0) {
  const AxisState motion = axis_state(axis, velocity, acceleration, 0.0, still);
  command.force = motion.force, command.motoring = motion.motoring, command.braking = motion.braking;
  command.standstill = motion.standstill;
  return command;
}

/// The states of an axis, one sample after another, starting from steady motion. Only this class keeps what a limit
/// needs from earlier samples.
class AxisSampler {
 public:
  /// Number of earlier samples that a state depends on.
  static constexpr int memory = 1;

  /// @param period  sample period T, s, > 0  @param axis  the reference is kept  @param still  as of `axis_state`
  AxisSampler(const Axis& axis, double period, double still = 0.0) : axis_(&axis), period_(period), still_(still) {}
  /// @param velocity, acceleration  of the next sample, m/s and m/s^2
  AxisState next(double velocity, double acceleration) {
    const double jerk = (acceleration - acceleration_) / period_;
    acceleration_ = acceleration;
    return axis_state(*axis_, velocity, acceleration, jerk, still_);
  }
  /// Skips a sample whose state is not needed.
  void skip(double acceleration) { acceleration_ = acceleration; }

 private:
  const Axis* axis_;
  double period_, still_, acceleration_ = 0.0;
};

/// The key of a limit whose value is a curve, not a number.
inline constexpr std::string_view force_speed_key = "force_speed_N", torque_speed_key = "torque_speed_N_m";

/// A limit of an axis: where its bound is kept and which value is compared with it. To add one, add a line here. The
/// recipe in lib/accdec/README.md names the code that repeats the formula on purpose.
struct AxisLimit {
  LimitKind kind;
  std::string_view key;                 ///< of task files, in the unit of `limit_name`
  double key_max;                       ///< largest value of the key
  double Axis::*bound;                  ///< SI; `unlimited` where there is none
  double (*value)(const AxisState& s);  ///< what must not exceed the bound
  bool load;                            ///< depends on mass and damping
  int degree;                           ///< a motion at c times the speed has c^degree times the value
  int differences = -1;  ///< how often the acceleration is differenced over T to give the value; -1: the value is no
                         ///< such difference
};
// clang-format off
inline constexpr std::array<AxisLimit, 7> axis_limits{{
    {LimitKind::velocity, "velocity_max_mm_s", 1e6, &Axis::velocity_max,
     [](const AxisState& s) { return std::abs(s.velocity); }, false, 1},
    {LimitKind::acceleration, "acceleration_max_mm_s2", 1e8, &Axis::acceleration_max,
     [](const AxisState& s) { return std::abs(s.acceleration); }, false, 1, 0},
    {LimitKind::jerk, "jerk_max_mm_s3", 1e12, &Axis::jerk_max,
     [](const AxisState& s) { return std::abs(s.jerk); }, false, 1, 1},
    {LimitKind::force, "force_max_N", 1e8, &Axis::force_max,
     [](const AxisState& s) { return std::abs(s.force); }, true, 1},
    {LimitKind::power, "power_max_W", 1e8, &Axis::power_max,
     [](const AxisState& s) { return s.motoring; }, true, 2},
    {LimitKind::regeneration, "regeneration_max_W", 1e8, &Axis::regeneration_max,
     [](const AxisState& s) { return s.braking; }, true, 2},
    {LimitKind::force_speed, force_speed_key, 1e8, &Axis::force_speed_max,
     [](const AxisState& s) { return s.standstill; }, true, 1},
}};
// clang-format on
/// Names, factors and keys agree with files/units.hpp.
static_assert([] {
  for (const LimitName& name : limit_names) {
    const Unit* unit = find_unit(name.unit);
    if (unit != nullptr && unit->divisor != name.per_si) return false;
  }
  for (const AxisLimit& limit : axis_limits) {
    const Unit* unit = unit_in_name(limit.key);
    if (unit == nullptr || unit->name != limit_name(limit.kind).unit) return false;
  }
  return true;
}());

/// @throws std::out_of_range unless the kind is one of an axis
constexpr const AxisLimit& axis_limit(LimitKind kind) {
  for (const AxisLimit& limit : axis_limits) {
    if (limit.kind == kind) return limit;
  }
  throw std::out_of_range("not a limit of an axis");
}

/// Weight of the value j samples ago in the n-th difference of a sequence, 0 <= j <= n: (-1)^j n!/(j! (n - j)!).
constexpr double difference_weight(int n, int j) {
  double weight = 1.0;
  for (int i = 0; i < j; ++i) weight *= -static_cast<double>(n - i) / (i + 1);
  return weight;
}
/// Largest `differences` of the table.
inline constexpr int most_differences = [] {
  int most = 0;
  for (const AxisLimit& limit : axis_limits) most = std::max(most, limit.differences);
  return most;
}();

/// Number of samples past a filter's order after which a change of the command no longer affects any limited value. It
/// is one for the velocity and one for each difference. Delays longer than the order plus this number change nothing.
inline constexpr int settling = 1 + most_differences;

/// Whether any axis limits its jerk.
inline bool limits_jerk(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [](const Axis& a) { return a.jerk_max < unlimited; });
}

/// Whether a sample holds every limit of its axis. @param slack  factor on all bounds
inline bool holds(const Axis& axis, const AxisState& state, double slack) {
  return [&]<std::size_t... i>(std::index_sequence<i...>) {
    return (!(axis_limits[i].value(state) > axis.*axis_limits[i].bound * slack) && ...);
  }
  (std::make_index_sequence<axis_limits.size()>{});
}

/// A limit on the power of all axes together.
struct SupplyLimit {
  LimitKind kind;
  std::string_view key;  ///< of the table [machine] of task files, in W
  double Machine::*bound;
};
inline constexpr std::array<SupplyLimit, 2> supply_limits{{
    {LimitKind::power_total, "power_total_max_W", &Machine::power_total_max},
    {LimitKind::regeneration_total, "regeneration_total_max_W", &Machine::regeneration_total_max},
}};

/// Whether the axes share a supply that is limited.
inline bool limits_supply(const Machine& machine) {
  return machine.power_total_max < unlimited || machine.regeneration_total_max < unlimited;
}
/// Whether a mode of an axis is bounded.
inline bool has_mode_of_axis(const Machine& machine) {
  return std::any_of(machine.modes.begin(), machine.modes.end(), [](const Mode& mode) { return mode.of_axis(); });
}
/// Whether any axis has dry friction.
bool has_dry_friction(const Machine& machine);
/// Whether any axis has a force-speed curve.
bool has_force_curve(const Machine& machine);
/// @throws std::invalid_argument if the machine has dry friction, a limited supply, a force-speed curve or a mode of an
/// axis, which `what` does not consider
void require_no_shared_loads(const Machine& machine, const char* what, std::string_view instead = considered_by);
/// @throws std::invalid_argument if the machine has a mode of an axis, which `what` does not consider
void require_no_modes_of_axes(const Machine& machine, const char* what);

/// Whether the axis has any limit at all.
inline bool limited(const Axis& axis) {
  for (const AxisLimit& limit : axis_limits) {
    if (axis.*limit.bound < unlimited) return true;
  }
  return false;
}
/// Whether the axis has a limit of another kind than these.
inline bool limited_beside(const Axis& axis, std::initializer_list<LimitKind> kinds) {
  return std::ranges::any_of(axis_limits, [&](const AxisLimit& limit) {
    return axis.*limit.bound < unlimited && std::ranges::find(kinds, limit.kind) == kinds.end();
  });
}

}  // namespace accdec
