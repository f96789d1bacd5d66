#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/json_position.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_tree.hpp>

namespace accdec {
namespace {

// The ordered kind: members stand in the order of the file, so what is written again looks the same.
using Json = nlohmann::ordered_json;

/// What is wrong and where, before the file's text is searched for the position.
struct Mistake {
  std::string pointer, message;
};

/// A member or element with its path.
class Value {
 public:
  Value(const Json& json, std::string pointer) : json_(json), pointer_(std::move(pointer)) {}

  [[noreturn]] void fail(const std::string& message) const { throw Mistake{pointer_, message}; }
  [[noreturn]] void wrong_type(std::string_view wanted) const {
    fail(fmt::format("must be {}, got {}", wanted, json_.type_name()));
  }

  /// Checks the members of an object. Those after `required` may be missing.
  void members(std::initializer_list<std::string_view> required,
               std::initializer_list<std::string_view> optional = {}) const {
    if (!json_.is_object()) wrong_type("an object");
    std::vector<std::string_view> known(required);
    known.insert(known.end(), optional);
    for (const auto& [key, value] : json_.items()) {
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        throw Mistake{pointer_ + "/" + key, fmt::format("unknown member; {}", suggest(key, known))};
      }
    }
    for (const std::string_view key : required) {
      if (!json_.contains(key)) fail(fmt::format("lacks the member `{}`", key));
    }
  }
  bool has(std::string_view key) const { return json_.contains(key) && !json_.at(std::string(key)).is_null(); }
  Value operator[](std::string_view key) const {
    return {json_.at(std::string(key)), fmt::format("{}/{}", pointer_, key)};
  }
  std::vector<Value> elements() const {
    if (!json_.is_array()) wrong_type("an array");
    std::vector<Value> values;
    for (std::size_t i = 0; i < json_.size(); ++i) values.emplace_back(json_[i], fmt::format("{}/{}", pointer_, i));
    return values;
  }
  std::string text() const {
    if (!json_.is_string()) wrong_type("a string");
    return json_.get<std::string>();
  }
  bool boolean() const {
    if (!json_.is_boolean()) wrong_type("true or false");
    return json_.get<bool>();
  }
  double number() const {
    if (!json_.is_number()) wrong_type("a number");
    return json_.get<double>();
  }
  /// null stands for infinity.
  double number_or_infinity() const { return json_.is_null() ? unlimited : number(); }
  std::optional<double> optional_number() const { return json_.is_null() ? std::nullopt : std::optional(number()); }
  long integer(long low, long high) const {
    if (!json_.is_number_integer()) wrong_type("a whole number");
    const double x = json_.get<double>();  // no wrap-around for numbers beyond 64 bits
    if (x < static_cast<double>(low) || x > static_cast<double>(high))
      fail(fmt::format("{} is out of range; allowed is {} .. {}", x, low, high));
    return json_.get<long>();
  }
  /// The enumerator whose `to_string` is the text.
  template <class Enum>
  Enum word(std::initializer_list<Enum> all) const {
    return word(std::span<const Enum>(all.begin(), all.size()));
  }
  template <class Enum>
  Enum word(std::span<const Enum> all) const {
    const std::string given = text();
    std::string known;
    for (const Enum e : all) {
      if (to_string(e) == given) return e;
      known += (known.empty() ? "" : ", ") + std::string(to_string(e));
    }
    fail(fmt::format("\"{}\" is unknown; allowed are {}", given, known));
  }
  const Json& json() const { return json_; }
  const std::string& pointer() const { return pointer_; }

