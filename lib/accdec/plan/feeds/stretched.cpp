#include <algorithm>
#include <cmath>

#include <accdec/plan/feeds/stretched.hpp>

namespace accdec {

Filter stretched(const Filter& filter, int count) {
  if (count == filter.order() + 1) return filter;
  const double factor = static_cast<double>(count) / (filter.order() + 1);
  const auto cumulative = [&](double x) {
    const int k = static_cast<int>(std::floor(x));
    return filter.cumulative(k) + (x - k) * filter.tap(k);
  };
  std::vector<double> taps;
  for (int i = 0; i < count; ++i) taps.push_back(std::max(0.0, cumulative((i + 1) / factor) - cumulative(i / factor)));
  return Filter(taps);
}

}  // namespace accdec
