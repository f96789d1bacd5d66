#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/formats/task_keys.hpp>

namespace accdec {
namespace {

using Keys = std::vector<std::string_view>;

/// Keys of every table of a task; "" is the top.
const std::map<std::string_view, Keys>& tables() {
  static const std::map<std::string_view, Keys> all = [] {
    std::map<std::string_view, Keys> t{
        {"", {"sample_period_ms"}},
        {"filter", filter_keys()},
        {"baseline", filter_keys()},
        {"design", {"order_min", "order_max", "symmetric", "objective", "runs"}},
        {"program", {"error_max_um"}},
        {"corner",
         {"angle_deg", "heading_deg", "turn", "direction_in", "direction_out", "feed_in_mm_min", "feed_out_mm_min",
          "error_max_um", "speed_min_mm_s", "delay_samples", "weight"}},
        {"mode", {"frequency_Hz", "residual_max"}},
        {"axis", {}}};
    for (const auto& field : task_keys::axis_keys) t["axis"].push_back(field.key);
    return t;
  }();
  return all;
}

bool is_list(std::string_view table) {
  return table == "axis" || table == "corner" || table == "mode";
}

bool takes_whole_numbers(std::string_view key) {
  constexpr std::string_view whole[] = {"order", "ramp", "shaper_delay", "order_min", "order_max", "delay_samples"};
  return std::find(std::begin(whole), std::end(whole), key) != std::end(whole);
}

std::optional<std::size_t> as_index(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Names as the task reader gives them: corners A, B, ...; of several axes x, y, z, ...; a lone axis table stands for
/// all.
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
  const auto known = tables().find(table);
  if (known == tables().end() || (parts_.size() == 1 && tables().contains(parts_.front()))) {
    const Keys names{"filter", "design", "program", "axis", "corner", "mode"};
    throw std::invalid_argument(
        known == tables().end()
            ? fmt::format("unknown task key `{}`: a task has no `{}`; {}", dotted, table, suggest(table, names))
            : fmt::format("`{}` is a table of a task, not a value; write `{}.{}{}`", dotted, dotted,
                          is_list(dotted) ? "*." : "", tables().at(parts_.front()).front()));
  }
  const std::size_t wanted = table.empty() ? 1 : is_list(table) ? 3 : 2;
  if (parts_.size() != wanted) {
    throw std::invalid_argument(
        fmt::format("task key `{}` has {} parts; allowed is {}", dotted, parts_.size(),
                    is_list(table) ? fmt::format("{0}.NAME.KEY or {0}.*.KEY", table) : fmt::format("{}.KEY", table)));
  }
  if (std::find(known->second.begin(), known->second.end(), parts_.back()) == known->second.end()) {
    Keys candidates = known->second;
    std::string home;
    for (const auto& [name, keys] : tables()) {
      if (std::find(keys.begin(), keys.end(), parts_.back()) == keys.end()) continue;
      home = name.empty() ? parts_.back() : fmt::format("{}.{}{}", name, is_list(name) ? "*." : "", parts_.back());
      break;
    }
    throw std::invalid_argument(
        fmt::format("unknown task key `{}`; {}", dotted,
                    home.empty() ? suggest(parts_.back(), candidates) : fmt::format("did you mean `{}`?", home)));
  }
}

void TaskKey::set(toml::table& task, double value) const {
  if (takes_whole_numbers(key()) && std::trunc(value) == value && std::abs(value) < 1e15) {
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

/// A copy of what stands at a pointer, in a list of one; empty if nothing does.
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
