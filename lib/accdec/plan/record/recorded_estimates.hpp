#pragma once

#include <vector>

#include <accdec/formats/json_value.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// The controls of a result's estimates with their parameters; the rest follows from these and the program.
inline std::vector<ControlEstimate> recorded_estimates(const Value& json) {
  std::vector<ControlEstimate> estimates;
  for (const Value& one : json.elements()) {
    ControlEstimate& estimate = estimates.emplace_back();
    estimate.control = one["control"].text();
    for (const Value& p : one["parameters"].elements())
      estimate.parameters.push_back({p["name"].text(), p["unit"].text(), p["value"].number(), p["from"].text()});
  }
  return estimates;
}

}  // namespace accdec
