#pragma once

#include <cstddef>

#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// A task with a few corners that represents a program. The program's corners are grouped by angle, headings, feeds and
/// tolerance. Each of the most frequent classes is represented by one member with the weight of the class. For every
/// axis, the feed move that drives it fastest is added as a straight pass, so that starts and stops in the worst
/// directions count. Corners that differ only by the rounding of coordinates are merged. Passes covered by a corner's
/// own starts and stops are left out, because a single corner is designed in a hundredth of the time.
/// @param corners_max  classes kept, >= 1
Task representative_task(const Toolpath& path, const Task& task, std::size_t corners_max = 8);

}  // namespace accdec
