#pragma once

#include <optional>
#include <string_view>

namespace accdec {

/// @param table  pairs of a value and its word in files
/// @return the word of a value, which the table has
template <class Table, class Value>
constexpr std::string_view word_of(const Table& table, Value value) {
  for (const auto& [named, word] : table) {
    if (named == value) return word;
  }
  return "?";
}

/// @return the value of a word; none if no value has it
template <class Value, class Table>
constexpr std::optional<Value> value_of(const Table& table, std::string_view word) {
  for (const auto& [value, name] : table) {
    if (name == word) return value;
  }
  return std::nullopt;
}

}  // namespace accdec
