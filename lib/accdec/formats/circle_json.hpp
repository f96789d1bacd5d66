#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/motion/circle.hpp>
#include <accdec/result.hpp>

namespace accdec {

/// The result of `evaluate` for a circle: the optional member `circle` of a result.
struct CircleRecord {
  double radius = 0.0, feed = 0.0;  ///< m, m/s
  CircleError error;
};

/// The effect of a designed filter behind the machine's response on a circle in the plane of the first two axes.
/// @throws as the other circle_error
CircleError circle_error(const Filter& filter, const Task& task, double radius, double feed);
/// @param json  from result_to_json; the member is added at its end
void add_circle(std::string& json, const CircleRecord& circle);
/// @param json  of a result that parse_result accepts
std::optional<CircleRecord> circle_of(std::string_view json);
/// Differences from the effect of the result's filter, as reasons to reject it; empty if all agrees.
std::vector<std::string> check_circle(const CircleRecord& circle, const DesignResult& result);

}  // namespace accdec
