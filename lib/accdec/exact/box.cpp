#include <algorithm>
#include <cmath>

#include <accdec/exact/box.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {

bool tighten(const Task& task, double target, Box& box) {
  if (by_one_width(task) && !box.window && !order_by_width(task, box.corners)) return false;
  const LinearCost cost = cost_of(task);
  double value = 0.0;
  for (std::size_t j = 0; j < box.corners.size(); ++j) value += cost.delay[j] * box.corners[j].d1;
  const int least = std::max({task.design.order_min, 0, box.order_least});
  box.order = std::min(task.design.order_max, box.order_most);
  box.budget.reset();
  const double limit = target * (1.0 - 1e-9);
  if (target < unlimited) {
    const double most = std::ceil((limit - value) / cost.filter - 1.0) - 1.0;  // filter (N + 1) + value < limit
    box.order = static_cast<int>(std::min<double>(box.order, std::max(most, -1.0)));
    const double room = limit - value - cost.filter * (least + 1);
    if (room <= 0.0) return false;
    if (box.corners.size() > 1) box.budget = room;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      const int more = static_cast<int>(std::min(1e8, room / cost.delay[j]));
      box.corners[j].d2 = std::min(box.corners[j].d2, box.corners[j].d1 + more);
    }
  }
  return box.order >= least && cut_by_width(task, box);
}

}  // namespace accdec::exact
