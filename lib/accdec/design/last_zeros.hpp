#pragma once

#include <vector>

#include <accdec/filter.hpp>
#include <accdec/task.hpp>

// Internal to the room.

namespace accdec {

/// A filter that holds a task, without the zero taps at its end that the limits do not need. A damped mode may need
/// them: it dies away until the filter's last tap. Symmetric taps lose both ends.
/// @param filter  with which, and these delays, all limits hold
Filter without_last_zeros(const Task& task, Filter filter, const std::vector<int>& delays);

}  // namespace accdec
