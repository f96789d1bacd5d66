#pragma once

#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Refuses what plans of one filter do not consider.
/// @param machine  of the program  @param filter_bound  see PlanningProblem
/// @throws RefusedKey  @throws std::invalid_argument for an option
void require_fixed(const Task& task, const Machine& machine, bool filter_bound);

/// Refuses what plans of positions, `profiles` and `free`, do not keep.
/// @param plan  "plan free"  @throws RefusedKey
void require_positions(const Task& task, const char* plan);

/// Refuses what `free` does not keep beside, of the axes that the path moves.  @throws RefusedKey
void require_free(const Task& task, const Toolpath& path);

}  // namespace accdec
