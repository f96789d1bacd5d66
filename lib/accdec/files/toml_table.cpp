#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/files/check_keys.hpp>
#include <accdec/files/toml_table.hpp>

namespace accdec::toml_input {
namespace {

InputError error_at(const std::string& file, const toml::source_region& source, const std::string& pointer,
                    const std::string& message) {
  return InputError(file, source.begin.line, source.begin.column, message, pointer);
}

std::string missing_text(const std::string& label, const Key& key) {
  const std::string allowed = allowed_text(key);
  return fmt::format("{} needs `{}`{}{}", label, key.name, allowed.empty() ? "" : "; ", allowed);
}

/// A TOML value as KeyCheck sees it.
class TomlNode {
 public:
  TomlNode(const toml::node& node, const std::string& file, const toml::key* name = nullptr)
      : node_(node), file_(file), name_(name) {}

  bool is_null() const { return false; }
  bool is_table() const { return node_.is_table(); }
  bool is_list() const { return node_.is_array(); }
  bool is_text() const { return node_.is_string(); }
  bool is_boolean() const { return node_.is_boolean(); }
  bool is_number() const { return node_.is_number(); }
  bool is_integer() const { return node_.is_integer(); }
  double number() const { return *node_.value<double>(); }
  const std::string& text() const { return node_.as_string()->get(); }
  std::size_t size() const { return node_.as_array()->size(); }
  TomlNode element(std::size_t i) const { return {*node_.as_array()->get(i), file_}; }
  std::optional<TomlNode> find(std::string_view key) const {
    const toml::node* found = node_.as_table()->get(key);
    return found ? std::optional(TomlNode(*found, file_)) : std::nullopt;
  }
  template <class Do>
  void for_each_member(Do member) const {
    for (const auto& [name, value] : *node_.as_table()) member(name.str(), TomlNode(value, file_, &name));
  }

