#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/record/program_comparison.hpp>
#include <accdec/plan/record/program_versions.hpp>
#include <accdec/plan/report/samples.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr double tolerance = 1e-9, smallest = 1e-13;
constexpr double planned_again = 1e-5;  // of a plan that is made again: corners are searched to a millionth of the feed
constexpr std::size_t most = 10;

std::string shown(const Json& value) {
  return value.is_number_float() ? fmt::format("{:.12g}", value.get<double>()) : value.dump();
}

/// Members that say how a plan was found or what other plans take. A recheck cannot compute them from the commands, so
/// it only compares their types with those of these examples.
const Json& not_compared_members() {
  static const Json samples = Json::parse(R"({
    "candidates": [{"plan": "", "cycle_time_s": 0.5, "verified": true}],
    "bounds": [{"name": "", "time_s": 0.5, "motions": "", "complete": true}],
    "compensation": "",
    "corner_bound_s": 0.5,
    "corner_bound": {"corners": 0, "counted": 0, "classes": 0, "complete": true},
    "corners.slowed_blocks": 0,
    "feeds_slowed": [{"limit": "", "blocks": 0, "factor": 0.5, "line": 0}],
    "cycle_time_one_filter_s": 0.5,
    "cycle_time_kept_feeds_s": 0.5,
    "cycle_time_exact_stop_s": 0.5,
    "exact_stop_breaks": null,
    "cycle_time_no_delay_s": 0.5,
    "peak_memory_bytes": 0,
    "repair_rounds": 0,
    "wall_time_s": 0.5,
    "solver": {"method": "", "name": "", "version": "", "claimed": "", "evaluations": 0, "wall_time_s": 0.5}
  })");
  return samples;
}

/// Whether a value is of the kind of another one: of numbers none is negative, and whole ones stay whole; null stands
/// for a text that may be missing.
bool of_kind(const Json& value, const Json& kind) {
  if (kind.is_null()) return value.is_null() || value.is_string();
  if (kind.is_number_integer()) return value.is_number_integer() && value >= 0;
  if (kind.is_number()) return value.is_number() && value >= 0.0;
  if (kind.is_array())
    return value.is_array() &&
           std::all_of(value.begin(), value.end(), [&](const Json& element) { return of_kind(element, kind[0]); });
  if (!kind.is_object()) return value.type() == kind.type();
  if (!value.is_object() || value.size() != kind.size()) return false;
  return std::all_of(kind.items().begin(), kind.items().end(), [&](const auto& member) {
    return value.contains(member.key()) && of_kind(value[member.key()], member.value());
  });
}

/// "jerk y: 100.0 % at sample 630, line 14" without its place.
std::string without_place(const std::string& worst) {
  return worst.substr(0, worst.find(" at sample "));
}

class Comparison {
 public:
  /// @param recorded     the whole record, kept as is `found`
  /// @param result       that is compared
  /// @param schema       of the record: all that the present one writes must be there
  Comparison(const Json& recorded, const Json& found, std::vector<std::string> skip, const ProgramResult& result,
             ProgramSchema schema)
      : recorded_(recorded),
        again_(found),
        skip_(std::move(skip)),
        result_(result),
        whole_(schema == ProgramSchema::program_2),
        planned_again_(schema == ProgramSchema::profiles_1) {}

  void compare(const std::string& name, const Json& recorded, const Json& found) {
    if (skips(name)) return skip(name, recorded);
    if (recorded.is_object() && found.is_object()) return members(name, recorded, found);
    if (recorded.is_array() && found.is_array() && recorded.size() == found.size()) {
      for (std::size_t i = 0; i < found.size(); ++i) compare(fmt::format("{}[{}]", name, i), recorded[i], found[i]);
      return;
    }
    if (!same(recorded, found) && !of_a_tie(name, recorded, found))
      say(fmt::format("{} is recorded as {}, found {}", name, shown(recorded), shown(found)));
  }

  /// No plan is shorter than a bound, however the bound was found; and how much was counted for it.
  void check_bound(const Json& recorded, const Json& found) {
    // It bounds sums of monotone legs, which a free motion is not.
    if (recorded.value("plan", "") != "free")
      at_most(recorded, "corner_bound_s", number_in(found, "cycle_time_s"), "the plan takes {} s");
    const auto bound = recorded.find("corner_bound");
    if (bound == recorded.end() || !of_kind(*bound, not_compared_["corner_bound"])) return;
    if (found.contains("corner_bound")) {
      for (const char* name : {"corners", "counted"}) {
        if ((*bound)[name] != found["corner_bound"][name])
          say(fmt::format("corner_bound.{} is recorded as {}, found {}", name, shown((*bound)[name]),
                          shown(found["corner_bound"][name])));
      }
    }
    at_most(*bound, "counted", number_in(*bound, "corners"), "there are {} corners", "corner_bound.");
    if ((*bound)["counted"] == 0) at_most(*bound, "classes", 0.0, "no corner counts", "corner_bound.");
    at_most(*bound, "classes", corner_programs_max, "there are at most {} linear programs", "corner_bound.");
  }

