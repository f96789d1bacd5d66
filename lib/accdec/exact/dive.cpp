#include <algorithm>

#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

// Finds a good design of one corner before its proof: designs longer than it need not be refuted.

namespace accdec::exact {
/// The longest delay with which a filter of this order is shorter than the best design.
int Search::longest_shorter(int order) const {
  const LinearCost cost = cost_of(task_);
  int delay = std::min(order, task_.design.order_max) + 1 + model_.ramps.longer();
  while (delay >= 0 && cost(order, {delay}) >= best->value * (1.0 - 1e-9)) --delay;
  return delay;
}

bool Search::holds_alone(int order, int delay) {
  Box box;
  box.order = order;
  box.servo = model_.servo();
  const int k = CornerError(model_, best->filter, 0).closest_sample(delay);
  box.corners = {CornerBox{delay, delay, k, k}};
  const Outcome outcome = relaxation_->solve(box, false);
  const double before = best->value;
  if (outcome.filter) offer(*outcome.filter);
  return best->value < before;
}

void Search::dive() {
  if (!best || task_.corners.size() != 1 || task_.corners.front().delay || !model_.cone(0)) return;
  const int least = smallest_order_;
  for (const int more : {0, 1, 2, 4, 8, 16}) {
    const int order = least + more;
    if (order > task_.design.order_max || 4 * more > least) return;
    size_for(order);
    int refuted = -1;
    for (int step = 1; !stop_(); step *= 2) {
      const int most = longest_shorter(order);
      if (most <= refuted) break;
      const int delay = std::max(most + 1 - step, refuted + 1 + (most - refuted - 1) / 2);
      if (!holds_alone(order, delay)) {
        refuted = delay;
        step = 1;
        if (delay == most) break;
      }
    }
  }
}

}  // namespace accdec::exact
