#include <algorithm>

#include <accdec/machine/limits.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double wider = 1.0 + granted_tolerance;
/// m and 1: largest effect of rounding on a simulated distance or residual amplitude, whatever its bound is.
constexpr double rounding_of_distance = 1e-3 * position_floor, rounding_of_residual = 1e-13;
/// The verifier takes a residual up to this as zero.
constexpr double residual_floor = 1e-12;

}  // namespace

double granted_error(double error_max) {
  return std::max(error_max * wider, position_floor) + rounding_of_distance;
}

Task granted_limits(Task task) {
  double fastest = 0.0;
  for (const TaskCorner& corner : task.corners)
    fastest = std::max({fastest, corner.geometry().feed_in, corner.geometry().feed_out});
  for (Axis& axis : task.machine.axes) {
    for (const AxisLimit& limit : axis_limits) axis.*limit.bound *= wider;
    // A sample that counts as standing has no dry friction against it, but little acceleration.
    if (axis.coulomb == 0.0) continue;
    const double standing = still_part * fastest * axis.mass / task.sample_period;
    axis.force_max += standing, axis.force_speed_max += standing;
  }
  task.machine.power_total_max *= wider, task.machine.regeneration_total_max *= wider;
  for (Mode& mode : task.machine.modes) {
    mode.residual_max = std::max(mode.residual_max * wider, residual_floor) + rounding_of_residual;
    mode.displacement_max = mode.displacement_max * wider + rounding_of_distance;
  }
  for (TaskCorner& corner : task.corners) {
    if (corner.error_max) corner.error_max = granted_error(*corner.error_max);
    if (corner.contour_max) corner.contour_max = granted_error(*corner.contour_max);
    corner.speed_min /= wider;
  }
  return task;
}

}  // namespace accdec
