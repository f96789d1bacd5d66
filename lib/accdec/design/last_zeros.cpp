#include <algorithm>
#include <utility>

#include <accdec/design/last_zeros.hpp>
#include <accdec/verify.hpp>

namespace accdec {

Filter without_last_zeros(const Task& task, Filter filter, const std::vector<int>& delays) {
  const int ends = task.design.symmetric ? 2 : 1;
  while (filter.tap(filter.order()) == 0.0 && filter.order() - ends >= std::max(task.design.order_min, 0)) {
    const auto taps = filter.taps();
    Filter shorter({taps.begin() + (ends - 1), taps.end() - 1});
    if (assess(task, shorter, delays, false).status != Status::feasible) break;
    filter = std::move(shorter);
  }
  return filter;
}

}  // namespace accdec
