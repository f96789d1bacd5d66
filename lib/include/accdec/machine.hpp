// Machines: axes with their limits, vibration modes, and how much of a limit a motion uses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/corner.hpp>

namespace accdec {

/// "No such limit."
inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// A point of a force-speed curve.
struct SpeedForce {
  double speed = 0.0;  ///< m/s
  double force = 0.0;  ///< N
  bool operator==(const SpeedForce&) const = default;
};

/// One machine axis: plant and limits in SI. Limits are > 0 or `unlimited`; mass and damping are finite and >= 0.
struct Axis {
  std::string name;
  double velocity_max = unlimited;      ///< m/s
  double acceleration_max = unlimited;  ///< m/s^2
  double jerk_max = unlimited;          ///< m/s^3, first difference of the acceleration over T
  double mass = 0.0;                    ///< kg, m of F = m a' + c V'
  double damping = 0.0;                 ///< N s/m, c of F = m a' + c V'
  double force_max = unlimited;         ///< N, on |F|
  double power_max = unlimited;         ///< W, on P = F V' (motoring)
  double regeneration_max = unlimited;  ///< W, on -P (braking)
  double servo_gain = unlimited;        ///< 1/s, of the position control; unlimited: no following error
  double velocity_feedforward = 0.0;    ///< 0 .. 1, of the same
  std::vector<double> response_taps{};  ///< of sum 1, measured, instead of a gain; empty: none
  double coulomb = 0.0;                 ///< N, dry friction against the motion: F = m a' + c V' + coulomb sign(V')
  /// Force |F| that the drive has at a speed |V'|: straight from point to point, constant below the first, nothing
  /// beyond the last. Speeds rise from >= 0, forces fall, and the curve is concave. Empty: no curve.
  std::vector<SpeedForce> force_speed{};
  /// N, on the force of a sample that is scaled to standstill along the curve: the curve's first force, or
  /// `unlimited` without a curve.
  double force_speed_max = unlimited;
  double force_rms_max = unlimited;  ///< N, thermal rating: root mean square of the force over a whole program
};

/// Residual vibration bound of the filter: |sum_i b_i exp(-(z w + j w sqrt(1 - z^2)) (N - i) T)| <= residual_max, w = 2
/// pi f. For all undamped natural frequencies f and damping ratios z of the two ranges. The left side is the amplitude
/// at the last tap, over that of an unfiltered step (Singer and Seering, J. Dyn. Syst. Meas. Control 112, 1990).
///
/// With an axis the bound is on the amplitude in metres instead, of starts, blends and stops. Both legs of a blend
/// count with their phase. Legs at v1 and v2 with a delay d leave |v2 - v1 exp(-(z w + j w_d) d T)| / w_d of the above.
/// Here w_d = w sqrt(1 - z^2). A start or stop is a blend from or to rest.
struct Mode {
  double frequency_low = 0.0;   ///< Hz, > 0
  double frequency_high = 0.0;  ///< Hz, >= frequency_low
  double residual_max = 0.0;    ///< 0 <= residual_max; 1 or more never binds
  double damping_low = 0.0;     ///< damping ratio, 0 <= damping_low <= damping_high < 1
  double damping_high = 0.0;
  int axis = -1;                        ///< index of the axis that vibrates; -1: the bound is `residual_max`
  double displacement_max = unlimited;  ///< m, with an axis, whose `residual_max` is 1
  /// Whether the bound is in metres, of one axis.
  bool of_axis() const { return axis >= 0; }
  /// Whether an undamped vibration is one of those bounded.
  bool undamped() const { return damping_low == 0.0; }
};

struct Machine {
  std::vector<Axis> axes;
  std::vector<Mode> modes;
  std::vector<double> prefilter_taps{};       ///< of sum 1, >= 0: the control's own fixed smoothing; empty: none
  double power_total_max = unlimited;         ///< W, on the sum of F V' over the axes (shared supply, motoring)
  double regeneration_total_max = unlimited;  ///< W, on minus that sum (braking)
  double position_unit = 0.0;                 ///< m, positions are output as whole numbers of it; 0: as decimals
};

/// The quantities that limits bound: of an axis, of the filter, of a corner.
enum class LimitKind {
  velocity,
  acceleration,
  jerk,
  force,
  power,
  regeneration,
  vibration,
  corner_error,
  speed_min,
  power_total,
  regeneration_total,
  contour,
  residual,
  force_speed
};

/// Name and unit of every kind of limit. Tasks, results and tables all take them from here.
struct LimitName {
  LimitKind kind;
  std::string_view name;  ///< in result files
  std::string_view unit;  ///< for people
  double per_si;          ///< value in `unit` = per_si * value in SI
};
inline constexpr std::array<LimitName, 14> limit_names{{
    {LimitKind::velocity, "velocity", "mm/s", 1e3},
    {LimitKind::acceleration, "acceleration", "mm/s^2", 1e3},
    {LimitKind::jerk, "jerk", "mm/s^3", 1e3},
    {LimitKind::force, "force", "N", 1.0},
    {LimitKind::power, "power", "W", 1.0},                ///< motoring
    {LimitKind::regeneration, "regeneration", "W", 1.0},  ///< braking
    {LimitKind::vibration, "vibration", "%", 1e2},        ///< residual amplitude, 0 .. 1
    {LimitKind::corner_error, "corner_error", "um", 1e6},
    {LimitKind::speed_min, "speed_min", "mm/s", 1e3},                 ///< a lower bound
    {LimitKind::power_total, "power_total", "W", 1.0},                ///< all axes together, motoring
    {LimitKind::regeneration_total, "regeneration_total", "W", 1.0},  ///< all axes together, braking
    {LimitKind::contour, "contour", "um", 1e6},                       ///< distance of the path from the programmed legs
    {LimitKind::residual, "residual", "um", 1e6},       ///< amplitude that a mode of one axis is left with
    {LimitKind::force_speed, "force_speed", "N", 1.0},  ///< a force at a speed, scaled to standstill
}};
constexpr const LimitName& limit_name(LimitKind kind) {
  return limit_names[static_cast<std::size_t>(kind)];
}
constexpr std::string_view to_string(LimitKind kind) {
  return limit_name(kind).name;
}
/// Whether a limit is on what a mode is left with, so that its use has a frequency and a damping ratio.
constexpr bool of_mode(LimitKind kind) {
  return kind == LimitKind::vibration || kind == LimitKind::residual;
}

/// The three events of every corner on which the axis limits hold; k counts from the last sample before each begins.
enum class Event {
  start,  ///< from rest along leg 1, k = 0 .. N + 1; the jerk also at N + 2, where the last tap's acceleration ends
  blend,  ///< around the corner, k = 0 .. N + d + 1; the jerk also at N + d + 2
  stop,   ///< to rest along leg 2, as the start
  none    ///< not tied to an event: vibration
};
std::string_view to_string(Event event);

/// The worst use of one limit. `utilisation` = value/bound for upper bounds and bound/value for `speed_min`, so that >
/// 1 always means violated; 0/0 counts as 0 and x/0 as infinity.
struct LimitUse {
  LimitKind kind{};
  std::string axis;    ///< empty where the limit belongs to no axis
  std::string corner;  ///< of a task; empty for vibration, and in programs
  Event event = Event::none;
  double value = 0.0;  ///< SI; an absolute value, except power (signed as its limit counts it)
  double bound = 0.0;  ///< SI
  double utilisation = 0.0;
  std::int64_t sample = 0;  ///< k of the worst sample within its event; of a program: counted from its start
  double frequency = 0.0;   ///< Hz, the worst frequency; of modes only
  double damping = 0.0;     ///< the worst damping ratio; of modes only
  std::uint32_t line = 0;   ///< of a program: of the block where it occurred; 0 for vibration, and in tasks
};

/// value/bound (or bound/value for speed_min), with the conventions of LimitUse.
double utilisation_of(LimitKind kind, double value, double bound);

/// Worst use, over start, blend and stop, of every finite axis limit. One entry per limit and axis, in axis order.
/// @param corner  as many axes as the machine
/// @throws std::invalid_argument if the numbers of axes differ or the sample period is not positive and finite.
std::vector<LimitUse> axis_utilisation(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                       const Machine& machine, const std::string& corner_name = "");

/// Residual vibration of a filter at frequency f in Hz and damping ratio z, see `Mode`: 0 .. 1.
double residual_vibration(const Filter& filter, double frequency, double sample_period, double damping = 0.0);

/// The worst frequency and damping of every mode that is not of an axis. Without damping by branch and bound from a
/// grid finer than the response's ripples, O((N + 1) * grid), grid = 8 (N + 1) T (high - low). With damping on the
/// edges of the rectangle of frequencies and damping ratios, as the largest value of an analytic function is on the
/// edge.
/// @param stop  polled at every frequency; when it returns true, the result so far is used, which may be too small
/// @throws std::invalid_argument on a band, a damping ratio or a sample period out of range.
std::vector<LimitUse> vibration_utilisation(const Filter& filter, double sample_period, const Machine& machine,
                                            const std::function<bool()>& stop = {});

/// Amplitude, m, that a mode of an axis is left with behind a blend from v1 to v2 m/s, see `Mode`. @param delay  >= 0
double residual_amplitude(const Filter& filter, double v1, double v2, int delay, double frequency, double sample_period,
                          double damping = 0.0);

/// The worst frequency and damping of one mode of an axis behind such a blend, on the edges as above.
LimitUse residual_utilisation(const Filter& filter, double v1, double v2, int delay, double sample_period,
                              const Mode& mode);

}  // namespace accdec
