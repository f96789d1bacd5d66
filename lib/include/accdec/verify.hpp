// Verification of designs by simulation, and what counts as held.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/result.hpp>
#include <accdec/task.hpp>

// The one rule for what counts as held. Evaluation, verification, designs, delays of given filters and proofs go by it.

namespace accdec {

/// Relative violation up to which a limit counts as held.
inline constexpr double verification_tolerance = 1e-9;
/// Distances below this are rounding of the simulated position, m; a corner error below it is reported as 0.
inline constexpr double position_floor = 1e-12;

/// Whether a limit with this simulated use (LimitUse::utilisation) counts as held.
inline bool granted(double utilisation) {
  return utilisation <= 1.0 + verification_tolerance;
}

/// A corner error as it is judged and reported.
inline double judged_distance(double distance) {
  return distance < position_floor ? 0.0 : distance;
}

/// Relative part by which a proof widens limits: the verification's tolerance, and the same again for the rounding of
/// its simulation.
inline constexpr double granted_tolerance = 2.0 * verification_tolerance;

/// The task with limits so wide that every design the verification accepts holds them exactly. The claims "nothing is
/// shorter" and "there is no design" are proved for this task. Every limit is wider by `granted_tolerance`. Corner
/// errors are at least `position_floor` and residuals at least 1e-12, below which a simulation sees only rounding.
Task granted_limits(Task task);

/// A bound on a corner error, m, widened as by `granted_limits`.
double granted_error(double error_max);

/// The verdict of a formula on a limit. It rounds in another way than the simulation.
enum class Verdict {
  held,
  broken,
  close  ///< rounding may decide; only the simulation can say
};
inline Verdict verdict_by_formula(double utilisation) {
  if (utilisation <= 1.0 + 0.5 * verification_tolerance) return Verdict::held;
  return utilisation <= 1.0 + granted_tolerance ? Verdict::close : Verdict::broken;
}

/// Checks a filter and delays against every limit of a task by plain simulation. The command stream is rest, leg 1, gap
/// of d samples, leg 2, rest. It is convolved with the taps sample by sample, integrated and differenced, and all
/// values are read off the samples. It uses no blend formulas, no formulations and none of their tables. O(axes N (N +
/// d)) a corner.
/// With DelayKind::corner_feed the command is lowered before the corner and raised behind it.
/// @param delays   one per corner, >= 0
/// @param limits   when not null, receives the worst use of every limit: per corner and axis, corner errors, speeds,
/// vibration
/// @param corners  when not null, receives the measures of every corner
/// @param parts    one per corner, of the feed at which it is passed, > 0, <= 1; empty: 1
/// @throws std::invalid_argument if the number of delays or parts, or their sign, is wrong.
VerificationReport verify_by_simulation(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                        std::vector<LimitUse>* limits = nullptr,
                                        std::vector<CornerResult>* corners = nullptr,
                                        const std::vector<double>& parts = {});

/// One corner of a task, with all limits in which its delay has a part.
Task corner_alone(const Task& task, const TaskCorner& corner);

/// A result made of a filter and delays: simulated, measured, and `feasible` only if every limit holds. Otherwise it is
/// `failed`, with the worst limit in the message. It keeps the filter then only if `keep_broken` (evaluation of a given
/// filter).
/// @param parts  as above
DesignResult assess(const Task& task, const Filter& filter, const std::vector<int>& delays, bool keep_broken,
                    const std::vector<double>& parts = {});

/// `accdec evaluate`: the task's own filter and delays.
/// @throws std::invalid_argument when the filter or a delay is left open.
DesignResult evaluate_task(const Task& task);

/// The value of a limit at the event and sample (or the frequency) that `use` names; not a number if there is no such
/// place.
/// @param delays  one per corner, >= 0
/// @param parts   as above
double value_where(const Task& task, const Filter& filter, const std::vector<int>& delays, const LimitUse& use,
                   const std::vector<double>& parts = {});

/// "force x: 97.1 % at k = 12 of the stop, corner A".
std::string describe(const LimitUse& use);

/// Outcome of an independent recheck of a stored result.
struct ResultCheck {
  bool accepted = false;
  std::vector<std::string> reasons;  ///< reasons for rejecting it; empty when accepted
  VerificationReport verification;   ///< of the simulation run now
  std::string proof;                 ///< the part of the lower bound that was checked, in words; empty without one
};

/// Rechecks a result using only its task, taps and delays. It checks every limit by simulation, and compares every
/// recorded number with the one found now (relative 1e-9). It checks order and symmetry against the task's bounds, and
/// given filter and delays against those used. It checks the proof behind `optimal` or a lower bound. Status, stop,
/// bound, gap and certificate must not contradict each other. At the event and sample (or the frequency) that a limit
/// names, its use must be the largest. An infeasible result must not carry any bound, gap, filter, corner, limit, time
/// or finding. Not recomputed are `message`, `solver` and the reason why the search of a design ended.
/// @param stop  polled while a proof is checked; true rejects it
ResultCheck verify_result(const DesignResult& result, const std::function<bool()>& stop = {});

}  // namespace accdec
