#include <algorithm>
#include <limits>

#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/search.hpp>

// Finds designs for several corners before and during the proof. Where ranges are wide, the proof's own linear programs
// are too loose to find good designs. Near a known design they are tight.

namespace accdec::exact {
void Search::aim(double target) {
  target_ = target;
  draft_.begin();
  Box box = root();
  if (tighten(task_, target, box)) size_for(box.order);
}

void Search::sweep_orders(int least, const std::function<bool()>& enough) {
  // Longer filters help only where their length costs almost nothing; the search itself covers those cases.
  const int last = std::min(task_.design.order_max, least + least / 2 + 4), step = std::max(1, least / 16);
  for (int order = least; order <= last && !stop_() && !enough(); order += step) {
    aim(best ? best->value : std::numeric_limits<double>::infinity());
    Box box = root();
    box.order_least = box.order_most = order;
    Box narrowed = box;
    proof::Node why;
    if (!narrow(narrowed, &why)) {
      if (best && std::holds_alternative<proof::TooLong>(why)) return;  // longer ones cost more
      continue;
    }
    if (!best) return;
    try_part(box);
  }
}

bool Search::improve() {
  going_on_ = false;
  // The last pass covers all delays and shorter filters: even a search that is cut short tries many filters.
  constexpr int everywhere = 4;
  bool improved = false;
  for (int reach = 1; reach <= everywhere; ++reach) {
    for (bool again = true; again && best && !stop_();) {
      aim(best->value);
      Box box = root();
      box.order_least = reach < everywhere ? std::max(0, best->filter.order() - 2 * reach) : 0;
      box.order_most = best->filter.order() + 2 * reach;
      for (std::size_t j = 0; j < box.corners.size() && reach < everywhere; ++j) {
        CornerBox& c = box.corners[j];
        const int delay = best->delays[j], k = CornerError(model_, best->filter, j).closest_sample(delay);
        c.d1 = std::max(c.d1, delay - 2 * reach), c.d2 = std::min(c.d2, delay + 2 * reach);
        if (model_.cone(j)) c.k1 = std::max(0, k - 2 * reach), c.k2 = k + 2 * reach;
      }
      budget_end_ = linear_programs() + 300L * reach;
      const double before = best->value;
      again = refute(box) == State::found && best->value < before;
      budget_end_ = std::numeric_limits<long>::max();
      improved |= again;
    }
  }
  return improved;
}

}  // namespace accdec::exact
