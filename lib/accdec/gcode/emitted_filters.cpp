#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <accdec/gcode/emitted_filters.hpp>

namespace accdec {
namespace {

constexpr std::string_view taps_begin = "(filter taps: ";
constexpr int taps_max = 1'000'000;

/// The whole of a text as a number; none if it is not one.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Adds "27*0.037 0.5" to the taps; false where that is not what it says.
bool add_taps(std::string_view text, std::vector<double>& taps) {
  while (!text.empty()) {
    std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    int count = 1;
    if (const auto star = word.find('*'); star != std::string_view::npos) {
      count = number<int>(word.substr(0, star)).value_or(0);
      word.remove_prefix(star + 1);
    }
    const std::optional<double> tap = number<double>(word);
    if (!tap || !(*tap >= 0.0) || count < 1 || static_cast<int>(taps.size()) > taps_max - count) return false;
    taps.insert(taps.end(), static_cast<std::size_t>(count), *tap);
  }
  return true;
}

}  // namespace

std::string filter_remarks(const Filter& filter) {
  const auto taps = filter.taps();
  std::string text;
  std::size_t in_line = 0;
  for (std::size_t i = 0; i < taps.size();) {
    std::size_t same = 1;
    while (i + same < taps.size() && taps[i + same] == taps[i]) ++same;
    text += in_line == 0 ? std::string(taps_begin) : " ";
    text += same > 1 ? fmt::format("{}*{}", same, taps[i]) : fmt::format("{}", taps[i]);
    i += same;
    if (++in_line < 4 && i < taps.size()) continue;
    text += ")\n";
    in_line = 0;
  }
  return text;
}

std::optional<Filter> emitted_filter(const Toolpath& path) {
  std::vector<double> taps;
  for (const Toolpath::KeptWords& passed : path.kept_words) {
    std::string_view words = passed.words;
    if (!words.starts_with(taps_begin) || !words.ends_with(')')) continue;
    words.remove_prefix(taps_begin.size());
    words.remove_suffix(1);
    if (!add_taps(words, taps)) return std::nullopt;
  }
  double sum = 0.0;
  for (const double tap : taps) sum += tap;
  if (!(std::abs(sum - 1.0) <= 1e-9)) return std::nullopt;
  return Filter(std::move(taps));
}

}  // namespace accdec
