#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <initializer_list>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files.hpp>
#include <accdec/formats/json_text.hpp>
#include <accdec/formats/json_value.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/position_unit.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/record/motion_proof_json.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/record/program_settings_json.hpp>
#include <accdec/plan/record/recorded_corner_bound.hpp>
#include <accdec/plan/record/recorded_estimates.hpp>
#include <accdec/plan/record/recorded_joints.hpp>
#include <accdec/plan/report/plan_facts.hpp>

namespace accdec {
namespace {

/// Reads a record strictly in the written form; mistakes name the place.
class Reader {
 public:
  Reader(const Value& json, ProgramSchema schema, std::string name) : json_(json), name_(std::move(name)) {
    record_.schema = schema;
  }

  ProgramRecord read() {
    ProgramResult& r = record_.result;
    r.program = json_["program"].text();
    r.status = json_["status"].word({Status::feasible, Status::failed});
    if (record_.schema == ProgramSchema::profiles_1) {
      read_inputs(json_["inputs"]);
      return std::move(record_);
    }
    read_summary();
    if (json_.has("inputs")) read_inputs(json_["inputs"]);
    if (json_.has("settings")) read_program_settings(json_["settings"], record_.task, r);
    read_program_today(json_, r);
    record_.commands = json_.has("commands") && json_.has("inputs");
    if (record_.commands) read_commands(json_["commands"]), r.taps_control = control_of_taps(record_.task);
    if (record_.task.settings) {
      const bool width = r.settings && r.settings->chosen.width;
      r.plan.path.control = planned_control(record_.task, width ? r.settings->chosen.width->middle() : 0.0);
    }
    if (r.settings && record_.commands) check_settings_answer(json_["settings"], r);
    set_behind_response();
    if (record_.commands && r.sample_period != record_.task.sample_period)
      json_["sample_period_s"].fail("is not that of the task in it");
    return std::move(record_);
  }

 private:
  /// The record has the taps that are set.
  void set_behind_response() {
    const ProgramResult& r = record_.result;
    auto* command = std::get_if<FilteredCommand>(&record_.result.plan.motion);
    if (command == nullptr) return;
    if (!record_.task.machine.prefilter_taps.empty()) {
      command->own = command->filter;
      command->filter = Response(record_.task.machine, r.sample_period).command(*command->own);
    }
    const Machine machine = program_machine(record_.task.machine, r.plan.path);
    if (!has_servo(machine)) return;
    const FilterBehind behind(command->filter, machine, r.sample_period);
    command->moved.assign(behind.servo().begin(), behind.servo().end());
  }

  void read_summary() {
    ProgramResult& r = record_.result;
    r.feeds_chosen = one_of(json_["feeds"], {"chosen", "programmed"}) == "chosen";
    r.worst_shown = json_["worst_corners"].elements().size();
    record_.filter_bound = json_.has("filter_bound_s");
    r.sample_period = json_["sample_period_s"].number();
    plan_ = one_of(json_["plan"], {"fixed", "profiles", "free", "per-leg"});
    if (plan_ == "profiles" || plan_ == "free") {
      r.plan.motion = Trajectory{{}, filter(json_["filter"]["taps"])};
    } else {
      r.plan.motion = FilteredCommand{filter(json_["filter"]["taps"]), {}};
    }
    r.check.samples = json_["samples"].integer<std::int64_t>();
    r.cycle_time = json_["cycle_time_s"].number();
    r.delay_total = json_["delay_total_s"].number();
    r.lower_bound = json_["lower_bound_s"].number();
    r.corner_bound = recorded_corner_bound(json_);
    if (json_.has("any_motion_proof")) {
      if (!r.corner_bound) json_["any_motion_proof"].fail("belongs to `corner_bound`, which is missing");
      read_motion_proof(json_["any_motion_proof"], *r.corner_bound);
    }
    r.corners = json_["corners"]["count"].integer<std::size_t>();
    r.worst_error = json_["corners"]["worst_error_m"].number();
    for (const Value& limit : json_["limits"].elements()) r.check.limits.push_back(limit_use(limit));
    if (json_.has("servo")) {
      const Value servo = json_["servo"];
      r.servo = {servo["settling_s"].number(), servo["within_m"].number(), servo["stop_error_m"].number()};
      if (servo.has("leg_error_m"))
        r.servo->legs = {servo["leg_error_m"].number(), servo["leg_line"].integer<std::uint32_t>()};
    }
    if (json_.has("estimates")) r.estimates = recorded_estimates(json_["estimates"]);
  }

