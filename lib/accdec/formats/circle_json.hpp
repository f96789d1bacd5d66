#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/motion/circle.hpp>
#include <accdec/task/result.hpp>

namespace accdec {

/// What `evaluate` found of a circle: the optional member `circle` of a result.
struct CircleRecord {
  double radius = 0.0, feed = 0.0;  ///< m, m/s
  CircleError error;
};

/// @param json  of result_to_json; the member becomes its last
void add_circle(std::string& json, const CircleRecord& circle);
/// @param json  of a result that parse_result takes
std::optional<CircleRecord> circle_of(std::string_view json);
/// What differs from what the result's filter does, as reasons to reject it; none where all agrees.
std::vector<std::string> check_circle(const CircleRecord& circle, const DesignResult& result);

}  // namespace accdec
