#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/check_keys.hpp>
#include <accdec/files/file_kind.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/formats/json_text.hpp>
#include <accdec/formats/json_value.hpp>
#include <accdec/formats/result_keys.hpp>
#include <accdec/formats/settings_json.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/result.hpp>
#include <accdec/task/not_considered.hpp>

namespace accdec {
namespace {

// The ordered kind: members keep the order of the file, so text that is written again looks the same.
using Json = nlohmann::ordered_json;

/// An error and its place, before its position in the text is known.
InputError mistake(const std::string& pointer, const std::string& message) {
  return InputError("", 0, 0, message, pointer);
}

/// A JSON value as KeyCheck sees it.
class JsonNode {
 public:
  explicit JsonNode(const Json& json) : json_(json) {}

  bool is_null() const { return json_.is_null(); }
  bool is_table() const { return json_.is_object(); }
  bool is_list() const { return json_.is_array(); }
  bool is_text() const { return json_.is_string(); }
  bool is_boolean() const { return json_.is_boolean(); }
  bool is_number() const { return json_.is_number(); }
  bool is_integer() const { return json_.is_number_integer(); }
  double number() const { return json_.get<double>(); }
  const std::string& text() const { return json_.get_ref<const std::string&>(); }
  std::size_t size() const { return json_.size(); }
  JsonNode element(std::size_t i) const { return JsonNode(json_[i]); }
  std::optional<JsonNode> find(std::string_view key) const {
    const auto found = json_.find(key);
    return found == json_.end() ? std::nullopt : std::optional(JsonNode(*found));
  }
  template <class Do>
  void for_each_member(Do member) const {
    for (const auto& [name, value] : json_.items()) member(name, JsonNode(value));
  }
  std::string_view type_name() const { return json_.type_name(); }

  InputError fault(const std::string& pointer, const std::string& message) const { return mistake(pointer, message); }
  InputError fault_of_name(const std::string& pointer, const std::string& message) const {
    return mistake(pointer, message);
  }

  // The words of the format; the path comes before them.
  static constexpr bool is_toml = false;
  static std::string subject(std::string_view, std::size_t = 0) { return ""; }
  static std::string equals(const std::string&) { return ""; }
  static std::string unknown(std::string_view, const std::string&, const std::string& hint) {
    return "unknown member; " + hint;
  }
  static std::string missing(const std::string&, const Key& key) {
    return fmt::format("lacks the member `{}`", key.name);
  }
  static std::string no_table(std::string_view, const JsonNode& got) {
    return fmt::format("must be an object, got {}", got.type_name());
  }
  static std::string no_list(std::string_view, const JsonNode& got) {
    return fmt::format("must be an array, got {}", got.type_name());
  }
  static std::string no_element(std::string_view key, std::size_t, const JsonNode& got) { return no_table(key, got); }

