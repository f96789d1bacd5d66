#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// Checks the claim "smallest delays of a given filter": at every corner whose delay the task leaves open, each smaller
/// delay breaks a limit. Each leg is simulated once by plain convolution; the motion for any delay is then their
/// shifted sum. It shares no code with the search. Ranges of delays with too large an error are refuted at once, in
/// about O(N log N) per corner. Delays at which another limit breaks are tried one by one, O(axes N) each.
/// @param delays  the delays claimed to be smallest, one per corner
/// @param stop    polled; true ends the check with "not checked in time"
/// @return empty when the claim holds, otherwise the reason it does not.
std::string check_smallest_delays(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                  const std::function<bool()>& stop = {});

/// Checks that no delays work with a filter: it rings more than a mode allows, or one corner breaks a limit at every
/// allowed delay. If no leg breaks a limit by itself, every delay is simulated, O(axes N^2) per corner.
/// @param stop  polled; true ends the check with "not checked in time"
/// @return empty when the claim holds, otherwise the reason it does not.
std::string check_no_delays(const Task& task, const Filter& filter, const std::function<bool()>& stop = {});

}  // namespace accdec
