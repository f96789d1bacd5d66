#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/record/program_settings_json.hpp>
#include <accdec/plan/record/recorded_joints.hpp>
#include <accdec/task.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

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

/// Reads a record strictly in the written form; errors name the place.
class Reader {
 public:
  Reader(std::string_view text, std::string name) : name_(std::move(name)) {
    json_ = Json::parse(text, nullptr, false);
    // The parser takes a zero byte as the end of the file.
    if (json_.is_discarded() || text.find('\0') != std::string_view::npos) fail("is not JSON");
    if (const auto at = json_too_deep(text)) {
      const auto [line, column] = line_and_column(text, *at);
      throw InputError(name_, line, column, "brackets nest more than 64 deep; no result does");
    }
    if (const auto at = duplicate_key(text)) {
      const auto [line, column] = line_and_column(text, *at);
      throw InputError(name_, line, column, "this key stands twice in its object; each may stand once");
    }
    const std::optional<ProgramSchema> schema = schema_of_program(text);
    if (!schema) fail("is no result of accdec program (schema accdec.program/2, accdec.program/1, accdec.profiles/1)");
    record_.schema = *schema;
  }

  ProgramRecord read() {
    ProgramResult& r = record_.result;
    try {
      r.program = json_.at("program").get<std::string>();
      r.status = json_.at("status") == "feasible" ? Status::feasible : Status::failed;
      if (r.status == Status::failed && json_["status"] != to_string(Status::failed))
        fail(fmt::format("status is {}; a program's is \"feasible\" or \"failed\"", json_["status"].dump()));
      if (record_.schema == ProgramSchema::profiles_1) {
        read_inputs(json_.at("inputs"));
        return std::move(record_);
      }
      read_summary();
      if (json_.contains("settings")) read_program_settings(json_["settings"], r);
      if (json_.contains("inputs")) read_inputs(json_["inputs"]);
      record_.commands = json_.contains("commands") && json_["commands"].is_object() && json_.contains("inputs");
      if (record_.commands) read_commands(json_["commands"]);
    } catch (const nlohmann::json::exception& error) {
      fail(fmt::format("is no whole result of accdec program: {}", error.what()));
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
    if (r.settings && record_.task.settings) {
      const auto& width = r.settings->chosen.width;
      r.plan.path.control = {record_.task.settings->delays, width ? width->middle() : 0.0};
    }
    if (record_.commands && r.sample_period != record_.task.sample_period)
      fail("sample_period_s is not that of the task in it");
    return std::move(record_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(name_, 0, 0, message); }

  void read_summary() {
    ProgramResult& r = record_.result;
    r.feeds_chosen = json_.at("feeds") == "chosen";
    r.worst_shown = json_.at("worst_corners").size();
    record_.filter_bound = json_.contains("filter_bound_s");
    r.sample_period = json_.at("sample_period_s").get<double>();
    if (json_.at("plan") == "profiles" || json_.at("plan") == "free") {
      r.plan.motion = Trajectory{{}, filter(json_.at("filter").at("taps"))};
    } else {
      r.plan.motion = FilteredCommand{filter(json_.at("filter").at("taps")), {}};
    }
    r.check.samples = integer<std::int64_t>(json_.at("samples"));
    r.cycle_time = json_.at("cycle_time_s").get<double>();
    r.delay_total = json_.at("delay_total_s").get<double>();
    read_bounds();
    r.corners = integer<std::size_t>(json_.at("corners").at("count"));
    r.worst_error = json_.at("corners").at("worst_error_m").get<double>();
    for (const Json& limit : json_.at("limits")) r.check.limits.push_back(limit_use(limit));
  }

  void read_bounds() {
    ProgramResult& r = record_.result;
    r.lower_bound = json_.at("lower_bound_s").get<double>();
    if (!json_.contains("corner_bound_s") || !json_.contains("corner_bound")) return;
    CornerBound& bound = r.corner_bound.emplace();
    const Json& counts = json_.at("corner_bound");
    bound.time = json_.at("corner_bound_s").get<double>();
    bound.corners = integer<std::size_t>(counts.at("corners"));
    bound.counted = integer<std::size_t>(counts.at("counted"));
    bound.classes = integer<std::size_t>(counts.at("classes"));
    bound.complete = counts.at("complete").get<bool>();
    for (const Json& named : json_.value("bounds", Json::array())) {
      if (named.at("name") == "any motion") bound.any_motion = named.at("time_s").get<double>();
    }
  }

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
    use.line = integer<std::uint32_t>(json.at("line"));
    if (use.kind == LimitKind::vibration) use.frequency = json.at("frequency_Hz").get<double>();
    return use;
  }

  void read_inputs(const Json& json) {
    ProgramInputs& in = record_.inputs;
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
    in.tools.table = json.value("tool_table", "");
    in.tools.table_in_inch = json.value("tool_table_in_inch", false);
    if (json.contains("tool_length_m")) in.tools.length = json.at("tool_length_m").get<double>();
    record_.task = parse_task(in.task_text, in.task_path + " (in " + name_ + ")",
                              {.require_corners = false, .axes = static_cast<int>(program_axis_count)});
    in.reading.error_max = record_.task.program_error_max;
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

  void read_commands(const Json& json) {
    ProgramResult& result = record_.result;
    Toolpath& path = result.plan.path;
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
    result.errors = numbers_or(json.at("error_m"), unlimited);
    check_path();
    if (auto* command = std::get_if<FilteredCommand>(&result.plan.motion)) {
      command->delays = integers<int>(json.at("delay_samples"));
      if (command->delays.size() != path.blocks()) fail("the lists of commands are not of one length");
      if (std::any_of(command->delays.begin(), command->delays.end(), [](int d) { return d < 0; }))
        fail("commands hold a value out of range: delays are >= 0");
      if (json.contains("filters")) read_filters(json);
    } else {
      json_.at("plan") == "free" ? read_free(json.at("trajectory")) : read_chain(json.at("trajectory"));
    }
  }

  void read_free(const Json& json) {
    const Toolpath& path = record_.result.plan.path;
    FreeMotion& free = std::get<Trajectory>(record_.result.plan.motion).free;
    free.position = json.at("positions_m").get<std::vector<double>>();
    const auto counts = integers<std::int64_t>(json.at("samples_of_block"));
    const auto samples = static_cast<std::int64_t>(free.position.size() / path.dimensions());
    std::int64_t sum = 0;
    for (const std::int64_t count : counts) {
      if (count < 0 || count > samples) fail("commands.trajectory.samples_of_block has a count out of range");
      sum += count;
    }
    const bool sizes = samples > 0 && free.position.size() % path.dimensions() == 0 && sum == samples &&
                       counts.size() == path.blocks();
    if (!sizes) fail("the lists of commands.trajectory are not of one length");
    const bool in_range =
        std::all_of(free.position.begin(), free.position.end(), [](double x) { return std::abs(x) < 1e9; });
    if (!in_range) fail("commands.trajectory has a position out of range");
    for (std::size_t b = 0; b < counts.size(); ++b)
      free.block.insert(free.block.end(), static_cast<std::size_t>(counts[b]), static_cast<std::uint32_t>(b));
  }

  /// Refuses a chain that cannot be driven: no leg is longer than its corners and ramps take, no speed above its feed,
  /// no feed above the path's.
  void read_chain(const Json& json) {
    const Toolpath& path = record_.result.plan.path;
    ProfileChain& chain = std::get<Trajectory>(record_.result.plan.motion).chain;
    const std::size_t legs = path.blocks(), n = path.dimensions();
    chain.levels = integer<int>(json.at("levels"));
    chain.feed = json.at("feed_m_s").get<std::vector<double>>();
    chain.ramp = json.at("ramp_m_s2").get<std::vector<double>>();
    chain.peak = json.at("peak_m_s").get<std::vector<double>>();
    chain.speed = json.at("speed_m_s").get<std::vector<double>>();
    chain.stretch = json.at("stretch_s2_m").get<std::vector<double>>();
    chain.coast = json.at("coast_s").get<std::vector<double>>();
    const auto rests = integers<int>(json.at("rests"));
    const bool sizes =
        chain.levels >= 1 && chain.levels <= 1000 && chain.feed.size() == legs && chain.peak.size() == legs &&
        chain.ramp.size() == legs * static_cast<std::size_t>(chain.levels) && chain.speed.size() == legs + 1 &&
        chain.stretch.size() == legs + 1 && chain.coast.size() == legs + 1 && rests.size() == legs + 1;
    if (!sizes) fail("the lists of commands.trajectory are not of one length");
    for (const int rest : rests) chain.speed_max.push_back(rest != 0 ? 0.0 : unlimited);
    for (std::size_t b = 0; b < legs; ++b) {
      double sum = 0.0;
      for (std::size_t a = 0; a < n; ++a) sum += std::pow(path.point(b + 1)[a] - path.point(b)[a], 2);
      chain.length.push_back(std::sqrt(sum));
    }
    check_chain(chain, path);
  }

  void check_chain(const ProfileChain& chain, const Toolpath& path) const {
    constexpr double slack = 1e-9;
    const auto positive = [](double x) { return x > 0.0 && x < 1e15; };
    const auto in_range = [](double x) { return x >= 0.0 && x < 1e9; };
    bool right = std::all_of(chain.ramp.begin(), chain.ramp.end(), positive);
    for (const auto* values : {&chain.feed, &chain.peak, &chain.speed, &chain.stretch, &chain.coast})
      right = right && std::all_of(values->begin(), values->end(), in_range);
    for (std::size_t b = 0; b < chain.legs() && right; ++b) {
      const double first = chain.speed[b], last = chain.speed[b + 1], peak = chain.peak[b], length = chain.length[b];
      const double ramps = 2.0 * chain.way(b, peak) - chain.way(b, first) - chain.way(b, last);
      right = peak > 0.0 && peak >= std::max(first, last) * (1.0 - slack) && peak <= chain.feed[b] * (1.0 + slack) &&
              chain.feed[b] <= length / path.duration[b] * (1.0 + 1e-5) &&
              chain.taken(b, first) + chain.taken(b + 1, last) + ramps <= length * (1.0 + slack) + slack;
    }
    for (std::size_t c = 0; c <= chain.legs() && right; ++c) {
      const bool must_stop = c == 0 || c == chain.legs() || path.joint[c - 1] == Joint::stop;
      right = (chain.stops(c) || !must_stop) && (!chain.stops(c) || chain.speed[c] == 0.0);
    }
    if (!right) fail("commands.trajectory cannot be driven: a speed, ramp or corner is out of its range");
  }

  /// The filters of plan per-leg.
  void read_filters(const Json& json) {
    std::vector<Filter> filters;
    for (const Json& taps : json.at("filters")) filters.push_back(filter(taps));
    auto of_block = integers<std::uint16_t>(json.at("filter_of_block"));
    const bool known =
        std::all_of(of_block.begin(), of_block.end(), [&](std::uint16_t i) { return i < filters.size(); });
    if (filters.empty() || !known || of_block.size() != record_.result.plan.path.blocks())
      fail("commands.filter_of_block names filters that are not there");
    record_.filters = BlockFilters{std::move(filters), std::move(of_block)};
  }

  void check_path() const {
    const ProgramResult& result = record_.result;
    const Toolpath& path = result.plan.path;
    const std::size_t blocks = path.blocks();
    const bool axes_known = !path.axes.empty() && std::is_sorted(path.axes.begin(), path.axes.end()) &&
                            path.axes.back() < program_axis_count &&
                            std::adjacent_find(path.axes.begin(), path.axes.end()) == path.axes.end();
    const bool sizes = blocks > 0 && axes_known && path.points.size() == (blocks + 1) * path.axes.size() &&
                       (path.programmed.empty() || path.programmed.size() == path.points.size()) &&
                       path.tolerance.size() == blocks && path.line.size() == blocks && path.rapid.size() == blocks &&
                       path.inside_arc.size() == blocks && path.joint.size() == blocks &&
                       result.errors.size() == blocks;
    if (!sizes) fail("the lists of commands are not of one length");
    const auto positive = [](double x) { return x > 0.0 && x < 1e9; };
    const bool in_range =
        std::all_of(path.duration.begin(), path.duration.end(), positive) &&
        std::all_of(path.points.begin(), path.points.end(), [](double x) { return std::abs(x) < 1e9; }) &&
        std::all_of(path.tolerance.begin(), path.tolerance.end(), [](double x) { return x >= 0.0; }) &&
        std::all_of(path.dwell.begin(), path.dwell.end(),
                    [&](const auto& d) { return d.first < blocks && d.second >= 0.0 && d.second < 1e9; }) &&
        path.dwell_first >= 0.0 && path.dwell_first < 1e9 && result.sample_period > 0.0;
    if (!in_range) fail("commands hold a value out of range: durations are > 0, tolerances and dwells >= 0");
  }

  std::string name_;
  Json json_;
  ProgramRecord record_;
};

}  // namespace

std::optional<ProgramSchema> schema_of_program(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, ProgramSchema>, 3> names{
      {{"\"accdec.program/2\"", ProgramSchema::program_2},
       {"\"accdec.program/1\"", ProgramSchema::program_1},
       {"\"accdec.profiles/1\"", ProgramSchema::profiles_1}}};
  // The schema is the first member of what accdec writes.
  for (const auto& [name, schema] : names) {
    if (text.substr(0, 200).find(name) != std::string_view::npos) return schema;
  }
  return std::nullopt;
}

ProgramRecord parse_program_record(std::string_view text, const std::string& name) {
  return Reader(text, name).read();
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

DesignResult filter_of(const ProgramRecord& record, const std::string& name) {
  const FilteredCommand* command = record.result.plan.command();
  if (record.schema == ProgramSchema::profiles_1 || command == nullptr) {
    throw InputError(
        name, 0, 0,
        fmt::format("a result of --plan {} has no one filter; `accdec program` writes its motion with --samples and "
                    "draws it with --figure FILE.html",
                    command == nullptr ? record.result.plan.name() : "profiles"));
  }
  DesignResult design;
  design.task = record.task;
  design.task.sample_period = record.result.sample_period;
  design.filter = command->filter;
  design.status = record.result.status;
  const Toolpath& path = record.result.plan.path;
  for (std::size_t block = 0; record.commands && block < path.blocks(); ++block) {
    if (path.joint[block] == Joint::stop) continue;
    CornerResult joint{.name = fmt::format("line {}", path.line[block])};
    joint.delay = command->delays[block];
    design.corners.push_back(std::move(joint));
  }
  return design;
}

}  // namespace accdec
