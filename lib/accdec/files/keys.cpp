#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/keys.hpp>
#include <accdec/files/units.hpp>

namespace accdec {

std::string Range::text(std::string_view key) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  if (low == -none && high == none) return fmt::format("allowed is any finite {}", key);
  if (low == -none) return fmt::format("allowed is {} <= {}", key, high);
  if (high == none) return fmt::format("allowed is {} {} {}", key, open_low ? ">" : ">=", low);
  return fmt::format("allowed is {} {} {} <= {}", low, open_low ? "<" : "<=", key, high);
}

std::string pointer_step(std::string_view key) {
  std::string text;
  for (const char c : key) {
    if (c == '~')
      text += "~0";
    else if (c == '/')
      text += "~1";
    else
      text += c;
  }
  return text;
}

Key text_key(std::string name, std::string meaning, std::string fallback, std::string example) {
  return {.name = std::move(name),
          .type = KeyType::text,
          .meaning = std::move(meaning),
          .fallback = std::move(fallback),
          .example = std::move(example)};
}

Key tables_key(std::string name, std::string meaning, std::vector<Key> keys) {
  return {.name = std::move(name), .type = KeyType::tables, .meaning = std::move(meaning), .keys = std::move(keys)};
}

Key required(Key key) {
  key.required = true;
  return key;
}

const Key* find_key(const std::vector<Key>& keys, std::string_view name) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

std::vector<std::string_view> names_of(const std::vector<Key>& keys) {
  std::vector<std::string_view> names;
  for (const Key& key : keys) names.push_back(key.name);
  return names;
}

double to_si(const Key& key, double value) {
  if (key.unit == "degrees") return value / 180.0 * std::numbers::pi;
  const Unit* unit = find_unit(key.unit);
  return unit ? value / unit->divisor : value;
}

double from_si(const Key& key, double si) {
  const double about = si / to_si(key, 1.0);
  // At most one number of 15 digits is that close to the quotient. So rounding to 15 digits finds it and removes the
  // division's error of an ulp or two.
  for (const int digits : {15, 16, 17}) {
    char text[32];
    const std::to_chars_result end = std::to_chars(text, text + sizeof text, about, std::chars_format::general, digits);
    double x = about;
    std::from_chars(text, end.ptr, x);
    if (to_si(key, x) == si) return x;
  }
  // The division may have been off by an ulp or two; one of the neighbours is the value that was read.
  double up = about, down = about;
  for (int step = 0; step < 8; ++step) {
    up = std::nextafter(up, std::numeric_limits<double>::infinity());
    down = std::nextafter(down, -std::numeric_limits<double>::infinity());
    if (to_si(key, up) == si) return up;
    if (to_si(key, down) == si) return down;
  }
  return about;  // no number converts to it, so it was not read from a file: return the nearest
}

std::optional<double> default_number(const Key& key) {
  if (key.fallback.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(key.fallback.c_str(), &end);
  return *end == '\0' ? std::optional(value) : std::nullopt;
}

std::string allowed_text(const Key& key) {
  if (!key.allowed.empty()) return key.allowed;
  switch (key.type) {
    case KeyType::number:
    case KeyType::integer:
    case KeyType::numbers: return key.range.text(key.name);
    case KeyType::word:
    case KeyType::words: return fmt::format("allowed are {}", fmt::join(key.words, ", "));
    case KeyType::boolean: return "allowed is true or false";
    case KeyType::text: return "allowed is text in quotes";
    case KeyType::texts: return "allowed is a string or a list of strings";
    default: return "";
  }
}

}  // namespace accdec
