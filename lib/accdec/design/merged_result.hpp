#pragma once

#include <optional>

#include <accdec/result.hpp>
#include <accdec/task/equal_corners.hpp>

// Internal to the room.

namespace accdec {

/// The result of a merged task as a result of the whole task; none if rounding makes a difference.
std::optional<DesignResult> of_whole_task(const Task& task, const MergedTask& merged, const DesignResult& found);

}  // namespace accdec
