#pragma once

#include <optional>

#include <accdec/formats/json_value.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The bounds in a program's result, see corner_bound_to_json and bounds_to_json; none if it has none.
inline std::optional<CornerBound> recorded_corner_bound(const Value& json) {
  if (!json.has("corner_bound_s") || !json.has("corner_bound")) return {};
  const Value counts = json["corner_bound"];
  CornerBound bound;
  bound.time = json["corner_bound_s"].number();
  bound.corners = counts["corners"].integer<std::size_t>();
  bound.counted = counts["counted"].integer<std::size_t>();
  bound.classes = counts["classes"].integer<std::size_t>();
  bound.complete = counts["complete"].boolean();
  if (!json.has("bounds")) return bound;
  for (const Value& named : json["bounds"].elements()) {
    if (named["name"].text() != "any motion") continue;
    bound.any_motion = named["time_s"].number();
    if (named.has("complete")) bound.any_motion_complete = named["complete"].boolean();  // earlier results have none
  }
  return bound;
}

}  // namespace accdec
