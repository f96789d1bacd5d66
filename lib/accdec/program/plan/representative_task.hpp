#pragma once

#include <cstddef>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// A task with a handful of corners that stands for a program: its corners gathered by angle, headings, feeds and
/// tolerance, the most frequent classes represented by one of their members with the weight of the class; and, for
/// every axis, the feed move that drives it fastest as a straight pass, so that starts and stops in the worst
/// directions count.
/// Corners that differ by the rounding of coordinates are one, and passes that a corner's own starts and stops cover
/// are left out: a lone corner is designed in a hundredth of the time.
/// @param corners_max  classes kept, >= 1
Task representative_task(const Toolpath& path, const Task& task, std::size_t corners_max = 8);

}  // namespace accdec
