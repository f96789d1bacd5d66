#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/instances/instance.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec::comparison {

/// The outcome of an answer to the whole choice of taps and delays.
struct DesignAnswer {
  bool whole = false;                  ///< its delays are whole numbers within 1e-3
  std::optional<DesignResult> design;  ///< simulated, every limit held; none: no filter found for its delays
  double violation = 0.0;              ///< relative, of its own taps at its delays
  std::string remark;
};

/// Judges a point by simulation, with its delays and taps. Files with tangents instead of cones, and tolerances of
/// solvers, let taps break a limit slightly. So taps that do not hold are replaced: the exact method looks for others
/// at the same order and delays. The delays are the answer.
/// @param task  of one order
/// @param x     a point of the choice, finite
/// @param seconds  for the exact method
DesignAnswer judged_design(const Task& task, const instances::Choice& choice, const std::vector<double>& x,
                           double seconds = 30.0);

}  // namespace accdec::comparison
