#include <algorithm>

#include <fmt/format.h>

#include <accdec/exact/size.hpp>
#include <accdec/files/memory.hpp>
#include <accdec/task/convexity.hpp>

namespace accdec::exact {
namespace {

/// A pivot reads the whole tableau: beyond this size each takes about a second.
constexpr double bytes_max = 4e9;
/// This much memory is always there; asking the system takes longer than a small task.
constexpr double bytes_always = 1e7;

}  // namespace

double linear_program_bytes(const Task& task, int order) {
  const double n = order + 2.0, corners = static_cast<double>(task.corners.size());
  const double columns = n + (corners > 1.0 ? 2.0 * corners : 0.0);
  double sums = 0.0;  // rows in cumulative responses: half of their coefficients are there
  bool jerk = false;
  for (const Axis& axis : task.machine.axes) {
    jerk = jerk || axis.jerk_max < unlimited;
    if (axis.force_max < unlimited && axis.damping > 0.0) sums += n;
  }
  if (!is_convex(task)) sums += n;
  // Cuts of the cones and the blends are added as needed: about one per corner and a tenth of the number of taps.
  const double rows = 1.0 + (jerk ? n : 0.0) + sums + corners + 0.1 * n;
  const double tableau = 2.0 * sizeof(double) * rows * columns;
  const double kept = (sizeof(double) + sizeof(int)) * (0.5 * sums * n + corners * n);
  return tableau + kept;
}

void require_room(const Task& task, int order) {
  const double bytes = linear_program_bytes(task, order);
  if (bytes <= bytes_always) return;
  const double there = std::min(bytes_max, 0.5 * available_memory());
  if (bytes <= there) return;
  throw TooLarge(
      fmt::format("the proof's linear programs for order {} and {} corner{} would take {:.3g} GB of memory, {:.3g} "
                  "GB are allowed them here",
                  order, task.corners.size(), task.corners.size() == 1 ? "" : "s", 1e-9 * bytes, 1e-9 * there));
}

}  // namespace accdec::exact