  static std::string one_of(const Value& json, std::initializer_list<std::string_view> words) {
    std::string given = json.text();
    if (std::find(words.begin(), words.end(), given) == words.end())
      json.fail(fmt::format("\"{}\" is unknown; allowed are {}", given, fmt::join(words, ", ")));
    return given;
  }

  static Filter filter(const Value& json) {
    std::vector<double> taps = json.numbers();
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
    if (!(std::abs(sum - 1.0) <= 1e-9)) json.fail(fmt::format("have the sum {:.15g}; it must be 1", sum));
    try {
      return Filter(std::move(taps));
    } catch (const std::invalid_argument& error) {
      json.fail(error.what());
    }
  }

  LimitUse limit_use(const Value& json) const {
    std::array<LimitKind, limit_names.size()> kinds{};
    std::transform(limit_names.begin(), limit_names.end(), kinds.begin(), [](const LimitName& l) { return l.kind; });
    LimitUse use;
    use.kind = json["kind"].word(std::span<const LimitKind>(kinds));
    use.axis = json["axis"].text();
    // Earlier schemas count a degree as a millimetre.
    const double in_si = record_.schema == ProgramSchema::program_2 ? si_over_inside(use.kind, use.axis) : 1.0;
    use.value = json["value"].number() / in_si;
    use.bound = json["bound"].number() / in_si;
    use.utilisation = json["utilisation"].number();
    use.sample = json["sample"].integer<std::int64_t>();
    use.line = json["line"].integer<std::uint32_t>();
    if (of_mode(use.kind)) use.frequency = json["frequency_Hz"].number();
    if (json.has("damping_ratio")) use.damping = json["damping_ratio"].number();
    return use;
  }

  void read_inputs(const Value& json) {
    ProgramInputs& in = record_.inputs;
    in.program = json["program"].text();
    in.program_hash = json["program_hash"].text();
    in.task_path = json["task"].text();
    in.task_text = json["task_text"].text();
    in.reading.read.arc_tolerance = json["arc_tolerance_m"].number();
    if (!(in.reading.read.arc_tolerance > 0.0)) json["arc_tolerance_m"].fail("must be greater than 0");
    in.reading.clamp_feeds = json["clamp_feeds"].boolean();
    in.reading.widen_arcs = json.has("compensate_arcs") && json["compensate_arcs"].boolean();
    in.reading.rapid_stops = json["rapid_stops"].boolean();
    in.reading.dwells_before_filter = json["dwells_before_filter"].boolean();
    in.interpreted = json["interpreted"].boolean();
    if (json.has("tool_table")) in.tools.table = json["tool_table"].text();
    in.tools.table_in_inch = json.has("tool_table_in_inch") && json["tool_table_in_inch"].boolean();
    if (json.has("tool_length_m")) in.tools.length = json["tool_length_m"].number();
    record_.task = parse_task(
        in.task_text, in.task_path + " (in " + name_ + ")",
        {.require_corners = false, .axes = static_cast<int>(program_axis_count), .response = Considered::all});
    record_.result.task_machine = record_.task.machine;
    in.reading.error_max = record_.task.program_error_max;
    in.reading.room_for_chords = record_.schema == ProgramSchema::program_2;
    in.reading.contour_max = record_.task.program_contour_max.value_or(unlimited);
  }

