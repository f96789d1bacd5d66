#include <algorithm>

#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/search.hpp>

// Finds designs for several corners during the proof: near a known design, linear programs are tight.

namespace accdec::exact {

bool Search::improve() {
  going_on_ = false;
  // The last pass covers all delays and shorter filters: even a search that is cut short tries many filters.
  constexpr int everywhere = 4;
  bool improved = false;
  for (int reach = 1; reach <= everywhere; ++reach) {
    for (bool again = true; again && designs_.best && !bench_.told_to_stop();) {
      bench_.aim(designs_.best->value);
      Box box = bench_.root();
      box.order_least = reach < everywhere ? std::max(0, designs_.best->filter.order() - 2 * reach) : 0;
      box.order_most = designs_.best->filter.order() + 2 * reach;
      for (std::size_t j = 0; j < box.corners.size() && reach < everywhere; ++j) {
        CornerBox& c = box.corners[j];
        const int delay = designs_.best->delays[j];
        c.d1 = std::max(c.d1, delay - 2 * reach), c.d2 = std::min(c.d2, delay + 2 * reach);
        if (!model_.cone(j)) continue;
        const int k = CornerError(model_, designs_.best->filter, j).closest_sample(delay);
        c.k1 = std::max(0, k - 2 * reach), c.k2 = k + 2 * reach;
      }
      bench_.allow(300L * reach);
      const double before = designs_.best->value;
      again = refute(box) == BoxState::found && designs_.best->value < before;
      bench_.allow_all();
      improved |= again;
    }
  }
  return improved;
}

}  // namespace accdec::exact
