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

class Comparison {
 public:
  explicit Comparison(std::vector<std::string> skip) : skip_(std::move(skip)) {}

  void compare(const std::string& name, const Json& recorded, const Json& found) {
    if (skips(name)) {
      found_.skipped.push_back(name);
      return;
    }
    if (recorded.is_object() && found.is_object()) return members(name, recorded, found);
    if (recorded.is_array() && found.is_array() && recorded.size() == found.size()) {
      for (std::size_t i = 0; i < found.size(); ++i) compare(fmt::format("{}[{}]", name, i), recorded[i], found[i]);
      return;
    }
    if (!same(recorded, found)) say(fmt::format("{} is recorded as {}, found {}", name, shown(recorded), shown(found)));
  }

  ProgramDifferences take() { return std::move(found_); }

 private:
  bool skips(const std::string& name) const { return std::find(skip_.begin(), skip_.end(), name) != skip_.end(); }
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
        found_.skipped.push_back(head + key);
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

  std::vector<std::string> skip_;
  ProgramDifferences found_;
};

}  // namespace

const std::vector<std::string>& program_members_not_checked() {
  static const std::vector<std::string> names{"candidates",
                                              "corners.raised_by_overlap",
                                              "corners.slowed_blocks",
                                              "feeds_slowed",
                                              "cycle_time_one_filter_s",
                                              "cycle_time_kept_feeds_s",
                                              "cycle_time_exact_stop_s",
                                              "exact_stop_breaks",
                                              "cycle_time_no_delay_s",
                                              "peak_memory_bytes",
                                              "solver"};
  return names;
}

ProgramDifferences program_differences(std::string_view text, const ProgramResult& found,
                                       const std::vector<std::string>& skip) {
  std::vector<std::string> all = program_members_not_checked();
  all.insert(all.end(), skip.begin(), skip.end());
  Comparison comparison(std::move(all));
  Json recorded = Json::parse(text);
  // What the commands are made from, and they themselves, were read and checked as such.
  recorded.erase("inputs");
  recorded.erase("commands");
  comparison.compare("", recorded, Json::parse(program_to_json(found)));
  return comparison.take();
}

}  // namespace accdec
