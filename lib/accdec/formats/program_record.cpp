#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/errors.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/formats/program_record.hpp>
#include <accdec/formats/task_reader.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view joint_letters = "csl.";  // corner, smooth, straight, stop: in the order of Joint

template <class Value>
Json list(const std::vector<Value>& values) {
  Json json = Json::array();
  for (const Value& value : values) json.push_back(value);
  return json;
}

Json taps_json(const Filter& filter) {
  return std::vector<double>(filter.taps().begin(), filter.taps().end());
}

Json commands_json(const ProgramResult& result) {
  const Toolpath& path = result.path;
  Json json;
  json["axes"] = list(path.axes);
  json["points_m"] = path.points;
  if (!path.programmed.empty()) json["programmed_m"] = path.programmed;
  json["duration_s"] = path.duration;
  // null is no tolerance.
  json["tolerance_m"] = Json::array();
  std::string joints, rapid, arcs;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    json["tolerance_m"].push_back(path.tolerance[b] < unlimited ? Json(path.tolerance[b]) : Json(nullptr));
    joints += joint_letters[static_cast<std::size_t>(path.joint[b])];
    rapid += path.rapid[b] ? '1' : '0';
    arcs += path.inside_arc[b] ? '1' : '0';
  }
  json["joint"] = joints;
  json["rapid"] = rapid;
  json["inside_arc"] = arcs;
  json["line"] = list(path.line);
  json["delay_samples"] = list(result.plan.delays);
  json["error_m"] = Json::array();
  for (const double error : result.plan.errors)
    json["error_m"].push_back(std::isfinite(error) ? Json(error) : Json(nullptr));
  json["dwell"] = Json::array();
  for (const auto& [block, time] : path.dwell) json["dwell"].push_back({block, time});
  json["dwell_first_s"] = path.dwell_first;
  if (!result.legs.single()) {
    json["filters"] = Json::array();
    for (const Filter& filter : result.legs.filters()) json["filters"].push_back(taps_json(filter));
    json["filter_of_block"] = Json::array();
    for (std::size_t b = 0; b < path.blocks(); ++b) json["filter_of_block"].push_back(result.legs.index(b));
  }
  return json;
}

Json inputs_json(const ProgramInputs& inputs) {
  const ToolpathOptions& r = inputs.reading;
  Json json{{"program", inputs.program},
            {"program_hash", inputs.program_hash},
            {"task", inputs.task_path},
            {"task_text", inputs.task_text},
            {"arc_tolerance_m", r.read.arc_tolerance},
            {"clamp_feeds", r.clamp_feeds},
            {"compensate_arcs", r.widen_arcs},
            {"rapid_stops", r.rapid_stops},
            {"dwells_before_filter", r.dwells_before_filter},
            {"interpreted", inputs.interpreted}};
  if (!inputs.tool_table.empty()) json["tool_table"] = inputs.tool_table;
  return json;
}

/// A whole number within its type: the library would cut fractions off and wrap what is too large.
template <class Integer>
Integer integer(const Json& json) {
  const bool whole = json.is_number_integer() &&
                     (!json.is_number_unsigned() || std::in_range<std::int64_t>(json.get<std::uint64_t>()));
  if (!whole || !std::in_range<Integer>(json.get<std::int64_t>()))
    throw std::invalid_argument("a count, a line or a delay is no whole number in its range: " + json.dump());
  return static_cast<Integer>(json.get<std::int64_t>());
}
template <class Integer>
std::vector<Integer> integers(const Json& json) {
  std::vector<Integer> values;
  for (const Json& value : json) values.push_back(integer<Integer>(value));
  return values;
}