  static std::vector<std::uint8_t> flags(const Value& json) {
    std::vector<std::uint8_t> values;
    for (const char c : json.text()) {
      if (c != '0' && c != '1') json.fail("has a character that is neither 0 nor 1");
      values.push_back(c == '1' ? 1 : 0);
    }
    return values;
  }

  void read_commands(const Value& json) {
    ProgramResult& result = record_.result;
    Toolpath& path = result.plan.path;
    path.axes = json["axes"].integers<std::size_t>();
    path.points = json["points_m"].numbers();
    if (json.has("programmed_m")) path.programmed = json["programmed_m"].numbers();
    path.duration = json["duration_s"].numbers();
    path.tolerance = json["tolerance_m"].numbers_or_infinity();
    path.line = json["line"].integers<std::uint32_t>();
    path.rapid = flags(json["rapid"]);
    path.inside_arc = flags(json["inside_arc"]);
    for (const char letter : json["joint"].text()) {
      const auto at = joint_letters.find(letter);
      if (at == std::string_view::npos) json["joint"].fail("has a letter that is none of c, s, l and .");
      path.joint.push_back(static_cast<Joint>(at));
    }
    for (const Value& dwell : json["dwell"].elements()) {
      const std::vector<Value> pair = dwell.elements();
      if (pair.size() != 2) dwell.fail("must be a block and its dwell in s");
      path.dwell.emplace_back(pair[0].integer<std::uint32_t>(), pair[1].number());
    }
    path.dwell_first = json["dwell_first_s"].number();
    path.contour_max = contour_in_units(record_.inputs.reading.contour_max, result.task_machine, path.dimensions());
    result.errors = json["error_m"].numbers_or_infinity();
    check_path(json);
    if (auto* command = std::get_if<FilteredCommand>(&result.plan.motion)) {
      command->delays = json["delay_samples"].integers<int>();
      if (command->delays.size() != path.blocks()) json.fail(lengths_differ);
      if (json.has("filters")) read_filters(json);
    } else {
      plan_ == "free" ? read_free(json["trajectory"]) : read_chain(json["trajectory"]);
    }
  }

  void read_free(const Value& json) {
    const Toolpath& path = record_.result.plan.path;
    FreeMotion& free = std::get<Trajectory>(record_.result.plan.motion).free;
    free.position = json["positions_m"].numbers();
    const auto counts = json["samples_of_block"].integers<std::int64_t>();
    const auto samples = static_cast<std::int64_t>(free.position.size() / path.dimensions());
    std::int64_t sum = 0;
    for (const std::int64_t count : counts) {
      if (count > samples) json["samples_of_block"].fail(fmt::format("has {}; there are {} samples", count, samples));
      sum += count;
    }
    const bool sizes = samples > 0 && free.position.size() % path.dimensions() == 0 && sum == samples &&
                       counts.size() == path.blocks();
    if (!sizes) json.fail(lengths_differ);
    const bool in_range =
        std::all_of(free.position.begin(), free.position.end(), [](double x) { return std::abs(x) < 1e9; });
    if (!in_range) json["positions_m"].fail("has a position out of range; all must be below 1e9");
    for (std::size_t b = 0; b < counts.size(); ++b)
      free.block.insert(free.block.end(), static_cast<std::size_t>(counts[b]), static_cast<std::uint32_t>(b));
  }

