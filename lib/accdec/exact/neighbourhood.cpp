#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/search.hpp>

// Designs for several corners before and during the proof. The proof's own linear programs are too loose for good
// designs where ranges are wide; near a design they are tight.

namespace accdec::exact {
namespace {

/// The sample at which a filter comes closest to a corner with a delay.
int closest_sample(const LimitModel& model, const Filter& filter, std::size_t j, int delay) {
  const double cosine = std::cos(model.theta(j));
  double least = std::numeric_limits<double>::infinity();
  int at = 0;
  for (int k = 0; k <= filter.order() + delay + 1; ++k) {
    const double p = model.scale_in(j) * filter.remaining_moment(k),
                 q = model.scale_out(j) * filter.elapsed_moment(k - delay);
    const double square = p * p + q * q + 2.0 * p * q * cosine;
    if (square < least) least = square, at = k;
  }
  return at;
}

}  // namespace

void Search::aim(double target) {
  target_ = target;
  current_ = Proof{};
  current_.target = target;
  recent_.clear();
  in_tree_.clear();
  refuted_corner_.clear();
  Box box = root();
  if (tighten(task_, target, box)) size_for(box.order);
}

void Search::sweep_orders(int least, const std::function<bool()>& enough) {
  // Longer filters than these only help where hardly anything is paid for them; the search itself sees to that.
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
  // The last pass is over all delays and shorter filters: a search that is cut short still passes many filters.
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
        const int delay = best->delays[j], k = closest_sample(model_, best->filter, j, delay);
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
