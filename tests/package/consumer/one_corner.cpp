#include <cstdio>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>

int main() {
  accdec::Task task;
  task.sample_period = 1e-3;  // s
  for (const char* name : {"x", "y"}) {
    accdec::Axis axis;
    axis.name = name;
    axis.acceleration_max = 6.0;  // m/s^2
    axis.jerk_max = 500.0;        // m/s^3
    task.machine.axes.push_back(axis);
  }
  const double angle = 1.658;  // rad, interior
  accdec::TaskCorner corner("A", accdec::PlanarLegs{angle}, 0.1, 0.1);
  corner.error_max = 50e-6;  // m
  task.corners.push_back(corner);

  const accdec::DesignResult result = accdec::design_task(task);
  if (!result.has_design()) return 1;
  std::printf("order %d, delay %d samples: %.0f ms a corner\n", result.filter->order(), result.corners[0].delay,
              1e3 * result.cycle_time);
  return accdec::check_certificate(task, result).accepted ? 0 : 1;
}