 private:
  const Json& json_;
  std::string pointer_;
};

/// TOML tree of a JSON value, for the one reader of tasks there is. Depth is bounded: a task has three levels.
toml::array to_toml_array(const Value& value, int depth);

toml::table to_toml_table(const Value& value, int depth = 0) {
  toml::table table;
  for (const auto& [key, member] : value.json().items()) {
    const Value v = value[key];
    if (depth > 4) v.fail("is nested too deeply for a task");
    if (member.is_object())
      table.insert(key, to_toml_table(v, depth + 1));
    else if (member.is_array())
      table.insert(key, to_toml_array(v, depth + 1));
    else if (member.is_string())
      table.insert(key, member.get<std::string>());
    else if (member.is_boolean())
      table.insert(key, member.get<bool>());
    else if (member.is_number_integer() && std::abs(member.get<double>()) < 9e18)
      table.insert(key, member.get<std::int64_t>());
    else if (member.is_number())
      table.insert(key, member.get<double>());
    else
      v.fail("must not be null; leave the key out");
  }
  return table;
}

toml::array to_toml_array(const Value& value, int depth) {
  toml::array array;
  for (const Value& v : value.elements()) {
    if (v.json().is_object())
      array.push_back(to_toml_table(v, depth + 1));
    else if (v.json().is_number())
      array.push_back(v.number());
    else if (v.json().is_string())
      array.push_back(v.text());
    else
      v.fail("must be a number, a string or an object");
  }
  return array;
}

CornerResult read_corner(const Value& value) {
  value.members({"name", "delay_samples", "corner_error_m", "polyline_error_m", "contour_deviation_m", "speed_min_m_s",
                 "corner_time_s"});
  CornerResult corner;
  corner.name = value["name"].text();
  corner.delay = static_cast<int>(value["delay_samples"].integer(0, task_keys::delay_limit));
  corner.corner_error = value["corner_error_m"].number();
  corner.polyline_error = value["polyline_error_m"].number();
  corner.contour_deviation = value["contour_deviation_m"].number();
  corner.speed_min = value["speed_min_m_s"].number();
  corner.corner_time = value["corner_time_s"].number();
  return corner;
}

LimitUse read_limit(const Value& value) {
  value.members({"kind", "axis", "corner", "event", "value", "bound", "utilisation", "sample"}, {"frequency_Hz"});
  LimitUse use;
  std::array<LimitKind, limit_names.size()> kinds{};
  std::transform(limit_names.begin(), limit_names.end(), kinds.begin(), [](const LimitName& l) { return l.kind; });
  use.kind = value["kind"].word(std::span<const LimitKind>(kinds));
  use.axis = value["axis"].text();
  use.corner = value["corner"].text();
  use.event = value["event"].word({Event::start, Event::blend, Event::stop, Event::none});
  use.value = value["value"].number_or_infinity();
  use.bound = value["bound"].number();
  use.utilisation = value["utilisation"].number_or_infinity();
  use.sample = static_cast<int>(value["sample"].integer(-10 * task_keys::order_limit, 10 * task_keys::order_limit));
  if (value.has("frequency_Hz")) use.frequency = value["frequency_Hz"].number();
  return use;
}

Filter read_filter(const Value& value) {
  value.members({"order", "taps"});
  const long order = value["order"].integer(0, task_keys::order_limit);
  std::vector<double> taps;
  for (const Value& tap : value["taps"].elements()) taps.push_back(tap.number());
  if (static_cast<long>(taps.size()) != order + 1) {
    value["taps"].fail(fmt::format("has {} taps; order {} needs {}", taps.size(), order, order + 1));
  }
  try {
    return Filter(std::move(taps));
  } catch (const std::invalid_argument& error) {
    value["taps"].fail(error.what());
  }
}

DesignResult read_members(const Value& top, const std::string& name) {
  if (!top.json().is_object()) top.wrong_type("an object");
  if (top.has("schema") && top["schema"].text() != "accdec.result/1") {
    top["schema"].fail(
        fmt::format("\"{}\" is another kind of file; allowed is \"accdec.result/1\"", top["schema"].text()));
  }
  top.members({"schema", "task", "status", "sample_period_s", "filter", "corners", "cycle_time_s", "corner_time_s",
               "limits", "verification", "solver", "message"},
              {"lower_bound_s", "gap", "certificate"});
  DesignResult result;
  if (!top["task"].json().is_object()) top["task"].wrong_type("an object");
  result.task = task_from_tree(to_toml_table(top["task"]), name, "/task", {});
  result.status = top["status"].word({Status::optimal, Status::feasible, Status::infeasible, Status::failed});
  if (top["sample_period_s"].number() != result.task.sample_period) {
    top["sample_period_s"].fail(
        fmt::format("differs from the task's {} s; they must agree", result.task.sample_period));
  }
  if (top.has("filter")) result.filter = read_filter(top["filter"]);
  for (const Value& corner : top["corners"].elements()) result.corners.push_back(read_corner(corner));
  if (result.filter && result.corners.size() != result.task.corners.size()) {
    top["corners"].fail(fmt::format("has {} entries for the task's {} corners; one each is needed",
                                    result.corners.size(), result.task.corners.size()));
  }
  for (std::size_t j = 0; j < result.corners.size() && j < result.task.corners.size(); ++j) {
    if (result.corners[j].name != result.task.corners[j].name) {
      top["corners"].elements()[j].fail(
          fmt::format("is named \"{}\", the task's corner \"{}\"; they must stand in the same order",
                      result.corners[j].name, result.task.corners[j].name));
    }
  }
  result.cycle_time = top["cycle_time_s"].number();
  result.corner_time = top["corner_time_s"].number();
  if (top.has("lower_bound_s")) result.lower_bound = top["lower_bound_s"].number();
  if (top.has("gap")) result.gap = top["gap"].number();
  for (const Value& limit : top["limits"].elements()) result.limits.push_back(read_limit(limit));

  const Value v = top["verification"];
  v.members({"performed", "feasible", "max_violation", "tolerance", "worst"}, {"certificate_checked", "certificate"});
  result.verification = {v["performed"].boolean(),
                         v["feasible"].boolean(),
                         v["max_violation"].number_or_infinity(),
                         v["tolerance"].number(),
                         v["worst"].text(),
                         v.has("certificate_checked") && v["certificate_checked"].boolean(),
                         v.has("certificate") ? v["certificate"].text() : ""};
  const Value s = top["solver"];
  s.members({"method", "name", "version", "claimed", "evaluations", "wall_time_s"});
  result.solver = {s["method"].text(),
                   s["name"].text(),
                   s["version"].text(),
                   s["claimed"].text(),
                   s["evaluations"].integer(0, std::numeric_limits<long>::max() / 4),
                   s["wall_time_s"].number(),
                   {}};
  result.message = top["message"].text();
  if (top.has("certificate")) result.certificate = top["certificate"].json().dump();
  return result;
}

/// "/corners/0/name" as "corners[0].name".
std::string readable(const std::string& pointer) {
  std::string text;
  for (std::size_t at = 1; at <= pointer.size() && !pointer.empty();) {
    const std::size_t end = std::min(pointer.find('/', at), pointer.size());
    const std::string step = pointer.substr(at, end - at);
    const bool index =
        !step.empty() && std::all_of(step.begin(), step.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (index)
      text += "[" + step + "]";
    else
      text += (text.empty() ? "" : ".") + step;
    at = end + 1;
  }
  return text.empty() ? "the result" : text;
}

/// Where brackets nest deeper than any result's; the JSON library recurses when it writes, and would overflow the
/// stack.
std::optional<std::size_t> too_deep(std::string_view text) {
  constexpr int deepest = 64;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::nullopt;
}

}  // namespace

DesignResult parse_result(std::string_view text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw InputError(name, 1, 1, "the file is empty; a result is JSON with schema \"accdec.result/1\"");
  const auto positioned = [&](const std::string& pointer, const std::string& message) {
    const auto [line, column] = line_and_column(text, locate(text, pointer));
    return InputError(name, line, column, fmt::format("{}: {}", readable(pointer), message), pointer);
  };
  Json json;
  try {
    json = Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    const auto [line, column] = line_and_column(text, error.byte > 0 ? error.byte - 1 : 0);
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ..." without its own head.
    std::string message = error.what();
    if (const auto head = message.find(": "); head != std::string::npos) message.erase(0, head + 2);
    throw InputError(name, line, column, "not valid JSON: " + message);
  } catch (const Json::out_of_range& error) {
    throw InputError(name, 1, 1,
                     fmt::format("a number is beyond double precision ({}); all must be finite", error.what()));
  }
  if (const auto at = too_deep(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column, "brackets nest more than 64 deep; no result does");
  }
  try {
    return read_members(Value(json, ""), name);
  } catch (const Mistake& mistake) {
    throw positioned(mistake.pointer, mistake.message);
  } catch (const InputError& error) {
    throw positioned(error.pointer(), error.message());
  }
}

DesignResult read_result(const std::string& path) {
  return parse_result(read_text_file(path, result_file_limit), path);
}

}  // namespace accdec
