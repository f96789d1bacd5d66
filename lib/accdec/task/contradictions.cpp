#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/corner_speed.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Contours that a leg leaves at its feed, whatever the filter.
void tell_contours(const Task& task, std::vector<std::string>& found) {
  const auto bounded = [](const TaskCorner& corner) { return corner.contour_max.has_value(); };
  if (!servos_differ(task.machine) || std::ranges::none_of(task.corners, bounded)) return;
  const Filter none({1.0});
  const FilterBehind behind(none, task.machine, task.sample_period);
  for (const TaskCorner& corner : task.corners) {
    const Corner& g = corner.geometry();
    const double off = std::max(off_line(behind, g.direction_in, g.feed_in * task.sample_period),
                                off_line(behind, g.direction_out, g.feed_out * task.sample_period));
    if (corner.contour_max && off > granted_error(*corner.contour_max) * (1.0 + 1e-9))
      found.push_back(
          fmt::format("contour of corner {}: at constant feed the servos leave the line of a leg by {:.4g} um, the "
                      "limit is {:g} um",
                      corner.name, 1e6 * off, 1e6 * *corner.contour_max));
  }
}

}  // namespace

std::vector<std::string> contradictions(const Task& task) {
  std::vector<std::string> found;
  for (const TaskCorner& corner : task.corners) {
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const Axis& axis = task.machine.axes[i];
      const auto a = static_cast<Eigen::Index>(i);
      const double speed = std::max(std::abs(corner.geometry().feed_in * corner.geometry().direction_in[a]),
                                    std::abs(corner.geometry().feed_out * corner.geometry().direction_out[a]));
      const double still = 1.2 * still_part * std::max(corner.geometry().feed_in, corner.geometry().feed_out);
      const double friction = axis.damping * speed + (speed > still ? axis.coulomb : 0.0);
      const auto tell = [&](LimitKind kind, double needed, double bound) {
        const auto [unit, per_si] = limit_unit(kind, axis.name);
        if (needed <= bound * (1.0 + granted_tolerance)) return;
        found.push_back(fmt::format("{} {}: corner {} needs {:.10g} {} at constant feed, the limit is {:.10g} {}",
                                    limit_word(kind, axis.name), axis.name, corner.name, per_si * needed, unit,
                                    per_si * bound, unit));
      };
      tell(LimitKind::velocity, speed, axis.velocity_max);
      tell(LimitKind::force, friction, axis.force_max);
      tell(LimitKind::power, friction * speed, axis.power_max);
      if (at_standstill(axis, speed, friction) <= axis.force_speed_max * (1.0 + granted_tolerance)) continue;
      if (speed > last_speed(axis) * (1.0 + granted_tolerance)) {
        found.push_back(
            fmt::format("force-speed curve {}: the curve ends at {:.10g} mm/s, corner {} runs at {:.10g} mm/s",
                        axis.name, 1e3 * last_speed(axis), corner.name, 1e3 * speed));
      } else {
        found.push_back(fmt::format(
            "force-speed curve {}: corner {} needs {:.10g} N at constant feed, the curve allows {:.10g} N at {:.10g} "
            "mm/s",
            axis.name, corner.name, friction, force_at(axis, speed), 1e3 * speed));
      }
    }
    const double feed = std::min(corner.geometry().feed_in, corner.geometry().feed_out);
    if (corner.speed_min > feed * (1.0 + granted_tolerance)) {
      found.push_back(
          fmt::format("speed_min: corner {} asks for at least {:.10g} mm/s, its slower leg runs at {:.10g} mm/s",
                      corner.name, 1e3 * corner.speed_min, 1e3 * feed));
    }
  }
  tell_contours(task, found);
  const CornerSpeeds speeds(task);
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (const double fastest = speeds.fastest(j); fastest < unlimited)
      found.push_back(
          fmt::format("smallest speed {0} and corner error {0}: within {1:.10g} um of the corner, limits of "
                      "acceleration, force and jerk make every filter slower than {2:.4g} mm/s at some sample; the "
                      "task asks for {3:.10g} mm/s",
                      corner.name, 1e6 * *corner.error_max, 1e3 * fastest, 1e3 * corner.speed_min));
  }
  for (const Mode& mode : task.machine.modes) {
    if (!mode.undamped()) continue;
    // After sampling, a whole number of cycles per period looks like 0 Hz, which every filter passes fully.
    const double alias = std::ceil(mode.frequency_low * task.sample_period - 1e-12);
    if (mode.residual_max * (1.0 + granted_tolerance) < 1.0 && alias >= 1.0 &&
        alias <= mode.frequency_high * task.sample_period + 1e-12) {
      found.push_back(
          fmt::format("vibration: the band {:.10g} to {:.10g} Hz contains {:.10g} Hz, a multiple of the sample rate, "
                      "where no filter "
                      "reduces anything",
                      mode.frequency_low, mode.frequency_high, alias / task.sample_period));
    }
  }
  return found;
}

}  // namespace accdec
