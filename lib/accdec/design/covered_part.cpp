#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate.hpp>
#include <accdec/design/covered_part.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

Task covered_part(const Task& task) {
  Task part = task;
  part.machine.power_total_max = part.machine.regeneration_total_max = unlimited;
  for (Axis& axis : part.machine.axes) {
    if (axis.coulomb > 0.0) axis.power_max = axis.regeneration_max = unlimited;
  }
  return part;
}

std::string left_out(const Task& task) {
  const Task part = covered_part(task);
  std::vector<std::string> limits;
  for (const AxisLimit& limit : axis_limits) {
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      if (task.machine.axes[a].*limit.bound == part.machine.axes[a].*limit.bound) continue;
      limits.push_back(fmt::format("{} of axes with dry friction", limit_name(limit.kind).name));
      break;
    }
  }
  if (limits_supply(task.machine)) limits.push_back("the supply that the axes share");
  return fmt::format("{}", fmt::join(limits, ", "));
}

std::string what_bound(const Task& task, const Certificate* proof, bool finished) {
  if (task.machine.prefilter_taps.empty())
    return fmt::format("{}the proof does not consider {}", finished ? "" : "the time ended before the proof, and ",
                       left_out(task));
  const auto* tree = proof == nullptr ? nullptr : std::get_if<proof::BranchAndBound>(&proof->proof);
  return tree == nullptr || tree->smoothed
             ? "the bound is of any filter in place of this one and the control's smoothing together"
             : "the bound is of the limits that are linear in the taps";
}

}  // namespace accdec