/// What is read back must be as it is written; the words say where it is not.
class Reader {
 public:
  Reader(std::string_view text, std::string name, bool (*right_kind)(std::string_view), const char* kind)
      : name_(std::move(name)) {
    json_ = Json::parse(text, nullptr, false);
    // The parser takes a zero byte for the end of the file.
    if (json_.is_discarded() || text.find('\0') != std::string_view::npos) fail("is not JSON");
    if (const auto at = duplicate_key(text)) {
      const auto [line, column] = line_and_column(text, *at);
      throw InputError(name_, line, column, "this key stands twice in its object; each may stand once");
    }
    if (!right_kind(text)) fail(fmt::format("is no result of accdec program (schema {})", kind));
  }

  /// Of plan profiles: what it was made from.
  ProgramRecord read_inputs_alone() {
    ProgramRecord record;
    try {
      record.result.program = json_.at("program").get<std::string>();
      record.result.status = json_.at("status") == "feasible" ? Status::feasible : Status::failed;
      read_inputs(json_.at("inputs"), record);
    } catch (const nlohmann::json::exception& error) {
      fail(fmt::format("is no whole result of accdec program: {}", error.what()));
    }
    return record;
  }

  ProgramRecord read() {
    ProgramRecord record;
    ProgramResult& r = record.result;
    try {
      r.program = json_.at("program").get<std::string>();
      r.feeds_chosen = json_.at("feeds") == "chosen";
      r.worst_shown = json_.at("worst_corners").size();
      record.filter_bound = json_.contains("filter_bound_s");
      r.sample_period = json_.at("sample_period_s").get<double>();
      r.filter = filter(json_.at("filter").at("taps"));
      r.legs = LegFilters(r.filter);
      r.plan.simulation.samples = integer<std::int64_t>(json_.at("samples"));
      r.cycle_time = json_.at("cycle_time_s").get<double>();
      r.delay_total = json_.at("delay_total_s").get<double>();
      r.corners = integer<std::size_t>(json_.at("corners").at("count"));
      r.worst_error = json_.at("corners").at("worst_error_m").get<double>();
      r.status = json_.at("status") == "feasible" ? Status::feasible : Status::failed;
      for (const Json& limit : json_.at("limits")) {
        r.plan.simulation.limits.push_back(limit_use(limit));
        r.plan.simulation.limit_lines.push_back(integer<std::uint32_t>(limit.at("line")));
      }
      if (json_.contains("inputs")) read_inputs(json_["inputs"], record);
      record.commands = json_.contains("commands") && json_["commands"].is_object() && json_.contains("inputs");
      if (record.commands) read_commands(json_["commands"], r);
    } catch (const nlohmann::json::exception& error) {
      fail(fmt::format("is no whole result of accdec program: {}", error.what()));
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
    if (record.commands && r.sample_period != record.task.sample_period)
      fail("sample_period_s is not that of the task in it");
    return record;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(name_, 0, 0, message); }

  static Filter filter(const Json& json) {
    auto taps = json.get<std::vector<double>>();
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
    if (!(std::abs(sum - 1.0) <= 1e-9))
      throw std::invalid_argument(fmt::format("filter taps have the sum {:.15g}; it must be 1", sum));
    return Filter(std::move(taps));
  }

  LimitUse limit_use(const Json& json) const {
    LimitUse use;
    const auto kind = json.at("kind").get<std::string>();
    const auto name =
        std::find_if(limit_names.begin(), limit_names.end(), [&](const LimitName& n) { return n.name == kind; });
    if (name == limit_names.end()) fail(fmt::format("unknown limit \"{}\"", kind));
    use.kind = name->kind;
    use.axis = json.at("axis").get<std::string>();
    use.value = json.at("value").get<double>();
    use.bound = json.at("bound").get<double>();
    use.utilisation = json.at("utilisation").get<double>();
    use.sample = integer<int>(json.at("sample"));
    if (use.kind == LimitKind::vibration)
      use.frequency = json.at("frequency_Hz").get<double>();
    else
      use.corner = fmt::format("line {}", integer<std::uint32_t>(json.at("line")));
    return use;
  }

  void read_inputs(const Json& json, ProgramRecord& record) const {
    ProgramInputs& in = record.inputs;
    in.program = json.at("program").get<std::string>();
    in.program_hash = json.at("program_hash").get<std::string>();
    in.task_path = json.at("task").get<std::string>();
    in.task_text = json.at("task_text").get<std::string>();
    in.reading.read.arc_tolerance = json.at("arc_tolerance_m").get<double>();
    in.reading.clamp_feeds = json.at("clamp_feeds").get<bool>();
    in.reading.widen_arcs = json.value("compensate_arcs", false);
    in.reading.rapid_stops = json.at("rapid_stops").get<bool>();
    in.reading.dwells_before_filter = json.at("dwells_before_filter").get<bool>();
    in.interpreted = json.at("interpreted").get<bool>();
    in.tool_table = json.value("tool_table", "");
    record.task = parse_task(in.task_text, in.task_path + " (in " + name_ + ")",
                             {.require_corners = false, .axes = static_cast<int>(program_axis_count)});
    in.reading.error_max = record.task.program_error_max;
  }

  static std::vector<double> numbers_or(const Json& json, double missing) {
    std::vector<double> values;
    for (const Json& value : json) values.push_back(value.is_null() ? missing : value.get<double>());
    return values;
  }

  std::vector<std::uint8_t> flags(const Json& json) const {
    std::vector<std::uint8_t> values;
    for (const char c : json.get<std::string>()) values.push_back(c == '1' ? 1 : 0);
    return values;
  }

  void read_commands(const Json& json, ProgramResult& result) const {
    Toolpath& path = result.path;
    path.axes = integers<std::size_t>(json.at("axes"));
    path.points = json.at("points_m").get<std::vector<double>>();
    if (json.contains("programmed_m")) path.programmed = json["programmed_m"].get<std::vector<double>>();
    path.duration = json.at("duration_s").get<std::vector<double>>();
    path.tolerance = numbers_or(json.at("tolerance_m"), unlimited);
    path.line = integers<std::uint32_t>(json.at("line"));
    path.rapid = flags(json.at("rapid"));
    path.inside_arc = flags(json.at("inside_arc"));
    for (const char letter : json.at("joint").get<std::string>()) {
      const auto at = joint_letters.find(letter);
      if (at == std::string_view::npos) fail("commands.joint has a letter that is none of c, s, l and .");
      path.joint.push_back(static_cast<Joint>(at));
    }
    for (const Json& dwell : json.at("dwell"))
      path.dwell.emplace_back(integer<std::uint32_t>(dwell.at(0)), dwell.at(1).get<double>());
    path.dwell_first = json.at("dwell_first_s").get<double>();
    result.plan.delays = integers<int>(json.at("delay_samples"));
    result.plan.errors = numbers_or(json.at("error_m"), unlimited);
    if (json.contains("filters")) read_filters(json, result);
    check(result);
  }

  void read_filters(const Json& json, ProgramResult& result) const {
    std::vector<Filter> filters;
    for (const Json& taps : json.at("filters")) filters.push_back(filter(taps));
    auto of_block = integers<std::uint16_t>(json.at("filter_of_block"));
    const bool known =
        std::all_of(of_block.begin(), of_block.end(), [&](std::uint16_t i) { return i < filters.size(); });
    if (filters.empty() || !known || of_block.size() != result.path.blocks())
      fail("commands.filter_of_block names filters that are not there");
    result.legs = LegFilters(std::move(filters), std::move(of_block));
  }

  void check(const ProgramResult& result) const {
    const Toolpath& path = result.path;
    const std::size_t blocks = path.blocks();
    const bool axes_known = !path.axes.empty() && std::is_sorted(path.axes.begin(), path.axes.end()) &&
                            path.axes.back() < program_axis_count &&
                            std::adjacent_find(path.axes.begin(), path.axes.end()) == path.axes.end();
    const bool sizes = blocks > 0 && axes_known && path.points.size() == (blocks + 1) * path.axes.size() &&
                       (path.programmed.empty() || path.programmed.size() == path.points.size()) &&
                       path.tolerance.size() == blocks && path.line.size() == blocks && path.rapid.size() == blocks &&
                       path.inside_arc.size() == blocks && path.joint.size() == blocks &&
                       result.plan.delays.size() == blocks && result.plan.errors.size() == blocks;
    if (!sizes) fail("the lists of commands are not of one length");
    const auto positive = [](double x) { return x > 0.0 && x < 1e9; };
    const bool in_range =
        std::all_of(path.duration.begin(), path.duration.end(), positive) &&
        std::all_of(path.points.begin(), path.points.end(), [](double x) { return std::abs(x) < 1e9; }) &&
        std::all_of(path.tolerance.begin(), path.tolerance.end(), [](double x) { return x >= 0.0; }) &&
        std::all_of(path.dwell.begin(), path.dwell.end(),
                    [&](const auto& d) { return d.first < blocks && d.second >= 0.0 && d.second < 1e9; }) &&
        path.dwell_first >= 0.0 && path.dwell_first < 1e9 && result.sample_period > 0.0 &&
        std::all_of(result.plan.delays.begin(), result.plan.delays.end(), [](int d) { return d >= 0; });
    if (!in_range) fail("commands hold a value out of range: durations are > 0, delays, tolerances and dwells >= 0");
  }

  std::string name_;
  Json json_;
};

}  // namespace

