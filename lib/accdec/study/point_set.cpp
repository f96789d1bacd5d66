#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/batch/portable_random.hpp>
#include <accdec/study/point_set.hpp>

namespace accdec::study {

namespace {

double between(const Variation& v, double t) {
  const double from = v.values.front(), to = v.values.back();
  return v.logarithmic ? std::exp(std::log(from) + t * (std::log(to) - std::log(from))) : from + t * (to - from);
}

}  // namespace

PointSet::PointSet(std::vector<std::string> cases, std::vector<Variation> variations, Sampling sampling,
                   std::size_t samples, std::uint64_t seed)
    : cases_(std::move(cases)), variations_(std::move(variations)) {
  if (cases_.empty()) throw std::invalid_argument("a study needs at least one case");
  std::set<std::string> names;
  for (const Variation& v : variations_) {
    if (v.keys.empty() || v.values.empty())
      throw std::invalid_argument(fmt::format("variation `{}` has no values", v.name));
    if (!names.insert(v.name).second) throw std::invalid_argument(fmt::format("two variations are named `{}`", v.name));
  }
  if (sampling == Sampling::latin_hypercube) {
    if (samples == 0) throw std::invalid_argument("a Latin hypercube needs at least one sample");
    points_per_case_ = samples;
    std::mt19937_64 rng(seed);
    for (const Variation& v : variations_) {
      std::vector<double>& column = hypercube_.emplace_back();
      for (const double t : batch::latin_column(samples, rng)) {
        const auto pick = static_cast<std::size_t>(t * static_cast<double>(v.values.size()));
        column.push_back(v.range ? between(v, t) : v.values[std::min(pick, v.values.size() - 1)]);
      }
    }
    return;
  }
  double size = static_cast<double>(cases_.size());
  for (const Variation& v : variations_) {
    size *= static_cast<double>(v.values.size());
    if (size > 0x1p53) throw std::invalid_argument("the grid has more points than can be counted");
    points_per_case_ *= v.values.size();
  }
}

Point PointSet::point(std::size_t index) const {
  if (index >= size()) throw std::out_of_range(fmt::format("point {} of a study of {}", index, size()));
  Point point{index, index / points_per_case_, std::vector<double>(variations_.size())};
  std::size_t rest = index % points_per_case_;
  for (std::size_t v = variations_.size(); v-- > 0;) {
    if (!hypercube_.empty()) {
      point.values[v] = hypercube_[v][rest];
    } else {
      const auto& values = variations_[v].values;
      point.values[v] = values[rest % values.size()];
      rest /= values.size();
    }
  }
  return point;
}

std::vector<double> spread(double from, double to, std::size_t count, bool logarithmic) {
  if (count == 0) throw std::invalid_argument("a range needs a count of at least 1");
  if (!std::isfinite(from) || !std::isfinite(to)) throw std::invalid_argument("a range needs finite ends");
  if (logarithmic && !(from > 0.0 && to > 0.0)) throw std::invalid_argument("a logarithmic range needs ends above 0");
  std::vector<double> values(count, from);
  for (std::size_t i = 1; i < count; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(count - 1);
    values[i] = logarithmic ? from * std::pow(to / from, t) : from + t * (to - from);
  }
  if (count > 1) values.back() = to;
  return values;
}

}  // namespace accdec::study
