#include <cctype>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/si_names.hpp>
#include <accdec/formats/task_keys.hpp>

namespace accdec {
namespace {

void replace_every(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

bool in_a_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Renames a key wherever it stands as a word, and converts its number unless that has a unit: "`feed_in_mm_min` = 60".
void rename_key(std::string& text, const Key& key, const std::string& name) {
  for (std::size_t at = text.find(key.name); at != std::string::npos; at = text.find(key.name, at + name.size())) {
    const std::size_t end = at + key.name.size();
    if ((at > 0 && in_a_name(text[at - 1])) || (end < text.size() && in_a_name(text[end]))) continue;
    text.replace(at, key.name.size(), name);
    std::size_t number = at + name.size();
    if (number < text.size() && text[number] == '`') ++number;
    if (text.compare(number, 3, " = ") != 0) continue;
    number += 3;
    const char* const start = text.c_str() + number;
    char* last = nullptr;
    const double value = std::strtod(start, &last);
    if (last != start && !std::string_view(last).starts_with(" " + key.unit))
      text.replace(number, static_cast<std::size_t>(last - start), fmt::format("{:.9g}", to_named_si(key, value)));
  }
}

/// The unit of a key in SI, by name.
std::string unit_in_si(const Key& key) {
  const std::string& unit = key.unit;
  if (unit == "degrees") return "rad";
  if (unit == "mm/min") return "m/s";
  if (unit == "um" || unit == "ms") return unit.substr(1);
  if (unit.starts_with("mm")) return unit.substr(1);
  return unit.starts_with("deg/") ? "rad" + unit.substr(3) : unit;
}

/// Suggestions name the unit of the key; under its name in SI the number is in SI.
void mend_unit(std::string& text, const Key& key) {
  const std::string head = fmt::format("`{}`? Its number is in ", key.name), other = ", not in ";
  const std::size_t at = text.find(head + key.unit + other);
  if (at == std::string::npos) return;
  const std::size_t unit = at + head.size(), given = unit + key.unit.size() + other.size();
  if (std::string_view(text).substr(given) == unit_in_si(key))
    text.resize(at + head.find(" Its"));
  else
    text.replace(unit, key.unit.size(), unit_in_si(key));
}

/// Converts numbers of a key to SI proper.
const Key& named_unit(const Key& key) {
  static const Key degrees{.unit = "degrees"}, si{};
  if (!is_rotary_key(key.name)) return key;
  return key.unit.starts_with("deg/") ? degrees : si;
}

}  // namespace

std::string si_name(const Key& key) {
  const Unit* unit = unit_in_name(key.name);
  return unit && unit->name == key.unit ? key.name.substr(0, key.name.size() - unit->suffix.size()) : key.name;
}

double to_named_si(const Key& key, double value) {
  return to_si(named_unit(key), value);
}

double from_named_si(const Key& key, double si) {
  return from_si(named_unit(key), si);
}

const Key* key_in_si(std::string_view table, std::string_view name, bool turns) {
  const Key* found = table.empty() ? nullptr : find_key(task_file().keys, table);
  if (!table.empty() && !found) return nullptr;
  const std::vector<Key>& keys = found ? found->keys : task_file().keys;
  if (find_key(keys, name) != nullptr) return nullptr;  // a name of its own
  for (const Key& key : keys) {
    const bool of_others = table == "axis" && (turns ? rotary_key(key.name) != key.name : is_rotary_key(key.name));
    if (!of_others && name != key.name && name == si_name(key)) return &key;
  }
  return nullptr;
}

std::string of_other_axes(std::string_view name, std::string_view axis) {
  const bool turns = is_rotary(axis);
  const Key* other = key_in_si("axis", name, !turns);
  if (other == nullptr || key_in_si("axis", name, turns) != nullptr) return "";
  if (!turns) return fmt::format("`{}` is for rotary axes; allowed on axes named a, b and c", name);
  return fmt::format("`{}` is for linear axes; axis {} has `{}`", name, axis,
                     si_name(*find_key(rotary_keys(), rotary_key(other->name))));
}

Range range_in_si(const Key& key) {
  Range range = key.range;
  for (double* bound : {&range.low, &range.high}) *bound = std::stod(fmt::format("{:.9g}", to_named_si(key, *bound)));
  return range;
}

std::string in_si_names(std::string message, std::string_view written) {
  const auto mend = [&](std::string_view table, const Key& key) {
    const std::string name = si_name(key);
    if (message.find(key.name) == std::string::npos || key_in_si(table, name, is_rotary_key(key.name)) != &key) return;
    if (written.find(fmt::format("\"{}\"", key.name)) != std::string_view::npos) return;
    const std::size_t head = std::string_view("allowed is ").size();
    replace_every(message, key.range.text(key.name).substr(head), range_in_si(key).text(name).substr(head));
    mend_unit(message, key);
    rename_key(message, key, name);
  };
  for (const Key& key : task_file().keys) {
    mend("", key);
    for (const Key& inner : key.keys) mend(key.name, inner);
  }
  return message;
}

}  // namespace accdec