  std::string_view type_name() const {
    switch (node_.type()) {
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

  InputError fault(const std::string& pointer, const std::string& message) const {
    return error_at(file_, node_.source(), pointer, message);
  }
  InputError fault_of_name(const std::string& pointer, const std::string& message) const {
    return error_at(file_, name_->source(), pointer, message);
  }

  // The words of the format.
  static constexpr bool is_toml = true;
  static std::string subject(std::string_view key) { return fmt::format("`{}` ", key); }
  static std::string subject(std::string_view key, std::size_t i) { return fmt::format("`{}`: element {} ", key, i); }
  static std::string equals(const std::string& what) { return what + "= "; }
  static std::string unknown(std::string_view key, const std::string& label, const std::string& hint) {
    return fmt::format("unknown key `{}` in {}; {}", key, label, hint);
  }
  static std::string missing(const std::string& label, const Key& key) { return missing_text(label, key); }
  static std::string no_table(std::string_view key, const TomlNode& got) {
    if (got.node_.is_array_of_tables()) return fmt::format("`{0}` is one table; write [{0}], once, not [[{0}]]", key);
    return fmt::format("`{0}` must be a table [{0}], got {1}", key, got.type_name());
  }
  static std::string no_list(std::string_view key, const TomlNode& got) {
    if (got.is_table()) return fmt::format("`{0}` is a list of tables; write [[{0}]], not [{0}]", key);
    return fmt::format("`{0}` must be a list of tables [[{0}]], got {1}", key, got.type_name());
  }
  static std::string no_element(std::string_view key, std::size_t i, const TomlNode& got) {
    return fmt::format("`{0}` must hold tables [[{0}]] only, element {1} is {2}", key, i, got.type_name());
  }

 private:
  const toml::node& node_;
  const std::string& file_;
  const toml::key* name_;
};

}  // namespace

Faults check_keys(const toml::table& tree, const std::string& file, const std::string& label,
                  const std::string& pointer, const std::vector<Key>& keys) {
  Faults faults;
  KeyCheck<TomlNode>(keys, faults).table(TomlNode(tree, file), keys, label, pointer);
  return faults;
}

Table::Table(const toml::table& table, std::string file, std::string label, std::string pointer,
             const std::vector<Key>& keys)
    : table_(&table), keys_(&keys), file_(std::move(file)), label_(std::move(label)), pointer_(std::move(pointer)) {}

const Key& Table::key(std::string_view name) const {
  if (const Key* found = find_key(*keys_, name)) return *found;
  throw std::logic_error(fmt::format("{} has no key `{}`", label_, name));
}

std::optional<double> Table::number(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  const std::optional<double> value = node && node->is_number() ? node->value<double>() : default_number(k);
  return value ? std::optional(to_si(k, *value)) : std::nullopt;
}

std::optional<int> Table::integer(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  const auto value = node && node->is_integer() ? node->value<double>() : default_number(k);
  if (!value || !k.range.holds(*value)) return std::nullopt;
  return static_cast<int>(*value);
}

std::optional<std::string> Table::text(std::string_view name) const {
  key(name);
  const toml::node* node = table_->get(name);
  return node ? node->value_exact<std::string>() : std::nullopt;
}

std::string Table::word(std::string_view name) const {
  const Key& k = key(name);
  const bool known = std::find(k.words.begin(), k.words.end(), k.fallback) != k.words.end();
  return text(name).value_or(known ? k.fallback : "");
}

bool Table::boolean(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  return node && node->is_boolean() ? node->as_boolean()->get() : k.fallback == "true";
}

std::vector<double> Table::numbers(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  std::vector<double> values;
  if (!node) return values;
  if (node->is_number()) return {to_si(k, *node->value<double>())};
  if (const toml::array* list = node->as_array()) {
    values.reserve(list->size());
    for (const toml::node& element : *list) values.push_back(to_si(k, element.value_or(0.0)));
  }
  return values;
}

std::vector<std::pair<double, double>> Table::pairs(std::string_view name) const {
  std::vector<std::pair<double, double>> values;
  if (!has(name)) return values;
  for (const toml::node& element : *table_->get(name)->as_array()) {
    const toml::array& pair = *element.as_array();
    values.emplace_back(pair[0].value_or(0.0), pair[1].value_or(0.0));
  }
  return values;
}

std::vector<std::string> Table::texts(std::string_view name) const {
  if (const auto one = text(name)) return {*one};
  std::vector<std::string> values;
  if (const toml::node* node = table_->get(name); node && node->is_array()) {
    for (const toml::node& element : *node->as_array()) values.push_back(element.value_or(std::string()));
  }
  return values;
}

double Table::required_number(std::string_view name) const {
  if (const auto value = number(name)) return *value;
  fail_missing(name);
}

int Table::required_integer(std::string_view name) const {
  if (const auto value = integer(name)) return *value;
  fail_missing(name);
}

std::vector<double> Table::required_numbers(std::string_view name) const {
  if (!has(name)) fail_missing(name);
  return numbers(name);
}

std::optional<Table> Table::table(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  if (!node || !node->is_table()) return std::nullopt;
  return Table(*node->as_table(), file_, fmt::format("[{}]", name), pointer_ + "/" + pointer_step(name), k.keys);
}

std::vector<Table> Table::tables(std::string_view name) const {
  const Key& k = key(name);
  const toml::node* node = table_->get(name);
  std::vector<Table> all;
  if (!node || !node->is_array()) return all;
  for (const toml::node& element : *node->as_array()) {
    const std::size_t i = all.size();
    if (!element.is_table()) break;
    all.emplace_back(*element.as_table(), file_, fmt::format("[[{}]] {}", name, i + 1),
                     fmt::format("{}/{}/{}", pointer_, pointer_step(name), i), k.keys);
  }
  return all;
}

void Table::fail(const std::string& message) const {
  throw error_at(file_, table_->source(), pointer_, message);
}

void Table::fail_at(std::string_view name, const std::string& message) const {
  const toml::node* node = table_->get(name);
  if (node == nullptr) fail(message);
  throw error_at(file_, node->source(), pointer_ + "/" + pointer_step(name), message);
}

void Table::fail_at(std::string_view name, std::size_t element, const std::string& message) const {
  const toml::node* node = table_->get(name);
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr || element >= array->size()) fail_at(name, message);
  throw error_at(file_, (*array)[element].source(), fmt::format("{}/{}/{}", pointer_, pointer_step(name), element),
                 message);
}

void Table::fail_missing(std::string_view name) const {
  fail(missing_text(label_, key(name)));
}

std::string Table::place(std::string_view name) const {
  const toml::node* node = table_->get(name);
  const auto line = (node == nullptr ? static_cast<const toml::node&>(*table_) : *node).source().begin.line;
  return line > 0 ? fmt::format("line {}", line) : pointer_ + "/" + std::string(name);
}

}  // namespace accdec::toml_input
