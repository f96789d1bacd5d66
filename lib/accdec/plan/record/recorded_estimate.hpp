#pragma once

#include <accdec/formats/json_value.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The settings of an estimate of another control, as a program's result has them: the rest of it follows.
inline ControlEstimate recorded_estimate(const Value& json) {
  ControlEstimate estimate;
  estimate.control = json["control"].text();
  for (const Value& one : json["parameters"].elements())
    estimate.parameters.push_back({one["name"].text(), one["unit"].text(), one["value"].number(), one["from"].text()});
  return estimate;
}

}  // namespace accdec
