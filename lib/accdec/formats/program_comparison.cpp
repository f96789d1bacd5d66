#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/program_comparison.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

constexpr double tolerance = 1e-9, smallest = 1e-13;
constexpr std::size_t most = 10;

std::string shown(const Json& value) {
  return value.is_number_float() ? fmt::format("{:.12g}", value.get<double>()) : value.dump();
}

/// Members that say how a plan was found or what other plans take: a recheck cannot find them from the commands. What
/// it can say is whether they are of the kind that is written: one of each stands here.
const Json& not_compared_of_programs() {
  static const Json samples = Json::parse(R"({
    "candidates": [{"plan": "", "cycle_time_s": 0.5, "verified": true}],
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
    "solver": {"method": "", "name": "", "version": "", "claimed": "", "evaluations": 0, "wall_time_s": 0.5}
  })");
  return samples;
}

/// The same of plan profiles.
const Json& not_compared_of_profiles() {
  static const Json samples = Json::parse(R"({
    "candidates": [{"plan": "", "cycle_time_s": 0.5, "verified": true}],
    "corner_bound_s": 0.5,
    "corner_bound": {"corners": 0, "counted": 0, "classes": 0, "complete": true},
    "wall_time_s": 0.5
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

class Comparison {
 public:
  Comparison(const Json& not_compared, std::vector<std::string> skip)
      : not_compared_(not_compared), skip_(std::move(skip)) {}

  void compare(const std::string& name, const Json& recorded, const Json& found) {
    if (skips(name)) return skip(name, recorded);
    if (recorded.is_object() && found.is_object()) return members(name, recorded, found);
    if (recorded.is_array() && found.is_array() && recorded.size() == found.size()) {
      for (std::size_t i = 0; i < found.size(); ++i) compare(fmt::format("{}[{}]", name, i), recorded[i], found[i]);
      return;
    }
    if (!same(recorded, found)) say(fmt::format("{} is recorded as {}, found {}", name, shown(recorded), shown(found)));
  }

  ProgramDifferences take() { return std::move(found_); }

 private:
  bool skips(const std::string& name) const {
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
      else if (!skips(head + key))
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

  static bool same(const Json& recorded, const Json& found) {
    if (!recorded.is_number() || !found.is_number()) return recorded == found;
    if (recorded.is_number_integer() && found.is_number_integer()) return recorded == found;
    const double a = recorded.get<double>(), b = found.get<double>();
    return std::abs(a - b) <= tolerance * std::abs(b) + smallest;
  }

  const Json& not_compared_;
  std::vector<std::string> skip_;
  ProgramDifferences found_;
};

ProgramDifferences differences(std::string_view text, const std::string& found, const Json& not_compared,
                               std::vector<std::string> skip) {
  Comparison comparison(not_compared, std::move(skip));
  Json recorded = Json::parse(text);
  // What the commands are made from, and they themselves, were read and checked as such.
  recorded.erase("inputs");
  recorded.erase("commands");
  comparison.compare("", recorded, Json::parse(found));
  return comparison.take();
}

}  // namespace

ProgramDifferences program_differences(std::string_view text, const ProgramResult& found,
                                       const std::vector<std::string>& skip) {
  return differences(text, program_to_json(found), not_compared_of_programs(), skip);
}

ProgramDifferences profile_differences(std::string_view text, const ProfileResult& found) {
  return differences(text, profiles_to_json(found), not_compared_of_profiles(), {});
}

}  // namespace accdec
