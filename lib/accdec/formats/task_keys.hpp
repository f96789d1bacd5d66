#pragma once

#include <array>
#include <numbers>
#include <string_view>

#include <accdec/machine/limits.hpp>
#include <accdec/task/task.hpp>

// Internal to the room: the keys of task files and their units, shared by reader and writer so that neither can know a
// key alone.

namespace accdec::task_keys {

// Units of keys to SI. Division by a power of ten rounds once, so that 100 um is the double nearest 1e-4 m.
inline double same(double x) {
  return x;
}
inline double from_milli(double x) {
  return x / 1e3;
}  // ms, mm, mm/s, mm/s^2, mm/s^3
inline double from_micro(double x) {
  return x / 1e6;
}  // um
inline double from_mm_min(double x) {
  return x / 6e4;
}  // mm/min
inline double from_degrees(double x) {
  return x / 180.0 * std::numbers::pi;
}

/// A number of a task file: its key, its unit, what is allowed (in that unit).
struct NumberKey {
  std::string_view key;
  double (*to_si)(double);
  double low, high;
  bool open_low;
};

/// The number in a key's unit that reads back as exactly `si`, with as few digits as that takes; the nearest where none
/// does.
double in_unit(const NumberKey& key, double si);

struct AxisKey : NumberKey {
  double Axis::*member;
};
/// The limits of the one table, with the plant between those that need it and those that do not.
constexpr auto make_axis_keys() {
  std::array<AxisKey, axis_limits.size() + 2> keys{};
  std::size_t n = 0;
  const auto add_limits = [&](bool load) {
    for (const AxisLimit& limit : axis_limits) {
      if (limit.load != load) continue;
      keys[n++] = {{limit.key, limit_name(limit.kind).per_si == 1e3 ? from_milli : same, 0.0, limit.key_max, true},
                   limit.bound};
    }
  };
  add_limits(false);
  keys[n++] = {{"mass_kg", same, 0.0, 1e6, false}, &Axis::mass};
  keys[n++] = {{"damping_N_s_m", same, 0.0, 1e8, false}, &Axis::damping};
  add_limits(true);
  return keys;
}
inline constexpr auto axis_keys = make_axis_keys();

inline constexpr NumberKey sample_period{"sample_period_ms", from_milli, 1e-4, 1e3, false};
inline constexpr NumberKey angle{"angle_deg", from_degrees, 0.0, 180.0, true};
inline constexpr NumberKey heading{"heading_deg", from_degrees, -360.0, 360.0, false};
inline constexpr NumberKey feed_in{"feed_in_mm_min", from_mm_min, 0.0, 1e7, true};
inline constexpr NumberKey feed_out{"feed_out_mm_min", from_mm_min, 0.0, 1e7, true};
inline constexpr NumberKey error_max{"error_max_um", from_micro, 0.0, 1e7, false};
inline constexpr NumberKey speed_min{"speed_min_mm_s", from_milli, 0.0, 1e6, false};
inline constexpr NumberKey runs{"runs", same, 0.0, 1e9, true};
inline constexpr NumberKey weight{"weight", same, 0.0, 1e9, true};
inline constexpr NumberKey frequency{"frequency_Hz", same, 0.0, 1e6, true};
inline constexpr NumberKey residual_max{"residual_max", same, 0.0, 1.0, false};

inline constexpr int order_limit = 1'000'000;
inline constexpr int delay_limit = 1'000'000;
inline constexpr std::size_t axes_limit = 9;
/// Names of axes that have none, in order.
inline constexpr std::array<std::string_view, axes_limit> axis_names{"x", "y", "z", "a", "b", "c", "u", "v", "w"};

}  // namespace accdec::task_keys
