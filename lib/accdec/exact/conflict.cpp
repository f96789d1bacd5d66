#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/exact/conflict.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/conflict.hpp>

namespace accdec::exact {

std::string conflict_message(const Task& task, const std::function<bool()>& stop) {
  bool minimal = true;
  const auto may_have_design = [&](const Task& without) {
    if (stop()) minimal = false;
    return stop() || Search(without, stop).below(std::numeric_limits<double>::infinity()) != Search::Answer::proved;
  };
  const std::vector<std::string> conflict = limits_in_conflict(task, true, may_have_design);
  return fmt::format("no filter of order {} or less holds together: {}{}", task.design.order_max,
                     fmt::join(conflict, ", "), minimal ? "" : " (perhaps not all of them needed)");
}

}  // namespace accdec::exact
