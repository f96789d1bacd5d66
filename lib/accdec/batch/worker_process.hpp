#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/batch/journal.hpp>

// Internal to this folder: run_points with children.

namespace accdec::batch {

/// As run_points. Children are forked from this process, get one index at a time (or only one, if fresh) and send back
/// one row; they die with their parent. A point that takes longer than kill_after(index) s, if > 0, ends: its child is
/// killed. Must not be called while other threads of this process run.
/// @throws std::runtime_error if the system has no more pipes or processes
void run_processes(const std::vector<std::size_t>& indices, const std::function<std::string(std::size_t)>& compute,
                   const std::function<std::string(std::size_t, const std::string&)>& lost,
                   const std::function<void(std::size_t, const Entry&)>& done, int workers,
                   const std::function<double(std::size_t)>& kill_after, bool fresh_children);

}  // namespace accdec::batch
