#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/formats/task_keys.hpp>

namespace accdec {
namespace {

/// Keys with a value in a table of a task; "" is the top. Null if there is no such table.
const std::vector<Key>* keys_of(std::string_view table) {
  if (table.empty()) return &task_file().keys;
  const Key* found = find_key(task_file().keys, table);
  return found && !found->keys.empty() ? &found->keys : nullptr;
}

/// Whether a study may set a key: not keys that only name things.
bool settable(const Key& key) {
  return key.keys.empty() && key.name != "title" && key.name != "name";
}

std::vector<std::string_view> settable_names(const std::vector<Key>& keys) {
  std::vector<std::string_view> names;
  for (const Key& key : keys) {
    if (settable(key)) names.push_back(key.name);
  }
  return names;
}

std::vector<std::string_view> table_names() {
  std::vector<std::string_view> names;
  for (const Key& key : task_file().keys) {
    if (!key.keys.empty()) names.push_back(key.name);
  }
  return names;
}

bool is_list(std::string_view table) {
  const Key* key = find_key(task_file().keys, table);
  return key && key->type == KeyType::tables;
}

/// "order", "filter.order", "corner.*.weight"
std::string place_of(std::string_view table, std::string_view key) {
  if (table.empty()) return std::string(key);
  return fmt::format("{}.{}{}", table, is_list(table) ? "*." : "", key);
}

/// Another place in a task where a key is allowed; may be empty.
std::string other_place(std::string_view key) {
  if (const Key* top = find_key(task_file().keys, key); top && settable(*top)) return std::string(key);
  for (const std::string_view table : table_names()) {
    if (const Key* found = find_key(*keys_of(table), key); found && settable(*found)) return place_of(table, key);
  }
  return "";
}

std::optional<std::size_t> as_index(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Names as the task reader gives them: corners A, B, ..., and with several axes x, y, z, ... A single axis table
/// stands for all axes.
std::string name_of(const toml::table& element, std::string_view list, std::size_t index, std::size_t count) {
  if (const auto name = element["name"].value<std::string>()) return *name;
  if (list == "corner" && index < 26) return std::string(1, static_cast<char>('A' + index));
  if (list == "axis" && count > 1 && index < task_keys::axis_names.size())
    return std::string(task_keys::axis_names[index]);
  return fmt::format("{}", index);
}

}  // namespace

TaskKey::TaskKey(const std::string& dotted) : dotted_(dotted) {
  if (dotted.empty())
    throw std::invalid_argument("a task key is empty; write for example `corner.*.error_max_um` or `filter.order`");
  std::size_t from = 0;
  for (std::size_t dot; (dot = dotted.find('.', from)) != std::string::npos; from = dot + 1)
    parts_.push_back(dotted.substr(from, dot - from));
  parts_.push_back(dotted.substr(from));
  const std::string table = parts_.size() == 1 ? "" : parts_.front();
  const std::vector<Key>* known = keys_of(table);
  if (!known)
    throw std::invalid_argument(
        fmt::format("unknown task key `{}`: a task has no `{}`; {}", dotted, table, suggest(table, table_names())));
  if (const auto* inner = table.empty() ? keys_of(dotted) : nullptr)
    throw std::invalid_argument(fmt::format("`{}` is a table of a task, not a value; write `{}`", dotted,
                                            place_of(dotted, settable_names(*inner).front())));
  const std::size_t wanted = table.empty() ? 1 : is_list(table) ? 3 : 2;
  if (parts_.size() != wanted) {
    throw std::invalid_argument(
        fmt::format("task key `{}` has {} parts; allowed is {}", dotted, parts_.size(),
                    is_list(table) ? fmt::format("{0}.NAME.KEY or {0}.*.KEY", table) : fmt::format("{}.KEY", table)));
  }
  const Key* found = find_key(*known, key());
  if (!found || !settable(*found)) {
    const std::string home = other_place(key());
    throw std::invalid_argument(
        fmt::format("unknown task key `{}`; {}", dotted,
                    home.empty() ? suggest(key(), settable_names(*known)) : fmt::format("did you mean `{}`?", home)));
  }
  whole_ = found->type == KeyType::integer;
}

void TaskKey::set(toml::table& task, double value) const {
  if (whole_ && std::trunc(value) == value && std::abs(value) < 1e15) {
    set(task, toml::value<std::int64_t>(static_cast<std::int64_t>(value)));
  } else {
    set(task, toml::value<double>(value));
  }
}

void TaskKey::set(toml::table& task, const toml::node& value) const {
  if (parts_.size() == 1) {
    task.insert_or_assign(key(), value);
    return;
  }
  const std::string& table = parts_.front();
  if (!is_list(table)) {
    if (!task.contains(table)) task.insert(table, toml::table{});
    toml::table* inner = task[table].as_table();
    if (!inner)
      throw std::invalid_argument(fmt::format("`{}` cannot be set: `{}` is no table in the task", dotted_, table));
    inner->insert_or_assign(key(), value);
    return;
  }
  if (!task.contains(table)) task.insert(table, toml::array{});
  toml::array* list = task[table].as_array();
  if (!list)
    throw std::invalid_argument(
        fmt::format("`{}` cannot be set: `{}` is no list of tables in the task", dotted_, table));
  const std::string& which = parts_[1];
  const std::size_t count = list->size();
  const bool add = (table == "axis" && count == 0 && (which == "*" || which == "0")) ||
                   (table == "mode" && as_index(which) == count);
  if (add) list->push_back(toml::table{});
  bool found = false;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < list->size(); ++i) {
    toml::table* element = list->get(i)->as_table();
    if (!element) continue;
    names.push_back(name_of(*element, table, i, list->size()));
    if (which != "*" && which != names.back() && as_index(which) != i) continue;
    element->insert_or_assign(key(), value);
    found = true;
  }
  if (!found) {
    throw std::invalid_argument(names.empty() ? fmt::format("`{}`: the task has no [[{}]]", dotted_, table)
                                              : fmt::format("`{}`: the task has no {} `{}`; it has {}, or * for all",
                                                            dotted_, table, which, fmt::join(names, ", ")));
  }
}

namespace {

/// A copy of the value at a pointer, in a list of one; empty if there is none.
toml::array value_at(const toml::table& task, const std::string& pointer) {
  const toml::node* node = &task;
  for (std::size_t from = 1; node && from <= pointer.size();) {
    const std::size_t to = std::min(pointer.find('/', from), pointer.size());
    const std::string part = pointer.substr(from, to - from);
    if (const toml::table* table = node->as_table()) {
      node = table->get(part);
    } else if (const toml::array* list = node->as_array()) {
      const auto index = as_index(part);
      node = index && *index < list->size() ? list->get(*index) : nullptr;
    } else {
      node = nullptr;
    }
    from = to + 1;
  }
  toml::array value;
  if (node) value.push_back(*node);
  return value;
}

}  // namespace

std::string task_key_pattern() {
  std::string text = fmt::format("\"^({}", fmt::join(settable_names(task_file().keys), "|"));
  for (const std::string_view table : table_names())
    text += fmt::format("|{}\\\\.{}({})", table, is_list(table) ? "[^.]+\\\\." : "",
                        fmt::join(settable_names(*keys_of(table)), "|"));
  return text + ")$\"";
}

std::optional<std::size_t> setter_of(const toml::table& task, const std::vector<std::vector<TaskKey>>& lists,
                                     const std::string& pointer) {
  if (pointer.empty()) return std::nullopt;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    toml::table one = task, other = task;
    for (const TaskKey& key : lists[i]) key.set(one, 1.0), key.set(other, 2.0);
    if (value_at(one, pointer) != value_at(other, pointer)) return i;
  }
  return std::nullopt;
}

}  // namespace accdec
