#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// Checks the proof behind "smallest delays of a given filter": that at every corner whose delay the task leaves open,
/// each smaller delay breaks a limit. The two legs are simulated once, apart from each other, by plain convolution;
/// every delay is then their sum, shifted. Shares nothing with the search. Ranges of delays whose error is too large
/// are refuted at once, about O(N log N) a corner; those at which another limit breaks are tried one by one, O(axes N)
/// each.
/// @param delays  the delays claimed to be smallest, one per corner
/// @param stop    polled; true ends the check with "not checked in time"
/// @return empty when the claim holds, otherwise the reason it does not.
std::string check_smallest_delays(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                  const std::function<bool()>& stop = {});

/// Checks that a filter has no delays: that it rings more than a mode allows, or that one corner breaks a limit at
/// every delay it may have. Where a leg by itself does not break one, every delay is simulated, O(axes N^2) a corner.
/// @param stop  polled; true ends the check with "not checked in time"
/// @return empty when the claim holds, otherwise the reason it does not.
std::string check_no_delays(const Task& task, const Filter& filter, const std::function<bool()>& stop = {});

}  // namespace accdec
