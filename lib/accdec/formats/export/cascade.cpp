#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/formats/export/exported_json.hpp>
#include <accdec/result.hpp>

namespace accdec {
namespace {

/// Quotient of `taps` by a moving average of `length`, or nothing when it leaves more than `rest_max` at any tap.
std::vector<double> divided(const std::vector<double>& taps, int length, double rest_max) {
  const int n = static_cast<int>(taps.size()), m = n - length + 1;
  // q[i] = q[i - length] + length (taps[i] - taps[i - 1])
  const auto step = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    return length * (taps[at] - (i > 0 ? taps[at - 1] : 0.0));
  };
  // Most lengths leave a remainder at the first of these, which a few steps tell.
  for (int i = m; i < n; ++i) {
    double rest = 0.0;
    for (int j = i % length; j <= i; j += length) rest += step(j);
    if (std::abs(rest) > rest_max * length) return {};
  }
  std::vector<double> q;
  for (int i = 0; i < m; ++i) q.push_back(step(i) + (i >= length ? q[static_cast<std::size_t>(i - length)] : 0.0));
  return q;
}

bool factor(const std::vector<double>& taps, int longest, int averages, double tolerance, std::vector<int>& lengths) {
  if (taps.size() == 1) return true;
  if (averages == 0) return false;
  const double rest_max = tolerance * *std::max_element(taps.begin(), taps.end());
  for (int length = std::min(longest, static_cast<int>(taps.size())); length >= 2; --length) {
    const std::vector<double> rest = divided(taps, length, rest_max);
    if (rest.empty()) continue;
    lengths.push_back(length);
    if (factor(rest, length, averages - 1, tolerance, lengths)) return true;
    lengths.pop_back();
  }
  return false;
}

/// The two moving averages, together as long as the filter, that are nearest to it.
struct NearestCascade {
  int first = 0, second = 0;
  double deviation = unlimited, largest = 0.0;  ///< greatest difference of a tap; greatest tap
};

NearestCascade nearest_cascade(const Filter& filter) {
  NearestCascade near;
  const int begin = filter.first_nonzero_tap(), span = filter.last_nonzero_tap() - begin + 1;
  for (int i = 0; i < span; ++i) near.largest = std::max(near.largest, filter.tap(begin + i));
  for (int first = (span + 2) / 2; first <= span; ++first) {
    const int second = span + 1 - first;
    double deviation = 0.0;
    for (int i = 0; i < span; ++i) {
      // A trapezoid: the two lengths overlap in this many samples.
      const double tap = std::min({i + 1, second, span - i}) / (static_cast<double>(first) * second);
      deviation = std::max(deviation, std::abs(filter.tap(begin + i) - tap));
    }
    if (deviation < near.deviation) near = {first, second, deviation, near.largest};
  }
  return near;
}

}  // namespace

std::vector<int> moving_average_cascade(const Filter& filter, double tolerance) {
  const auto taps =
      filter.taps().subspan(static_cast<std::size_t>(filter.first_nonzero_tap()),
                            static_cast<std::size_t>(filter.last_nonzero_tap() - filter.first_nonzero_tap() + 1));
  std::vector<int> lengths;
  const std::vector<double> own(taps.begin(), taps.end());
  // A zero between other taps (as in zero-vibration shapers) does not disturb the division; its remainder decides.
  if (!factor(own, static_cast<int>(own.size()), 3, tolerance, lengths)) lengths.clear();
  return lengths;
}

std::string cascade_export(const ExportedDesign& design) {
  const Filter& filter = design.filter;
  const std::vector<int> lengths = moving_average_cascade(filter);
  if (lengths.empty() && filter.first_nonzero_tap() != filter.last_nonzero_tap()) {
    const NearestCascade near = nearest_cascade(filter);
    throw std::invalid_argument(
        fmt::format("these taps are no cascade of up to three moving averages; the nearest one of two, lengths {} and "
                    "{}, misses a tap by {:.3g} (the largest is {:.3g}); export as csv, c, json or npy",
                    near.first, near.second, near.deviation, near.largest));
  }
  nlohmann::ordered_json json;
  json["sample_period_s"] = design.period;
  json["leading_delay_samples"] = filter.first_nonzero_tap();
  json["moving_average_lengths"] = lengths;
  add_about(json, design);
  return exported_text(json, 2) + "\n";
}

}  // namespace accdec
