#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/exact/minimal_conflict.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/conflict.hpp>

namespace accdec::exact {

Conflict find_conflict(const Task& task, const std::function<bool()>& stop) {
  Conflict conflict;
  const auto may_have_design = [&](const Task& without) {
    if (stop()) conflict.minimal = false;
    Workbench bench(without, stop);
    return stop() || Search(bench).below(std::numeric_limits<double>::infinity()) != Search::Answer::proved;
  };
  conflict.limits = limits_in_conflict(task, true, may_have_design);
  return conflict;
}

std::string to_message(const Conflict& conflict, const Task& task) {
  return fmt::format("no filter of order {} or less ([design] order_max) holds together: {}{}", task.design.order_max,
                     fmt::join(conflict.limits, ", "), conflict.minimal ? "" : " (perhaps not all of them needed)");
}

}  // namespace accdec::exact