  /// Refuses a chain that cannot be driven: no leg is longer than its corners and ramps take, no speed above its feed,
  /// no feed above the path's.
  void read_chain(const Value& json) {
    const Toolpath& path = record_.result.plan.path;
    ProfileChain& chain = std::get<Trajectory>(record_.result.plan.motion).chain;
    const std::size_t legs = path.blocks(), n = path.dimensions();
    chain.levels = static_cast<int>(json["levels"].integer(1, 1000));
    chain.feed = json["feed_m_s"].numbers();
    chain.ramp = json["ramp_m_s2"].numbers();
    chain.peak = json["peak_m_s"].numbers();
    chain.speed = json["speed_m_s"].numbers();
    chain.stretch = json["stretch_s2_m"].numbers();
    chain.coast = json["coast_s"].numbers();
    const auto rests = json["rests"].integers<int>();
    const bool sizes = chain.feed.size() == legs && chain.peak.size() == legs &&
                       chain.ramp.size() == legs * static_cast<std::size_t>(chain.levels) &&
                       chain.speed.size() == legs + 1 && chain.stretch.size() == legs + 1 &&
                       chain.coast.size() == legs + 1 && rests.size() == legs + 1;
    if (!sizes) json.fail(lengths_differ);
    for (const int rest : rests) chain.speed_max.push_back(rest != 0 ? 0.0 : unlimited);
    for (std::size_t b = 0; b < legs; ++b) {
      double sum = 0.0;
      for (std::size_t a = 0; a < n; ++a) sum += std::pow(path.point(b + 1)[a] - path.point(b)[a], 2);
      chain.length.push_back(std::sqrt(sum));
    }
    check_chain(json, chain, path);
  }

  static void check_chain(const Value& json, const ProfileChain& chain, const Toolpath& path) {
    constexpr double slack = 1e-9;
    // A stretch is the reciprocal of an acceleration.
    const auto positive = [](double x) { return x > 0.0 && x < 1e15; };
    const auto in_range = [](double x) { return x >= 0.0 && x < 1e15; };
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
    if (!right) json.fail("cannot be driven: a speed, ramp or corner is out of its range");
  }

  /// The filters of plan per-leg.
  void read_filters(const Value& json) {
    std::vector<Filter> filters;
    for (const Value& taps : json["filters"].elements()) filters.push_back(filter(taps));
    auto of_block = json["filter_of_block"].integers<std::uint16_t>();
    const bool known =
        std::all_of(of_block.begin(), of_block.end(), [&](std::uint16_t i) { return i < filters.size(); });
    if (filters.empty() || !known || of_block.size() != record_.result.plan.path.blocks())
      json["filter_of_block"].fail("names filters that are not there");
    record_.filters = BlockFilters{std::move(filters), std::move(of_block)};
  }

  void check_path(const Value& json) const {
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
    if (!axes_known) json["axes"].fail("must be different axes in their order, 0 to 8");
    if (!sizes) json.fail(lengths_differ);
    const auto positive = [](double x) { return x > 0.0 && x < 1e9; };
    const bool in_range =
        std::all_of(path.duration.begin(), path.duration.end(), positive) &&
        std::all_of(path.points.begin(), path.points.end(), [](double x) { return std::abs(x) < 1e9; }) &&
        std::all_of(path.tolerance.begin(), path.tolerance.end(), [](double x) { return x >= 0.0; }) &&
        std::all_of(path.dwell.begin(), path.dwell.end(),
                    [&](const auto& d) { return d.first < blocks && d.second >= 0.0 && d.second < 1e9; }) &&
        path.dwell_first >= 0.0 && path.dwell_first < 1e9 && result.sample_period > 0.0;
    if (!in_range) json.fail("hold a value out of range: durations are > 0, tolerances and dwells >= 0");
  }

  static constexpr const char* lengths_differ = "has lists that are not of one length, which all must have";

  const Value json_;
  const std::string name_;
  std::string plan_;
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
  const nlohmann::ordered_json json = parse_json_text(text, name);
  const std::optional<ProgramSchema> schema = schema_of_program(text);
  if (!schema) {
    throw InputError(name, 1, 1,
                     "is no result of accdec program (schema accdec.program/2, accdec.program/1, accdec.profiles/1)");
  }
  try {
    return Reader(Value(json, ""), *schema, name).read();
  } catch (const Mistake& mistake) {
    throw at_its_place(InputError("", 0, 0, mistake.message, mistake.pointer), text, name);
  }
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
  design.filter = command->set();
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