  /// The list of bounds repeats those beside it, each with its class of motions, and adds one for any motion.
  void check_bounds(const Json& recorded, const Json& found) {
    const auto bounds = recorded.find("bounds");
    if (bounds == recorded.end() || !of_kind(*bounds, not_compared_["bounds"])) return;
    for (const Json& bound : *bounds) {
      const std::string name = bound["name"];
      if (name != "monotone legs" || recorded.value("plan", "") != "free")
        at_most(bound, "time_s", number_in(found, "cycle_time_s"), "the plan takes {} s", "bounds.");
      const char* beside = name == "way over feed" ? "lower_bound_s" : name == "monotone legs" ? "corner_bound_s" : "";
      if (*beside == '\0') {
        if (name != "any motion") say(fmt::format("bounds: no bound is called {}", shown(bound["name"])));
      } else if (!recorded.contains(beside) || !same(bound["time_s"], recorded[beside])) {
        say(fmt::format("bounds: {} is recorded as {}, not as {}", name, shown(bound["time_s"]), beside));
      }
    }
  }

  /// Names and classes of motions are texts that follow from the bounds.
  void check_motions(const Json& recorded, const ProgramResult& plan) {
    const auto bounds = recorded.find("bounds");
    if (bounds == recorded.end() || !of_kind(*bounds, not_compared_["bounds"])) return;
    const std::vector<NamedBound> named = named_bounds(plan.lower_bound, plan.corner_bound);
    if (named.size() != bounds->size())
      return say(
          fmt::format("bounds: {} are recorded, and {} follow from what is beside them", bounds->size(), named.size()));
    for (std::size_t i = 0; i < named.size(); ++i) {
      compare(fmt::format("bounds[{}].name", i), (*bounds)[i]["name"], named[i].name);
      compare(fmt::format("bounds[{}].motions", i), (*bounds)[i]["motions"], named[i].motions);
      compare(fmt::format("bounds[{}].complete", i), (*bounds)[i]["complete"], named[i].complete);
    }
  }

  /// The plans made beside this one have names, and one that was verified would be the answer if it were faster.
  void check_candidates(const Json& recorded, const Json& found) {
    const auto plans = recorded.find("candidates");
    if (plans == recorded.end() || !of_kind(*plans, not_compared_["candidates"])) return;
    const double cycle = number_in(found, "cycle_time_s");
    for (const Json& other : *plans) {
      const Json& name = other["plan"];
      const bool known = name == "fixed" || name == "profiles" || name == (whole_ ? "free" : "per-leg");
      if (!known) say(fmt::format("candidates: no plan is called {}", shown(name)));
      if (other["verified"] == true && number_in(other, "cycle_time_s") < cycle * (1.0 - tolerance))
        say(fmt::format("candidates: plan {} is recorded as verified with {} s, but the answer takes {:.12g} s",
                        shown(name), shown(other["cycle_time_s"]), cycle));
    }
  }

  /// The time at the programmed feeds is between the way over these feeds, up to the chords of arcs, and the longest
  /// that it could be.
  void check_kept(const Json& recorded, const Json& found, bool may_be_there) {
    constexpr const char* name = "cycle_time_kept_feeds_s";
    if (recorded.contains(name) && !may_be_there)
      say(fmt::format("{} is recorded, but the plan keeps its feeds", name));
    if (!recorded.contains(name) || !found.contains(name)) return;
    at_most(recorded, name, number_in(found, name), "no plan at the programmed feeds takes more than {} s");
    const double way = number_in(found, "lower_bound_s");
    if (number_in(recorded, name) < 0.99 * way)
      say(fmt::format("{} is recorded as {}, but the way over the feeds is {:.12g} s", name, shown(recorded[name]),
                      way));
  }

