#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <accdec/comparison/performance_profile.hpp>

namespace accdec::comparison {
namespace {

/// `values` sorted; position in 0 .. size - 1.
double between(const std::vector<double>& values, double position) {
  const auto low = static_cast<std::size_t>(position);
  const double t = position - static_cast<double>(low);
  if (t == 0.0) return values[low];  // avoids 0 times infinity
  return std::isinf(values[low + 1]) ? HUGE_VAL : values[low] + t * (values[low + 1] - values[low]);
}

}  // namespace

Distribution distribution(std::vector<double> values, std::size_t total) {
  if (total == 0) total = values.size();
  if (total < values.size()) throw std::invalid_argument("a distribution of more values than items");
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  Distribution d;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(total);
    if (!d.x.empty() && d.x.back() == values[i]) {
      d.y.back() = share;
    } else {
      d.x.push_back(values[i]);
      d.y.push_back(share);
    }
  }
  return d;
}

double at(const Distribution& d, double x) {
  const auto after = std::upper_bound(d.x.begin(), d.x.end(), x);
  return after == d.x.begin() ? 0.0 : d.y[static_cast<std::size_t>(after - d.x.begin()) - 1];
}

std::vector<std::vector<double>> performance_ratios(const std::vector<std::vector<double>>& costs,
                                                    const std::vector<std::size_t>& among) {
  std::vector<std::vector<double>> ratios = costs;
  if (costs.empty()) return ratios;
  for (std::size_t p = 0; p < costs.front().size(); ++p) {
    double least = HUGE_VAL;
    for (const auto& solver : costs) {
      if (solver.size() != costs.front().size())
        throw std::invalid_argument("every solver needs a cost for every problem");
      if (!(solver[p] > 0.0)) throw std::invalid_argument("costs must be positive");
      if (among.empty()) least = std::min(least, solver[p]);
    }
    for (const std::size_t s : among) least = std::min(least, costs.at(s)[p]);
    for (auto& solver : ratios) solver[p] = std::isinf(solver[p]) ? HUGE_VAL : solver[p] / least;
  }
  return ratios;
}

std::vector<double> simplex_gradients(const std::vector<double>& evaluations, const std::vector<int>& variables) {
  if (evaluations.size() != variables.size())
    throw std::invalid_argument("evaluations and variables must be of the same problems");
  std::vector<double> result(evaluations.size());
  for (std::size_t p = 0; p < result.size(); ++p) result[p] = evaluations[p] / (variables[p] + 1.0);
  return result;
}

Quartiles quartiles(std::vector<double> values) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (values.empty()) return {nan, nan, nan};
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1);
  return {between(values, 0.25 * last), between(values, 0.5 * last), between(values, 0.75 * last)};
}

}  // namespace accdec::comparison
