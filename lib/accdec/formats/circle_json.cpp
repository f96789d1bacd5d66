#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/circle_json.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

struct Member {
  const char* name;
  double CircleError::*value;
};
constexpr std::array<Member, 4> members{{{"radius_error_m", &CircleError::radius_error},
                                         {"small_angle_m", &CircleError::small_angle},
                                         {"simulated_m", &CircleError::simulated},
                                         {"deviation_s", &CircleError::deviation}}};

}  // namespace

void add_circle(std::string& json, const CircleRecord& circle) {
  nlohmann::ordered_json object{{"radius_m", circle.radius}, {"feed_m_s", circle.feed}};
  for (const Member& member : members) object[member.name] = circle.error.*member.value;
  std::string text = object.dump(2);
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 3) text.insert(at + 1, "  ");
  const std::size_t end = json.rfind("\n}");
  json.insert(end, ",\n  \"circle\": " + text);
}

std::optional<CircleRecord> circle_of(std::string_view json) {
  if (json.find("\"circle\"") == std::string_view::npos) return std::nullopt;
  const auto result = nlohmann::json::parse(json);
  const auto found = result.find("circle");
  if (found == result.end()) return std::nullopt;
  CircleRecord circle{(*found)["radius_m"], (*found)["feed_m_s"], {}};
  for (const Member& member : members) circle.error.*member.value = (*found)[member.name];
  return circle;
}

CircleError circle_error(const Filter& filter, const Task& task, double radius, double feed) {
  const FilterBehind behind(filter, task.machine, task.sample_period);
  if (!behind.differs()) return circle_error(behind.motion(), radius, feed, task.sample_period);
  const std::size_t second = std::min<std::size_t>(1, task.machine.axes.size() - 1);
  return circle_error(behind.motion(0), behind.motion(second), radius, feed, task.sample_period);
}

std::vector<std::string> check_circle(const CircleRecord& circle, const DesignResult& result) {
  if (!result.filter) return {"a circle is recorded without a filter"};
  std::vector<std::string> reasons;
  try {
    const CircleError found = circle_error(*result.filter, result.task, circle.radius, circle.feed);
    for (const Member& member : members) {
      const double recorded = circle.error.*member.value, right = found.*member.value;
      // A simulated distance is precise only to the rounding of positions.
      const double rounding =
          1e-9 * std::abs(right) + (member.value == &CircleError::deviation ? 0.0 : 1e-14 * circle.radius);
      if (!(std::abs(recorded - right) <= rounding))
        reasons.push_back(fmt::format("circle.{} is recorded as {:.12g}, found {:.12g}", member.name, recorded, right));
    }
  } catch (const std::invalid_argument& refused) {
    reasons.push_back(fmt::format("circle: {}", refused.what()));
  }
  return reasons;
}

}  // namespace accdec
