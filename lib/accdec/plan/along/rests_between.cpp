#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/plan/along/rests_between.hpp>

namespace accdec {

bool may_follow(const FreePath& free, const std::vector<double>& before, const std::vector<double>& next,
                std::size_t rests) {
  constexpr double rounded = 1.0 + 1e-9;
  constexpr double of_position = 4.0 * std::numeric_limits<double>::epsilon();  // in a third difference
  const std::size_t n = free.dimensions(), border = free.border(), count = before.size() / n;
  const double rate = 1.0 / free.period;
  for (std::size_t a = 0; a < n; ++a) {
    const Axis& limits = free.machine.axes[a];
    std::vector<double> x;
    for (std::size_t i = border; i-- > 0;) x.push_back(before[(count - 1 - std::min(i, count - 1)) * n + a]);
    x.insert(x.end(), rests, x.back());
    for (std::size_t i = 0; i < border; ++i) x.push_back(next[std::min(i, next.size() / n - 1) * n + a]);
    for (std::size_t k = border; k < x.size(); ++k) {
      const double v = (x[k] - x[k - 1]) * rate, b = (v - (x[k - 1] - x[k - 2]) * rate) * rate;
      if (!(std::abs(b) <= rounded * limits.acceleration_max)) return false;
      if (!(std::abs(limits.mass * b + limits.damping * v) <= rounded * limits.force_max)) return false;
      const double third = border < 3 ? 0.0 : (x[k] - 3.0 * x[k - 1] + 3.0 * x[k - 2] - x[k - 3]) * rate * rate * rate;
      const double dust = of_position * std::abs(x[k]) * rate * rate * rate;
      if (!(std::abs(third) <= rounded * limits.jerk_max + dust)) return false;
    }
  }
  return true;
}

std::size_t rests_between(const FreePath& free, const std::vector<double>& before, const std::vector<double>& next) {
  std::size_t rests = 0;
  while (rests + 1 < free.border() && !may_follow(free, before, next, rests)) ++rests;
  return rests;
}

}  // namespace accdec
