#include <algorithm>
#include <limits>

#include <accdec/exact/contour_path.hpp>
#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/first_designs.hpp>
#include <accdec/family.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec::exact {

int FirstDesigns::smallest_order() {
  const int most = task_.design.order_max;
  // Without tolerances every delay and every sample is free.
  const auto holds = [&](int order) {
    bench_.size_for(order);
    Box box = bench_.root();
    box.order = order;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      CornerBox& b = box.corners[j];
      if (!task_.corners[j].delay) b.d1 = 0, b.d2 = std::max(order, most) + settling + box.longer();
      b.k1 = 0, b.k2 = b.d2 + order + 1 + box.longer();
      b.c1 = 0.0, b.c2 = b.k2;
    }
    if (!model_.convex() && !model_.shrink(box)) return false;
    const Outcome outcome = bench_.relaxation().solve(box, false);
    if (outcome.filter) designs_.offer(*outcome.filter);
    return outcome.kind != Outcome::refuted;
  };
  int low = std::max({0, order_lower_bound(model_.granted().task(), most), task_.design.order_min}) - 1,
      high = std::max(low + 1, 0);  // low is refuted
  while (high <= most && !bench_.told_to_stop()) {
    if (holds(high)) break;
    low = high;
    if (high == most) return most + 1;
    high = std::min(most, high + std::max(2, high / 3));
  }
  if (high > most) return most + 1;
  while (high - low > 1 && !bench_.told_to_stop()) {
    const int mid = (low + high) / 2;
    (holds(mid) ? high : low) = mid;
  }
  return bench_.smallest_order = high;
}

/// The longest delay with which a filter of this order is shorter than the best design.
int FirstDesigns::longest_shorter(int order) const {
  const LinearCost cost = cost_of(task_);
  int delay = std::min(order, task_.design.order_max) + 1 + model_.ramps.longer();
  while (delay >= 0 && cost(order, {delay}) >= designs_.best->value * (1.0 - 1e-9)) --delay;
  return delay;
}

bool FirstDesigns::holds_alone(int order, int delay) {
  Box box;
  box.order = order;
  box.servo = model_.servo();
  const int k = CornerError(model_, designs_.best->filter, 0).closest_sample(delay);
  box.corners = {CornerBox{delay, delay, k, k, 0.0, static_cast<double>(box.order + delay + 1 + box.longer())}};
  box = at_crossings(model_, designs_.best->filter, std::move(box));
  const Outcome outcome = bench_.relaxation().solve(box, false);
  const double before = designs_.best->value;
  if (outcome.filter) designs_.offer(*outcome.filter);
  return designs_.best->value < before;
}

void FirstDesigns::dive() {
  if (!designs_.best || task_.corners.size() != 1 || task_.corners.front().delay || !model_.cone(0)) return;
  const int least = bench_.smallest_order;
  for (const int more : {0, 1, 2, 4, 8, 16}) {
    const int order = least + more;
    if (order > task_.design.order_max || 4 * more > least) return;
    bench_.size_for(order);
    int refuted = -1;
    for (int step = 1; !bench_.told_to_stop(); step *= 2) {
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

void FirstDesigns::sweep_orders(int least, const std::function<bool()>& enough) {
  // Longer filters help only where their length costs almost nothing; the search itself covers those cases.
  const int last = std::min(task_.design.order_max, least + least / 2 + 4), step = std::max(1, least / 16);
  for (int order = least; order <= last && !bench_.told_to_stop() && !enough(); order += step) {
    bench_.aim(designs_.best ? designs_.best->value : std::numeric_limits<double>::infinity());
    Box box = bench_.root();
    box.order_least = box.order_most = order;
    Box narrowed = box;
    proof::Node why;
    if (!bench_.narrow(narrowed, &why)) {
      if (designs_.best && std::holds_alternative<proof::TooLong>(why)) return;  // longer ones cost more
      continue;
    }
    if (!designs_.best) return;
    branching_.try_part(box);
  }
}

void FirstDesigns::offer_shapes(int least) {
  const LinearCost cost = cost_of(task_);
  if (const auto taps = saturating_start(task_, task_.design.order_max); !taps.empty()) designs_.offer(Filter(taps));
  for (int n = least; n <= task_.design.order_max && !bench_.told_to_stop(); ++n) {
    const double shortest = cost(n, std::vector<int>(task_.corners.size(), 0));
    if (designs_.best && shortest >= designs_.best->value) break;
    // About sixteen second averages, beginning with none.
    for (const char* name : {"trapezoid", "hann"}) {
      visit_members(*find_family(name), n, std::max(1, n / 16), [&](const FilterSpec& spec, std::span<const int>) {
        designs_.offer(make_filter(spec));
        return true;
      });
    }
  }
}

}  // namespace accdec::exact
