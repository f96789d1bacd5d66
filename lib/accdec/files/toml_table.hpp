#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include <accdec/files/faults.hpp>
#include <accdec/files/keys.hpp>

// Internal: strict access to the tables of a TOML file. For the readers of files only (it needs toml++).

namespace accdec::toml_input {

/// Errors of a tree against its keys: unknown keys with a suggestion, missing keys, wrong types, numbers out of range.
/// @param label    how messages call the top level: "the task (top level)"
/// @param pointer  where the tree stands in its file, "" for the top
Faults check_keys(const toml::table& tree, const std::string& file, const std::string& label,
                  const std::string& pointer, const std::vector<Key>& keys);

/// One table of a checked input tree, with its place in the file. For a value that its key does not allow, accessors
/// return nothing or the default. Asking for a key that the table does not have is std::logic_error.
class Table {
 public:
  /// @param keys  must outlive the table
  Table(const toml::table& table, std::string file, std::string label, std::string pointer,
        const std::vector<Key>& keys);

  /// Whether it was given.
  bool has(std::string_view key) const { return table_->contains(key); }

  // The given value, or the default if there is one.
  std::optional<double> number(std::string_view key) const;  ///< SI
  std::optional<int> integer(std::string_view key) const;
  std::optional<std::string> text(std::string_view key) const;
  std::string word(std::string_view key) const;  ///< "" if there is none
  bool boolean(std::string_view key) const;
  std::vector<double> numbers(std::string_view key) const;                   ///< SI; none if not given
  std::vector<std::pair<double, double>> pairs(std::string_view key) const;  ///< in their units; none if not given
  std::vector<std::string> texts(std::string_view key) const;  ///< also of KeyType::words; none if not given

  // The same, for keys required here. Throw InputError at the table if there is none.
  double required_number(std::string_view key) const;
  int required_integer(std::string_view key) const;
  std::vector<double> required_numbers(std::string_view key) const;

  std::optional<Table> table(std::string_view key) const;  ///< [key]
  std::vector<Table> tables(std::string_view key) const;   ///< [[key]] ...
  const toml::table& raw() const { return *table_; }

  const std::string& pointer() const { return pointer_; }
  const std::string& file() const { return file_; }

  [[noreturn]] void fail(const std::string& message) const;  ///< at the table
  /// At the key's value, or at the table if it was not given.
  [[noreturn]] void fail_at(std::string_view key, const std::string& message) const;
  [[noreturn]] void fail_at(std::string_view key, std::size_t element, const std::string& message) const;
  [[noreturn]] void fail_missing(std::string_view key) const;
  /// "line 12" or the pointer, to mention another place in a message.
  std::string place(std::string_view key) const;

 private:
  const Key& key(std::string_view name) const;

  const toml::table* table_;
  const std::vector<Key>* keys_;
  std::string file_, label_, pointer_;
};

}  // namespace accdec::toml_input
