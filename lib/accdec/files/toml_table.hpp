#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

// Internal to the room: strict access to one TOML table. Not for inclusion from other rooms (it needs toml++).

namespace accdec::toml_input {

/// Allowed values, for checking and for the message.
struct Range {
  double low, high;
  bool open_low = false;                         ///< low itself is not allowed
  std::string text(std::string_view key) const;  ///< "0 < key <= 180"
  bool holds(double x) const { return (open_low ? x > low : x >= low) && x <= high; }
};

/// One table of an input tree, with where it stands. Every accessor throws InputError at the value's position (or at
/// the table's, for a missing key), saying what is allowed. Numbers may be written as integers; NaN and infinity never
/// pass.
class Table {
 public:
  /// @param label    how messages call it: "[filter]", "[[corner]]", "the top level"
  /// @param pointer  its JSON pointer in the whole input, "" for the top
  /// @param keys     every key it may have; any other is an error with a suggestion
  /// @param elsewhere  for a key that belongs to another table: text to add ("it belongs into [[corner]]"), may be null
  Table(const toml::table& table, std::string file, std::string label, std::string pointer,
        std::initializer_list<std::string_view> keys, std::string (*elsewhere)(std::string_view) = nullptr);
  Table(const toml::table& table, std::string file, std::string label, std::string pointer,
        std::vector<std::string_view> keys, std::string (*elsewhere)(std::string_view) = nullptr);

  bool has(std::string_view key) const { return table_.contains(key); }
  std::optional<double> number(std::string_view key, const Range& range) const;
  double required_number(std::string_view key, const Range& range) const;
  std::optional<int> integer(std::string_view key, int low, int high) const;
  int required_integer(std::string_view key, int low, int high) const;
  std::optional<bool> boolean(std::string_view key) const;
  /// Without control characters; at most 200 bytes unless `long_text`. May be empty only if `empty_allowed`.
  std::optional<std::string> text(std::string_view key, bool empty_allowed = false, bool long_text = false) const;
  /// One of `words`.
  std::optional<std::string> word(std::string_view key, std::span<const std::string_view> words) const;
  /// A list of numbers; a lone number counts as a list of one only if `lone`.
  std::optional<std::vector<double>> numbers(std::string_view key, const Range& range, std::size_t least,
                                             std::size_t most, bool lone = false) const;

  const toml::table* table(std::string_view key) const;                ///< [key], or null
  std::vector<const toml::table*> tables(std::string_view key) const;  ///< [[key]] ..., or none

  const std::string& pointer() const { return pointer_; }
  const std::string& file() const { return file_; }

  [[noreturn]] void fail(const std::string& message) const;                           ///< at the table
  [[noreturn]] void fail_at(std::string_view key, const std::string& message) const;  ///< at the key's value
  [[noreturn]] void fail_at(std::string_view key, std::size_t element, const std::string& message) const;
  /// "line 12" or the pointer: for mentioning another place in a message.
  std::string place(std::string_view key) const;

 private:
  void check_keys(const std::vector<std::string_view>& keys, std::string (*elsewhere)(std::string_view)) const;
  double checked(const toml::node& node, std::string_view key, const std::string& what, const Range& range) const;
  [[noreturn]] void fail_node(const toml::node& node, const std::string& pointer, const std::string& message) const;
  [[noreturn]] void wrong_type(std::string_view key, std::string_view wanted) const;

  const toml::table& table_;
  std::string file_, label_, pointer_;
};

/// "a string", "an integer", ... for messages.
std::string_view type_name(const toml::node& node);

}  // namespace accdec::toml_input
