#pragma once

#include <functional>
#include <optional>

#include <accdec/result.hpp>
#include <accdec/task.hpp>

// Internal to the room: bounds and designs in front of the control's own smoothing, by the exact method, which knows
// filters without it.

namespace accdec {

/// The task of the filter and the smoothing as one filter; the task itself without smoothing. Limits and tolerances are
/// those of that filter's taps, which may be any.
Task filter_with_smoothing(const Task& task);

/// A proof of that task as one of the task itself, whose filters are shorter by the order of the smoothing.
DesignResult without_smoothing(const Task& task, DesignResult found);

/// The design of a filter in front of the smoothing, with the smallest delays. Empty if some limit does not hold.
std::optional<DesignResult> in_front_of_smoothing(const Task& task, const Filter& filter,
                                                  const std::function<bool()>& stop);

}  // namespace accdec
