#include <cctype>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
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
      text.replace(number, static_cast<std::size_t>(last - start), fmt::format("{:.9g}", to_si(key, value)));
  }
}

}  // namespace

std::string si_name(const Key& key) {
  const Unit* unit = unit_in_name(key.name);
  const bool rotary = key.unit.starts_with("deg/") || key.unit == "kg m^2" || key.unit.starts_with("N m");
  return unit && !rotary && unit->name == key.unit ? key.name.substr(0, key.name.size() - unit->suffix.size())
                                                   : key.name;
}

const Key* key_in_si(std::string_view table, std::string_view name) {
  const Key* found = table.empty() ? nullptr : find_key(task_file().keys, table);
  if (!table.empty() && !found) return nullptr;
  const std::vector<Key>& keys = found ? found->keys : task_file().keys;
  if (find_key(keys, name) != nullptr) return nullptr;  // a name of its own
  for (const Key& key : keys) {
    if (name != key.name && name == si_name(key)) return &key;
  }
  return nullptr;
}

Range range_in_si(const Key& key) {
  Range range = key.range;
  for (double* bound : {&range.low, &range.high}) *bound = std::stod(fmt::format("{:.9g}", to_si(key, *bound)));
  return range;
}

std::string in_si_names(std::string message, std::string_view written) {
  const auto mend = [&](std::string_view table, const Key& key) {
    const std::string name = si_name(key);
    if (message.find(key.name) == std::string::npos || key_in_si(table, name) != &key) return;
    if (written.find(fmt::format("\"{}\"", key.name)) != std::string_view::npos) return;
    const std::size_t head = std::string_view("allowed is ").size();
    replace_every(message, key.range.text(key.name).substr(head), range_in_si(key).text(name).substr(head));
    rename_key(message, key, name);
  };
  for (const Key& key : task_file().keys) {
    mend("", key);
    for (const Key& inner : key.keys) mend(key.name, inner);
  }
  return message;
}

}  // namespace accdec