 private:
  const Json& json_;
};

/// TOML tree of a JSON value, for the single reader of tasks. Depth is bounded: a task has three levels.
toml::array to_toml_array(const Json& json, const std::string& at, int depth);

toml::table to_toml_table(const Json& json, const std::string& at, int depth = 0) {
  if (depth > 4) throw mistake(at, "is nested too deeply for a task");
  toml::table table;
  for (const auto& [key, member] : json.items()) {
    const std::string place = at + "/" + key;
    if (member.is_object())
      table.insert(key, to_toml_table(member, place, depth + 1));
    else if (member.is_array())
      table.insert(key, to_toml_array(member, place, depth + 1));
    else if (member.is_string())
      table.insert(key, member.get<std::string>());
    else if (member.is_boolean())
      table.insert(key, member.get<bool>());
    else if (member.is_number_integer() && std::abs(member.get<double>()) < 9e18)
      table.insert(key, member.get<std::int64_t>());
    else if (member.is_number())
      table.insert(key, member.get<double>());
    else
      throw mistake(place, "must not be null; leave the key out");
  }
  return table;
}

toml::array to_toml_array(const Json& json, const std::string& at, int depth) {
  toml::array array;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const std::string place = fmt::format("{}/{}", at, i);
    if (json[i].is_object())
      array.push_back(to_toml_table(json[i], place, depth + 1));
    else if (json[i].is_number())
      array.push_back(json[i].get<double>());
    else if (json[i].is_string())
      array.push_back(json[i].get<std::string>());
    else if (json[i].is_array() && depth < 4)  // pairs of numbers
      array.push_back(to_toml_array(json[i], place, depth + 1));
    else
      throw mistake(place, "must be a number, a string or an object");
  }
  return array;
}

/// The enumerator of a checked name.
template <class Enum, std::size_t N>
Enum named(const Json& name, const std::array<Enum, N>& all) {
  return *std::find_if(all.begin(), all.end(),
                       [&](Enum e) { return to_string(e) == name.get_ref<const std::string&>(); });
}

std::optional<double> optional_number(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? std::nullopt : std::optional(found->get<double>());
}
/// null stands for infinity.
double number_or_infinity(const Json& json) {
  return json.is_null() ? unlimited : json.get<double>();
}

CornerResult read_corner(const Json& json) {
  return {json["name"],
          json["delay_samples"],
          json["corner_error_m"],
          json["polyline_error_m"],
          json["contour_deviation_m"],
          json["speed_min_m_s"],
          json["corner_time_s"],
          optional_number(json, "settling_time_s").value_or(0.0),
          optional_number(json, "feed_part").value_or(1.0)};
}

LimitUse read_limit(const Json& json) {
  std::array<LimitKind, limit_names.size()> kinds{};
  std::transform(limit_names.begin(), limit_names.end(), kinds.begin(), [](const LimitName& l) { return l.kind; });
  LimitUse use;
  use.kind = named(json["kind"], kinds);
  use.axis = json["axis"].get<std::string>();
  use.corner = json["corner"].get<std::string>();
  use.event = named(json["event"], std::array{Event::start, Event::blend, Event::stop, Event::none});
  const double in_si = si_over_inside(use.kind, use.axis);
  use.value = number_or_infinity(json["value"]) / in_si;
  use.bound = json["bound"].get<double>() / in_si;
  use.utilisation = number_or_infinity(json["utilisation"]);
  use.sample = json["sample"];
  if (const auto frequency = optional_number(json, "frequency_Hz")) use.frequency = *frequency;
  use.damping = optional_number(json, "damping_ratio").value_or(0.0);
  return use;
}

/// Rounding of a plain sum of up to 10^6 rounded taps.
constexpr double taps_rounding = 1e-9;

Filter filter_from(const Json& json) {
  const long order = json["order"];
  std::vector<double> taps = json["taps"];
  if (static_cast<long>(taps.size()) != order + 1) {
    throw mistake("/filter/taps", fmt::format("has {} taps; order {} needs {}", taps.size(), order, order + 1));
  }
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  try {
    Filter filter(std::move(taps));
    // A filter scales any taps to sum 1. But the recorded taps must be the checked ones.
    if (!(std::abs(sum - 1.0) <= taps_rounding))
      throw std::invalid_argument(fmt::format("have the sum {:.15g}; it must be 1", sum));
    return filter;
  } catch (const std::invalid_argument& error) {
    throw mistake("/filter/taps", error.what());
  }
}

void read_corners(const Json& json, DesignResult& result) {
  for (const Json& corner : json) result.corners.push_back(read_corner(corner));
  const auto& asked = result.task.corners;
  if (result.filter && result.corners.size() != asked.size()) {
    throw mistake("/corners", fmt::format("has {} entries for the task's {} corners; one each is needed",
                                          result.corners.size(), asked.size()));
  }
  for (std::size_t j = 0; j < result.corners.size() && j < asked.size(); ++j) {
    if (result.corners[j].name == asked[j].name) continue;
    throw mistake(fmt::format("/corners/{}", j),
                  fmt::format("is named \"{}\", the task's corner \"{}\"; they must stand in the same order",
                              result.corners[j].name, asked[j].name));
  }
}

Certificate certificate_of(const Json& json) try {
  return read_certificate(Value(json, "/certificate"));
} catch (const Mistake& error) {
  throw mistake(error.pointer, error.message);
}

void check_members(const Json& json) {
  if (!json.is_object()) throw mistake("", fmt::format("must be an object, got {}", json.type_name()));
  const std::vector<Key>& keys = result_file().keys;
  const std::string& schema = keys.front().words.front();
  if (const auto given = json.find("schema"); given != json.end() && given->is_string()) {
    const auto& kind = given->get_ref<const std::string&>();
    if (kind != schema)
      throw mistake("/schema", fmt::format("\"{}\" is another kind of file; allowed is \"{}\"", kind, schema));
  }
  Faults faults;
  KeyCheck<JsonNode>(keys, faults).table(JsonNode(json), keys, "the result", "");
  faults.raise();
}

/// The list follows from the task; a result that hides what it leaves out is none of ours.
void check_not_considered(const Json& json, const Task& task) {
  const auto given = json.find("not_considered");
  if (given == json.end()) return;  // older results have none
  Json found = Json::array();
  for (const NotConsidered what : not_considered(task.machine)) found.push_back(to_string(what));
  if (*given != found) throw mistake("/not_considered", fmt::format("must be {} for this task", found.dump()));
}

DesignResult read_members(const Json& json, const std::string& name) {
  check_members(json);
  DesignResult result;
  // Tasks of results are written out: a file that one names was put there by somebody else.
  result.task = task_from_tree(to_toml_table(json["task"], "/task"), name, "/task",
                               {.response = Considered::all, .controller_files = false});
  check_not_considered(json, result.task);
  result.status =
      named(json["status"], std::array{Status::optimal, Status::feasible, Status::infeasible, Status::failed});
  if (json["sample_period_s"] != result.task.sample_period) {
    throw mistake("/sample_period_s",
                  fmt::format("differs from the task's {} s; they must agree", result.task.sample_period));
  }
  if (!json["filter"].is_null()) result.filter = filter_from(json["filter"]);
  read_corners(json["corners"], result);
  result.cycle_time = json["cycle_time_s"];
  result.corner_time = json["corner_time_s"];
  result.lower_bound = optional_number(json, "lower_bound_s");
  result.gap = optional_number(json, "gap");
  if (const auto found = json.find("settings"); found != json.end()) {
    result.settings = settings_from_json(*found, to_toml_table((*found)["filter"], "/settings/filter"), name);
  }
  result.family_bound = optional_number(json, "family_bound_s");
  result.free_taps = optional_number(json, "free_taps_s");
  for (const Json& limit : json["limits"]) result.limits.push_back(read_limit(limit));
  const Json &v = json["verification"], &s = json["solver"];
  const auto given = [&](const char* key) { return v.contains(key) && !v[key].is_null(); };
  result.verification = {v["performed"],
                         v["feasible"],
                         number_or_infinity(v["max_violation"]),
                         v["tolerance"],
                         v["worst"],
                         given("certificate_checked") && v["certificate_checked"].get<bool>(),
                         given("certificate") ? v["certificate"].get<std::string>() : ""};
  result.solver = {s["method"], s["name"], s["version"], s["claimed"], s["evaluations"], s["wall_time_s"], {}};
  if (!(result.solver.wall_time >= 0.0)) throw mistake("/solver/wall_time_s", "must not be negative");
  if (const auto found = json.find("quantisation"); found != json.end())
    result.quantisation = {(*found)["bits"], (*found)["coefficients"], (*found)["unquantised_s"]};
  if (const auto found = json.find("savings"); found != json.end()) {
    const Json& saved = *found;
    result.savings = {saved["today_s"],
                      saved["total_s"],
                      optional_number(saved, "by_retuning_s"),
                      optional_number(saved, "by_family_s"),
                      optional_number(saved, "by_free_taps_s"),
                      saved["family"],
                      saved["complete"]};
  }
  check_answer(json, result);
  result.message = json["message"].get<std::string>();
  if (const auto proof = json.find("certificate"); proof != json.end() && !proof->is_null())
    result.certificate = std::make_shared<Certificate>(certificate_of(*proof));
  if (const auto stop = json.find("stop"); stop != json.end() && !stop->is_null())
    result.stop = named(*stop, std::to_array(stop_reasons));
  return result;
}

/// The same errors with their places in the file. Only a few are shown, so finding the places is quick.
InputErrors positioned(const std::vector<InputError>& errors, bool at_least, std::string_view text,
                       const std::string& name) {
  constexpr std::size_t most = 10;
  std::vector<InputError> all;
  for (const InputError& error : errors) {
    if (all.size() == most) break;
    all.push_back(at_its_place(error, text, name));
  }
  sort_by_position(all);
  const std::size_t left_out = errors.size() - all.size();
  return InputErrors(std::move(all), left_out, at_least);
}

}  // namespace

DesignResult parse_result(std::string_view text, const std::string& name) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw InputError(name, 1, 1, "the file is empty; a result is JSON with schema \"accdec.result/1\"");
  if (const std::string wrong = wrong_kind(text, InputKind::result); !wrong.empty())
    throw InputError(name, 1, 1, wrong);
  const Json json = parse_json_text(text, name);
  try {
    return read_members(json, name);
  } catch (const InputErrors& errors) {
    throw positioned(errors.all(), errors.at_least(), text, name);
  } catch (const InputError& error) {
    throw positioned({error}, false, text, name);
  }
}

DesignResult read_result(const std::string& path) {
  return parse_result(read_text_file(path, result_file_limit), path);
}

}  // namespace accdec
