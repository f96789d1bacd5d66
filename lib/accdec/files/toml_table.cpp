#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include <accdec/files/errors.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/files/toml_table.hpp>

namespace accdec::toml_input {
namespace {

/// JSON pointers escape "~" and "/".
std::string escaped(std::string_view key) {
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

std::string list(std::span<const std::string_view> words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

std::string Range::text(std::string_view key) const {
  return fmt::format("allowed is {} {} {} <= {}", low, open_low ? "<" : "<=", key, high);
}

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table: return "a table";
    case toml::node_type::array: return "an array";
    case toml::node_type::string: return "a string";
    case toml::node_type::integer: return "an integer";
    case toml::node_type::floating_point: return "a number with a fraction";
    case toml::node_type::boolean: return "a boolean";
    case toml::node_type::date:
    case toml::node_type::time:
    case toml::node_type::date_time: return "a date or time";
    default: return "nothing";
  }
}

Table::Table(const toml::table& table, std::string file, std::string label, std::string pointer,
             std::initializer_list<std::string_view> keys, std::string (*elsewhere)(std::string_view))
    : Table(table, std::move(file), std::move(label), std::move(pointer), std::vector<std::string_view>(keys),
            elsewhere) {}

Table::Table(const toml::table& table, std::string file, std::string label, std::string pointer,
             std::vector<std::string_view> keys, std::string (*elsewhere)(std::string_view))
    : table_(table), file_(std::move(file)), label_(std::move(label)), pointer_(std::move(pointer)) {
  check_keys(keys, elsewhere);
}

void Table::check_keys(const std::vector<std::string_view>& keys, std::string (*elsewhere)(std::string_view)) const {
  // The first in the file, not in the alphabet, is the one to name.
  const toml::key* first = nullptr;
  for (const auto& [key, node] : table_) {
    if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
    const auto position = [](const toml::key& k) { return std::pair(k.source().begin.line, k.source().begin.column); };
    if (first == nullptr || position(key) < position(*first)) first = &key;
  }
  if (first == nullptr) return;
  const std::string known = nearest(first->str(), keys);
  std::string hint = known.empty() && elsewhere != nullptr ? elsewhere(first->str()) : "";
  if (hint.empty()) hint = suggest(first->str(), keys);
  throw InputError(file_, first->source().begin.line, first->source().begin.column,
                   fmt::format("unknown key `{}` in {}; {}", first->str(), label_, hint),
                   pointer_ + "/" + escaped(first->str()));
}

void Table::fail_node(const toml::node& node, const std::string& pointer, const std::string& message) const {
  throw InputError(file_, node.source().begin.line, node.source().begin.column, message, pointer);
}

void Table::fail(const std::string& message) const {
  fail_node(table_, pointer_, message);
}

void Table::fail_at(std::string_view key, const std::string& message) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) fail(message);
  fail_node(*node, pointer_ + "/" + escaped(key), message);
}

void Table::fail_at(std::string_view key, std::size_t element, const std::string& message) const {
  const toml::node* node = table_.get(key);
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr || element >= array->size()) fail_at(key, message);
  fail_node((*array)[element], fmt::format("{}/{}/{}", pointer_, escaped(key), element), message);
}

std::string Table::place(std::string_view key) const {
  const toml::node* node = table_.get(key);
  const auto line = (node == nullptr ? static_cast<const toml::node&>(table_) : *node).source().begin.line;
  return line > 0 ? fmt::format("line {}", line) : pointer_ + "/" + std::string(key);
}

void Table::wrong_type(std::string_view key, std::string_view wanted) const {
  fail_at(key, fmt::format("`{}` must be {}, got {}", key, wanted, type_name(*table_.get(key))));
}

double Table::checked(const toml::node& node, std::string_view key, const std::string& what, const Range& range) const {
  const double x = node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  if (!std::isfinite(x))
    fail_node(node, pointer_ + "/" + escaped(key),
              fmt::format("{} must be finite, got {}; {}", what, x, range.text(key)));
  if (!range.holds(x))
    fail_node(node, pointer_ + "/" + escaped(key),
              fmt::format("{} = {} is out of range; {}", what, x, range.text(key)));
  return x;
}

