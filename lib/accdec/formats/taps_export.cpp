#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/taps_export.hpp>

namespace accdec {
namespace {

std::string csv(const Filter& filter) {
  std::string text = "i,b\n";
  for (int i = 0; i <= filter.order(); ++i) text += fmt::format("{},{}\n", i, filter.tap(i));
  return text;
}

std::string c_header(const Filter& filter, double period) {
  std::string text = fmt::format(
      "/* Acc/Dec filter designed by accdec: v_out[k] = sum_i accdec_taps[i] * v_in[k - i]; the taps sum to 1. */\n"
      "#ifndef ACCDEC_TAPS_H\n#define ACCDEC_TAPS_H\n\n"
      "#define ACCDEC_ORDER {}\n#define ACCDEC_SAMPLE_PERIOD_S {}\n\n"
      "static const double accdec_taps[ACCDEC_ORDER + 1] = {{\n",
      filter.order(), period);
  for (int i = 0; i <= filter.order(); ++i)
    text += fmt::format("    {:.17e}{}\n", filter.tap(i), i == filter.order() ? "" : ",");
  double sum = 0.0;
  for (const double tap : filter.taps()) sum += tap;
  return text + fmt::format("}};\n/* N + 1 = {} taps, their sum is {:.17g} */\n\n#endif\n", filter.order() + 1, sum);
}

std::string json(const DesignResult& result) {
  nlohmann::ordered_json j;
  j["order"] = result.filter->order();
  j["sample_period_s"] = result.task.sample_period;
  j["taps"] = std::vector<double>(result.filter->taps().begin(), result.filter->taps().end());
  for (const CornerResult& corner : result.corners) {
    j["corners"].push_back({{"name", corner.name}, {"delay_samples", corner.delay}});
  }
  return j.dump(2) + "\n";
}

std::string npy(const Filter& filter) {
  std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", filter.order() + 1);
  // Magic, version, length and header together fill a multiple of 64 bytes, the header ending in a line feed.
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (const double tap : filter.taps()) {
    auto word = std::bit_cast<std::uint64_t>(tap);
    for (int byte = 0; byte < 8; ++byte, word >>= 8) bytes += static_cast<char>(word & 0xff);
  }
  return bytes;
}

/// Quotient of `taps` by a moving average of `length`, or nothing when it does not divide.
std::vector<double> divided(const std::vector<double>& taps, int length, double tolerance) {
  const int n = static_cast<int>(taps.size()), m = n - length + 1;
  if (m < 1) return {};
  // taps[i] - taps[i - 1] = (q[i] - q[i - length]) / length
  std::vector<double> q(static_cast<std::size_t>(n), 0.0);
  for (int i = 0; i < n; ++i) {
    const double step = taps[static_cast<std::size_t>(i)] - (i > 0 ? taps[static_cast<std::size_t>(i - 1)] : 0.0);
    q[static_cast<std::size_t>(i)] = length * step + (i >= length ? q[static_cast<std::size_t>(i - length)] : 0.0);
  }
  const double largest = *std::max_element(taps.begin(), taps.end());
  for (int i = m; i < n; ++i) {
    if (std::abs(q[static_cast<std::size_t>(i)]) > tolerance * largest * length) return {};
  }
  q.resize(static_cast<std::size_t>(m));
  return q;
}

bool factor(const std::vector<double>& taps, int longest, int averages, double tolerance, std::vector<int>& lengths) {
  if (taps.size() == 1) return true;
  if (averages == 0) return false;
  for (int length = std::min(longest, static_cast<int>(taps.size())); length >= 2; --length) {
    const std::vector<double> rest = divided(taps, length, tolerance);
    if (rest.empty()) continue;
    lengths.push_back(length);
    if (factor(rest, length, averages - 1, tolerance, lengths)) return true;
    lengths.pop_back();
  }
  return false;
}

/// The two moving averages together as long as the filter that come nearest to it.
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

std::string cascade(const DesignResult& result) {
  const std::vector<int> lengths = moving_average_cascade(*result.filter);
  if (lengths.empty() && result.filter->first_nonzero_tap() != result.filter->last_nonzero_tap()) {
    const NearestCascade near = nearest_cascade(*result.filter);
    throw std::invalid_argument(
        fmt::format("these taps are no cascade of up to three moving averages; the nearest one of two, lengths {} and "
                    "{}, misses a tap by {:.3g} "
                    "(the largest is {:.3g}); export as csv, c, json or npy",
                    near.first, near.second, near.deviation, near.largest));
  }
  nlohmann::ordered_json j;
  j["sample_period_s"] = result.task.sample_period;
  j["leading_delay_samples"] = result.filter->first_nonzero_tap();
  j["moving_average_lengths"] = lengths;
  return j.dump(2) + "\n";
}

}  // namespace

std::vector<int> moving_average_cascade(const Filter& filter, double tolerance) {
  const auto taps =
      filter.taps().subspan(static_cast<std::size_t>(filter.first_nonzero_tap()),
                            static_cast<std::size_t>(filter.last_nonzero_tap() - filter.first_nonzero_tap() + 1));
  std::vector<int> lengths;
  const std::vector<double> own(taps.begin(), taps.end());
  // A zero between other taps (as zero-vibration shapers have) is fine for the division; its remainder decides.
  if (!factor(own, static_cast<int>(own.size()), 3, tolerance, lengths)) lengths.clear();
  return lengths;
}

std::string export_taps(const DesignResult& result, std::string_view format) {
  if (!result.filter)
    throw std::invalid_argument(fmt::format("the result is {} and has no filter to export", to_string(result.status)));
  if (format == "csv") return csv(*result.filter);
  if (format == "c") return c_header(*result.filter, result.task.sample_period);
  if (format == "json") return json(result);
  if (format == "npy") return npy(*result.filter);
  if (format == "cascade") return cascade(result);
  throw std::invalid_argument(
      fmt::format("unknown format \"{}\"; allowed are {}", format, fmt::join(taps_formats, ", ")));
}

}  // namespace accdec
