#include <accdec/machine/response.hpp>
#include <accdec/task/limits_on_taps.hpp>

namespace accdec {

std::shared_ptr<const Task> limits_on_taps(const Task& whole) {
  const Response response(whole.machine, whole.sample_period);
  if (response.ideal()) return {std::shared_ptr<const Task>(), &whole};
  const auto reduced = std::make_shared<Task>(whole);
  Task& task = *reduced;
  for (Axis& axis : task.machine.axes) {
    axis.force_max = axis.power_max = axis.regeneration_max = axis.force_speed_max = unlimited;
    if (response.prefilter_order() > 0) axis.acceleration_max = axis.jerk_max = unlimited;
  }
  if (response.prefilter_order() > 0) task.machine.modes.clear();
  for (TaskCorner& corner : task.corners) {
    corner.error_max.reset(), corner.contour_max.reset();
    corner.speed_min = 0.0;
  }
  return reduced;
}

}  // namespace accdec