std::optional<double> Table::number(std::string_view key, const Range& range) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_number()) wrong_type(key, "a number");
  return checked(*node, key, fmt::format("`{}`", key), range);
}

double Table::required_number(std::string_view key, const Range& range) const {
  if (!has(key)) fail(fmt::format("{} needs `{}`; {}", label_, key, range.text(key)));
  return *number(key, range);
}

std::optional<int> Table::integer(std::string_view key, int low, int high) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_integer()) wrong_type(key, fmt::format("a whole number, {} <= {} <= {}", low, key, high));
  return static_cast<int>(
      checked(*node, key, fmt::format("`{}`", key), {static_cast<double>(low), static_cast<double>(high)}));
}

int Table::required_integer(std::string_view key, int low, int high) const {
  if (!has(key)) fail(fmt::format("{} needs `{}`; allowed is {} <= {} <= {}", label_, key, low, key, high));
  return *integer(key, low, high);
}

std::optional<bool> Table::boolean(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) wrong_type(key, "true or false");
  return node->as_boolean()->get();
}

std::optional<std::string> Table::text(std::string_view key, bool empty_allowed, bool long_text) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) wrong_type(key, "a string in quotes");
  const std::string& value = node->as_string()->get();
  if (value.empty() && !empty_allowed) fail_at(key, fmt::format("`{}` must not be empty", key));
  const std::size_t limit = long_text ? 2000 : 200;
  if (value.size() > limit)
    fail_at(key, fmt::format("`{}` has {} bytes; at most {} are allowed", key, value.size(), limit));
  if (std::any_of(value.begin(), value.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; })) {
    fail_at(key, fmt::format("`{}` holds a control character; printable text on one line is allowed", key));
  }
  return value;
}

std::optional<std::string> Table::word(std::string_view key, std::span<const std::string_view> words) const {
  const auto value = text(key, true);
  if (!value || std::find(words.begin(), words.end(), *value) != words.end()) return value;
  const std::string near = nearest(*value, words);
  fail_at(key, fmt::format("`{}` = \"{}\" is unknown; {}allowed are {}", key, *value,
                           near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near), list(words)));
}

std::optional<std::vector<double>> Table::numbers(std::string_view key, const Range& range, std::size_t least,
                                                  std::size_t most, bool lone) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return std::nullopt;
  if (lone && node->is_number()) return std::vector<double>{checked(*node, key, fmt::format("`{}`", key), range)};
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, lone ? "a number or an array of numbers" : "an array of numbers");
  if (array->size() < least || array->size() > most) {
    const std::string allowed = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
    fail_at(key, fmt::format("`{}` has {} numbers; allowed are {}", key, array->size(), allowed));
  }
  std::vector<double> values;
  values.reserve(array->size());
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node& element = (*array)[i];
    if (!element.is_number()) {
      fail_at(key, i, fmt::format("`{}`: element {} must be a number, got {}", key, i, type_name(element)));
    }
    values.push_back(checked(element, key, fmt::format("`{}`: element {}", key, i), range));
  }
  return values;
}

const toml::table* Table::table(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return nullptr;
  if (node->is_array_of_tables()) fail_at(key, fmt::format("`{0}` is one table; write [{0}], once, not [[{0}]]", key));
  if (!node->is_table()) wrong_type(key, fmt::format("a table [{}]", key));
  return node->as_table();
}

std::vector<const toml::table*> Table::tables(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (node == nullptr) return {};
  if (node->is_table()) fail_at(key, fmt::format("`{0}` is a list of tables; write [[{0}]], not [{0}]", key));
  const toml::array* array = node->as_array();
  if (array == nullptr) wrong_type(key, fmt::format("a list of tables [[{}]]", key));
  std::vector<const toml::table*> result;
  for (std::size_t i = 0; i < array->size(); ++i) {
    if (!(*array)[i].is_table()) {
      fail_at(key, i,
              fmt::format("`{0}` must hold tables [[{0}]] only, element {1} is {2}", key, i, type_name((*array)[i])));
    }
    result.push_back((*array)[i].as_table());
  }
  return result;
}

}  // namespace accdec::toml_input
