#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace accdec {

/// Allowed numbers, for checking and for the message.
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool open_low = false;                         ///< low itself is not allowed
  std::string text(std::string_view key) const;  ///< "allowed is 0 < key <= 180"
  bool holds(double x) const { return (open_low ? x > low : x >= low) && x <= high; }
};

enum class KeyType {
  number,   ///< finite; may be written as an integer
  integer,  ///< written without a fraction
  boolean,
  text,     ///< on one line, without control characters
  word,     ///< one of `words`
  numbers,  ///< a list
  texts,    ///< a string or a list of strings
  words,    ///< the same, of `words`
  table,
  tables  ///< a list of tables
};

/// One key of a table in a file. All knowledge about it stands here once. The readers' checks and messages, defaults,
/// conversions to SI, the documentation and the JSON Schema are made from it.
struct Key {
  std::string name{};
  KeyType type = KeyType::number;
  std::string meaning{};             ///< one sentence without a stop
  std::string unit{};                ///< as in tables, "mm/min"; see `to_si`
  Range range{};                     ///< of numbers, in the unit
  std::vector<std::string> words{};  ///< KeyType::word, words
  std::string noun{};                ///< what a word names ("solver"), for messages; may be empty
  std::size_t least = 1, most = 0;   ///< elements of a list; most = 0: any number
  std::string fallback{};            ///< the value without the key: as it would be written, or in words; may be empty
  std::string example{};             ///< as it would be written
  std::string allowed{};             ///< in words, if range and words do not say it
  bool required = false;
  bool whole = false;        ///< numbers: without a fraction
  bool per_axis = false;     ///< numbers: one for each axis of the machine
  bool lone = false;         ///< numbers: one number without brackets is a list of one
  bool pairs = false;        ///< numbers: a list of pairs [a, b], each in its own unit
  bool of_period = false;    ///< multiples of the sample period; the readers check it
  bool nullable = false;     ///< JSON: null stands for "none"
  bool empty_text = false;   ///< texts may be empty
  bool long_text = false;    ///< 2000 bytes instead of 200
  bool free = false;         ///< tables: what is in it is checked elsewhere
  std::vector<Key> keys{};   ///< of a table, or of each in a list of tables
  std::string conditions{};  ///< conditions on several keys together, as further keywords of the table's JSON Schema
};

/// A key that holds a text.
Key text_key(std::string name, std::string meaning, std::string fallback, std::string example);
/// A key that holds a list of tables.
Key tables_key(std::string name, std::string meaning, std::vector<Key> keys);
/// The same key, which no table may lack.
Key required(Key key);

/// A step of a JSON pointer, in which "~" and "/" are written otherwise.
std::string pointer_step(std::string_view key);

/// The key of that name, or null.
const Key* find_key(const std::vector<Key>& keys, std::string_view name);
std::vector<std::string_view> names_of(const std::vector<Key>& keys);

/// A number in a key's unit as SI: ms, mm, mm/s .. become s, m, m/s; um m; mm/min m/s; degrees rad; others stay.
/// Division by a power of ten rounds once, so that 100 um is the double nearest 1e-4 m.
double to_si(const Key& key, double value);

/// The number in a key's unit that reads back as exactly `si`, with as few digits as possible. If none does: the
/// nearest.
double from_si(const Key& key, double si);

/// `fallback` where it is a number. In the key's unit.
std::optional<double> default_number(const Key& key);

/// "0 < x <= 180", "`left`, `right`", "text": what a key allows, for tables and messages.
std::string allowed_text(const Key& key);

/// A kind of file: what `accdec schema NAME` calls it, its title, and the keys of its top level.
struct FileKind {
  std::string name{}, title{};
  std::vector<Key> keys{};
  std::string conditions{};  ///< as Key::conditions, of the top level
};

}  // namespace accdec
