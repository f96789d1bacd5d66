#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/files/units.hpp>

namespace accdec {
namespace {

std::string normalised(std::string_view word) {
  std::string text(word);
  for (char& c : text)
    c = c == '-' || c == ' ' || c == '.' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string_view without_unit(std::string_view word) {
  for (const Unit& unit : units) {
    const std::string suffix = normalised(unit.suffix);
    if (word.size() > suffix.size() && word.ends_with(suffix)) return word.substr(0, word.size() - suffix.size());
  }
  return word;
}

/// Whether every word of a name begins the same word of another one, with three letters at least.
bool abbreviates(std::string_view name, std::string_view whole) {
  while (!name.empty() && !whole.empty()) {
    const std::size_t end = std::min(name.find('_'), name.size()), whole_end = std::min(whole.find('_'), whole.size());
    if (end < 3 || !whole.substr(0, whole_end).starts_with(name.substr(0, end))) return false;
    name.remove_prefix(std::min(end + 1, name.size()));
    whole.remove_prefix(std::min(whole_end + 1, whole.size()));
  }
  return name.empty() && whole.empty();
}

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the dynamic program, because a swap looks two rows back.
  std::vector<int> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearest(std::string_view word, std::span<const std::string_view> allowed) {
  if (word.empty() || word.size() > 80) return "";
  const std::string given = normalised(word);
  std::string_view best;
  int best_cost = 1 << 20;
  const auto offer = [&](std::string_view key, int cost) {
    if (cost < best_cost) best = key, best_cost = cost;
  };
  for (const std::string_view key : allowed) {
    const std::string known = normalised(key);
    const std::string_view stem = without_unit(known), given_stem = without_unit(given);
    // Distances count in half steps: then a wrong unit costs less than a typing error, and exact stems win.
    const int whole = 2 * edit_distance(given, known), stems = 2 * edit_distance(given_stem, stem) + 1;
    const int permitted = 2 * std::max<int>(1, static_cast<int>(std::min(stem.size(), given_stem.size())) / 3);
    if (whole <= permitted) offer(key, whole);
    if (stems <= permitted + 1) offer(key, stems);
    if (given.size() >= 4 && known.starts_with(given + "_")) offer(key, 3);  // "delay" for "delay_samples"
    if (abbreviates(given_stem, stem)) offer(key, 5);                        // "accel_max" for "acceleration_max"
  }
  return std::string(best);
}

namespace {

/// The unit at the end of a name, also one that no file of ours has; empty if there is none.
std::string_view unit_of(std::string_view name) {
  if (name.ends_with("_mm_min2")) return "mm/min^2";
  if (name.ends_with("_m_min2")) return "m/min^2";
  const Unit* unit = unit_in_name(name);
  return unit == nullptr ? "" : unit->name;
}

/// Whoever only renames the key leaves a number that is in another unit.
std::string other_unit(std::string_view given, std::string_view key) {
  const std::string_view from = unit_of(given), to = unit_of(key);
  return from.empty() || to.empty() || from == to ? "" : fmt::format(" Its number is in {}, not in {}", to, from);
}

}  // namespace

std::string suggest(std::string_view word, std::span<const std::string_view> allowed) {
  if (const std::string near = nearest(word, allowed); !near.empty())
    return "did you mean `" + near + "`?" + other_unit(word, near);
  std::string text = "known here:";
  for (std::size_t i = 0; i < allowed.size(); ++i) {
    text += i == 0 ? " " : ", ";
    text += allowed[i];
  }
  return text;
}

std::string unknown_name(std::string_view noun, std::string_view name, const std::vector<std::string>& known) {
  const std::string near = nearest(name, std::vector<std::string_view>(known.begin(), known.end()));
  return fmt::format("unknown {} \"{}\"; {}known are {}", noun, name,
                     near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near), fmt::join(known, ", "));
}

}  // namespace accdec
