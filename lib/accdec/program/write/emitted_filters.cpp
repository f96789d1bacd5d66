#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <accdec/program/write/emitted_filters.hpp>

namespace accdec {
namespace {

constexpr std::string_view taps_begin = "(filter taps: ", length_begin = "(filter of ", length_end = " taps)";
constexpr int longest = 1'000'000;  // taps

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
    if (!tap || !(*tap >= 0.0) || count < 1 || static_cast<int>(taps.size()) > longest - count) return false;
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
  for (const Toolpath::Passed& passed : path.passed) {
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

std::optional<LegFilters> emitted_legs(const Toolpath& path, const Filter& filter) {
  std::vector<std::uint16_t> of_block(path.blocks(), 0);
  std::vector<Filter> filters;
  std::map<int, std::uint16_t> known;
  for (const Toolpath::Passed& passed : path.passed) {
    std::string_view words = passed.words;
    if (!words.starts_with(length_begin) || !words.ends_with(length_end)) continue;
    words.remove_prefix(length_begin.size());
    words.remove_suffix(length_end.size());
    const int count = number<int>(words).value_or(0);
    const std::size_t first = passed.block;
    if (count < 1 || count > longest || first >= path.blocks() || (first > 0 && !ends_leg(path, first - 1)) ||
        (filters.empty() && first > 0) || filters.size() == UINT16_MAX) {
      return std::nullopt;
    }
    const auto [entry, is_new] = known.try_emplace(count, static_cast<std::uint16_t>(filters.size()));
    if (is_new) filters.push_back(count == filter.order() + 1 ? filter : stretched(filter, count));
    std::fill(of_block.begin() + static_cast<std::ptrdiff_t>(first), of_block.end(), entry->second);
  }
  if (filters.empty()) return std::nullopt;
  return LegFilters(std::move(filters), std::move(of_block));
}

}  // namespace accdec
