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
  bool in_time = true;                 ///< false: the exact method did not end, so nothing is known of its delays
  std::optional<DesignResult> design;  ///< simulated, every limit held; none: no filter found for its delays
  double violation = 0.0;              ///< relative, of its own taps at its delays
  std::string remark;
};

/// Largest relative violations of taps that are replaced by others. More than that is no tolerance of a solver. The
/// tangents of an MPS file alone allow 1 / cos(pi / 64) - 1 = 0.0012.
constexpr double replaced_violation = 1e-4, replaced_violation_of_tangents = 1.3e-3;
/// s for the exact method, if taps are replaced.
constexpr double judging_time_limit = 30.0;

/// Judges a point by simulation, with its delays and taps. Files with tangents instead of cones, and tolerances of
/// solvers, let taps break a limit slightly. Such taps are replaced: the exact method looks for others at the same
/// order and delays. Taps that break a limit by more are no answer.
/// @param task  of one order
/// @param x     a point of the choice, finite
/// @param most_violation  of taps that are replaced
/// @param seconds  for the exact method; none is left if not positive
DesignAnswer judged_design(const Task& task, const instances::Choice& choice, const std::vector<double>& x,
                           double most_violation, double seconds = judging_time_limit);

}  // namespace accdec::comparison
