#pragma once

#include <string>
#include <vector>

#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Relative violation up to which a limit counts as held.
inline constexpr double verification_tolerance = 1e-9;
/// Distances below this are rounding of the simulated position, m; a corner error below it is reported as 0.
inline constexpr double position_floor = 1e-12;

/// Checks a filter and delays against every limit of a task by brute simulation: the command stream rest, leg 1, gap of
/// d samples, leg 2, rest is sampled, convolved with the taps sample by sample, integrated and differenced, and
/// everything is read off the samples. Nothing of the blend formulas, of the formulations or of their tables is used.
/// O(axes N (N + d)) a corner.
/// @param delays   one per corner, >= 0
/// @param limits   when not null, receives the worst use of every limit: per corner and axis, corner errors, speeds,
/// vibration
/// @param corners  when not null, receives the measures of every corner
/// @throws std::invalid_argument if the number of delays or their sign is wrong.
VerificationReport verify_by_simulation(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                        std::vector<LimitUse>* limits = nullptr,
                                        std::vector<CornerResult>* corners = nullptr);

/// A result made of a filter and delays: simulated, measured, and `feasible` only if every limit holds. Otherwise
/// `failed`, with the worst limit in the message; the filter stays in the result only if `keep_broken` (evaluation of a
/// given filter).
DesignResult assess(const Task& task, const Filter& filter, const std::vector<int>& delays, bool keep_broken);

/// `accdec evaluate`: the task's own filter and delays.
/// @throws std::invalid_argument when the filter or a delay is left open.
DesignResult evaluate_task(const Task& task);

/// The value of a limit at the event and sample (or the frequency) that `use` names; not a number if there is no such
/// place.
/// @param delays  one per corner, >= 0
double value_where(const Task& task, const Filter& filter, const std::vector<int>& delays, const LimitUse& use);

/// "force x: 97.1 % at k = 12 of the stop, corner A".
std::string describe(const LimitUse& use);

}  // namespace accdec