  /// Times of other rules for delays, at feeds that are not recorded: none is below that without delays, nor above the
  /// exact stops of all moves, and delays only add.
  /// @param order_max  of the filter of a plan at the programmed feeds, which may have its own
  void check_other_rules(const Json& recorded, const Json& found, const ProgramResult& plan, int order_max) {
    if (plan.cycle_time_no_delay || plan.plan.command() == nullptr) return;
    const double kept = number_in(recorded, "cycle_time_kept_feeds_s"), cycle = number_in(found, "cycle_time_s"),
                 none = number_in(recorded, "cycle_time_no_delay_s");
    const double stop = (std::max(plan.plan.filter().order(), order_max) + 2.0) * plan.sample_period;
    at_most(recorded, "cycle_time_no_delay_s", std::max(cycle, kept), "a plan with delays takes {} s");
    at_most(recorded, "cycle_time_exact_stop_s", none + stop * static_cast<double>(plan.plan.path.blocks() + 1),
            "stops after all moves take at most {} s");
    if (const double stops = number_in(recorded, "cycle_time_exact_stop_s"); stops < none * (1.0 - tolerance))
      say(fmt::format("cycle_time_exact_stop_s is recorded as {:.12g}, but no delays take {:.12g} s", stops, none));
  }

  ProgramDifferences take() { return std::move(found_); }

 private:
  static double number_in(const Json& json, const char* name) {
    const auto value = json.find(name);
    return value != json.end() && value->is_number() ? value->get<double>() : 0.0;
  }
  void at_most(const Json& recorded, const char* name, double most, fmt::format_string<std::string> but,
               const char* head = "") {
    if (number_in(recorded, name) <= most * (1.0 + tolerance)) return;
    say(fmt::format("{}{} is recorded as {}, but {}", head, name, shown(recorded[name]),
                    fmt::format(but, fmt::format("{:.12g}", most))));
  }

  /// Results of earlier schemas lack the first ones; the others are always written, but compared in kind only.
  bool may_lack(const std::string& name) const {
    if (name.ends_with(".left_at_end") || name.ends_with(".left_at_stop") || name.starts_with("servo.leg_"))
      return true;  // earlier results do not say it
    if (name == "control_must" || name == "feed_overrides" || name == "not_considered" || name == "axis_loads")
      return !whole_;
    const bool written = name == "bounds" || name == "feeds_slowed" || name == "repair_rounds" || name == "solver" ||
                         name == "corners.slowed_blocks";
    return skips(name) && !(whole_ && written);
  }
  bool skips(const std::string& name) const {
    // If the times of other rules for delays were found again, they are compared, too.
    if (result_.cycle_time_no_delay.has_value() &&
        (name == "cycle_time_no_delay_s" || name == "cycle_time_exact_stop_s" || name == "exact_stop_breaks"))
      return false;
    return not_compared_.contains(name) || std::find(skip_.begin(), skip_.end(), name) != skip_.end();
  }
  void skip(const std::string& name, const Json& recorded) {
    found_.skipped.push_back(name);
    if (const auto kind = not_compared_.find(name); kind != not_compared_.end() && !of_kind(recorded, *kind))
      say(fmt::format("{} is recorded as {}, which no result has", name, shown(recorded)));
  }
  void say(std::string reason) {
    if (found_.reasons.size() < most) found_.reasons.push_back(std::move(reason));
  }

  void members(const std::string& name, const Json& recorded, const Json& found) {
    const std::string head = name.empty() ? "" : name + ".";
    for (const auto& [key, value] : found.items()) {
      if (recorded.contains(key))
        compare(head + key, recorded[key], value);
      else if (!may_lack(head + key))
        say(fmt::format("{}{} is missing", head, key));
    }
    for (const auto& [key, value] : recorded.items()) {
      if (found.contains(key)) continue;
      if (skips(head + key))
        skip(head + key, value);
      else
        say(fmt::format("{}{} is recorded, but no member of this result", head, key));
    }
  }

  /// A limit may be used as much at several samples, but for rounding. Then any of them is the worst, with its line;
  /// its value is compared beside it.
  bool of_a_tie(const std::string& name, const Json& recorded, const Json& found) const {
    constexpr std::string_view limits = "limits[";
    if (name.starts_with(limits) && recorded.is_number_integer()) {
      if (name.ends_with("].sample")) return recorded >= 0 && recorded <= result_.check.samples;
      const std::size_t i = std::stoul(name.substr(limits.size()));
      return name.ends_with("].line") &&
             recorded_["limits"][i].value("sample", Json()) != again_["limits"][i]["sample"];
    }
    if (name == "arcs.worst_line") {
      const Toolpath& path = result_.plan.path;
      return std::ranges::any_of(path.arcs, [&](const PathArc& arc) { return recorded == path.line[arc.first]; });
    }
    return name == "verification.worst" && recorded.is_string() && found.is_string() &&
           without_place(recorded.get<std::string>()) == without_place(found.get<std::string>()) &&
           names_a_limit(recorded.get<std::string>());
  }