namespace {

/// The text of a result without its end, and its inputs. A line each, not a line a number.
std::string with_inputs(std::string text, const ProgramInputs& inputs) {
  text.erase(text.find_last_of('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text + ",\n  \"inputs\": " + inputs_json(inputs).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string profiles_to_json(const ProfileResult& result, const ProgramInputs& inputs) {
  return with_inputs(profiles_to_json(result), inputs) + "\n}\n";
}

std::string program_to_json(const ProgramResult& result, const ProgramInputs& inputs) {
  std::string text = with_inputs(program_to_json(result), inputs);
  const bool all = result.path.blocks() <= recorded_blocks_max;
  text += ",\n  \"commands\": " + (all ? commands_json(result).dump() : std::string("null")) + "\n}\n";
  return text;
}

bool is_program_result(std::string_view text) {
  // The schema is the first member of what accdec writes.
  return text.substr(0, 200).find("\"accdec.program/1\"") != std::string_view::npos;
}

bool is_profile_result(std::string_view text) {
  return text.substr(0, 200).find("\"accdec.profiles/1\"") != std::string_view::npos;
}

void refuse_profiles(std::string_view text, const std::string& name) {
  if (!is_profile_result(text)) return;
  throw InputError(name, 0, 0,
                   "a result of --plan profiles has no one filter; `accdec program --plan profiles` writes its motion "
                   "with --samples and draws it with --figure FILE.html");
}

ProgramRecord parse_program_record(std::string_view text, const std::string& name) {
  return Reader(text, name, is_program_result, "accdec.program/1").read();
}

ProgramRecord parse_profile_record(std::string_view text, const std::string& name) {
  return Reader(text, name, is_profile_result, "accdec.profiles/1").read_inputs_alone();
}

std::string hash_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, 0, 0, "cannot be read");
  // FNV-1a, piece by piece: programs may be larger than memory.
  std::uint64_t hash = 14695981039346656037ULL;
  std::vector<char> piece(std::size_t{1} << 16);
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0) {
    for (std::streamsize i = 0; i < in.gcount(); ++i)
      hash = (hash ^ static_cast<unsigned char>(piece[static_cast<std::size_t>(i)])) * 1099511628211ULL;
  }
  return fmt::format("{:016x}", hash);
}

DesignResult filter_of(const ProgramRecord& record) {
  DesignResult design;
  design.task = record.task;
  design.task.sample_period = record.result.sample_period;
  design.filter = record.result.filter;
  design.status = record.result.status;
  return design;
}

}  // namespace accdec