  /// Whether it ends with the sample and the line of a recorded limit.
  bool names_a_limit(const std::string& worst) const {
    const Json limits = recorded_.value("limits", Json::array());
    return std::any_of(limits.begin(), limits.end(), [&](const Json& limit) {
      return worst.ends_with(fmt::format(" at sample {}, line {}", limit.value("sample", -1), limit.value("line", -1)));
    });
  }

  bool same(const Json& recorded, const Json& found) const {
    if (!recorded.is_number() || !found.is_number()) return recorded == found;
    if (recorded.is_number_integer() && found.is_number_integer()) return recorded == found;
    const double a = recorded.get<double>(), b = found.get<double>();
    return std::abs(a - b) <= (planned_again_ ? planned_again : tolerance) * std::abs(b) + smallest;
  }

  const Json& not_compared_ = not_compared_members();
  const Json &recorded_, &again_;
  std::vector<std::string> skip_;
  const ProgramResult& result_;
  bool whole_, planned_again_;
  ProgramDifferences found_;
};

/// Earlier results do not say of each bound whether it was finished.
void add_complete(Json& recorded, const ProgramResult& plan) {
  const auto bounds = recorded.find("bounds");
  if (bounds == recorded.end() || !bounds->is_array()) return;
  const std::vector<NamedBound> named = named_bounds(plan.lower_bound, plan.corner_bound);
  for (std::size_t i = 0; i < bounds->size(); ++i) {
    Json& bound = (*bounds)[i];
    if (bound.is_object() && !bound.contains("complete")) bound["complete"] = i >= named.size() || named[i].complete;
  }
}

}  // namespace

ProgramDifferences program_differences(std::string_view text, const ProgramRecord& record, const ProgramResult& found,
                                       const std::vector<std::string>& skip) {
  const bool whole = record.schema == ProgramSchema::program_2;
  Json recorded = Json::parse(text);
  // The plan and its inputs were read and checked as such.
  recorded.erase("inputs");
  recorded.erase("commands");
  recorded.erase("settings");
  recorded.erase("any_motion_proof");
  const Json answer = recorded.contains("answer") ? recorded["answer"] : Json();  // older results have none
  recorded.erase("answer");
  recorded.erase("today_s");
  recorded.erase("today_breaks");
  const Json again = as_written_then(Json::parse(program_to_json(found)), found, record);
  Comparison comparison(recorded, again, skip, found, record.schema);
  add_complete(recorded, record.result);
  comparison.compare("", recorded, again);
  comparison.check_bound(recorded, again);
  comparison.check_bounds(recorded, again);
  if (whole) comparison.check_motions(recorded, record.result);
  comparison.check_candidates(recorded, again);
  comparison.check_kept(recorded, again, !whole || record.result.feeds_chosen);
  const int order_max = record.task.design.order_max + Response(record.task.machine, found.sample_period).order();
  if (whole) comparison.check_other_rules(recorded, again, found, order_max);
  ProgramDifferences differences = comparison.take();
  const bool taps = !record.result.taps_control.empty() && found.plan.command() != nullptr;
  if (!answer.is_null() && (!taps || answer != program_taps_answer(found)))
    differences.reasons.emplace_back("answer is not what the other members say");
  // The motion has no use for them: steady ramps need no feed, and at rest no corner is stretched.
  const Trajectory* trajectory = record.result.plan.trajectory();
  if (whole && trajectory != nullptr && !trajectory->is_free() && !trajectory->chain.speed.empty()) {
    if (trajectory->chain.levels == 1) differences.skipped.emplace_back("commands.trajectory.feed_m_s");
    differences.skipped.emplace_back("commands.trajectory.stretch_s2_m at rest");
  }
  if (record.result.settings) {
    for (const char* name : {"members", "tried", "guessed", "complete", "free_taps_s"})
      differences.skipped.push_back(std::string("settings.") + name);
    if (!record.result.settings->breaks.empty()) differences.skipped.emplace_back("settings.breaks");
    if (record.result.settings->free_taps_limit) differences.skipped.emplace_back("settings.free_taps_limit_s");
    if (record.result.settings->search_limit) differences.skipped.emplace_back("settings.search_limit_s");
  }
  return differences;
}

}  // namespace accdec
