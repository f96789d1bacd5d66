#pragma once

#include <functional>
#include <string>

#include <accdec/files.hpp>
#include <accdec/plan/filters/design_program_filter.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Whether the program has limits that the design of its filter knows only in part: ratings of drives, a contour, or
/// servos that differ. A standard shape may then be faster than the design.
bool needs_standard_shapes(const Toolpath& path, const Task& task);

/// The fastest of the standard shapes that hold: Hann filters and two averages, which may be equal or one of them. Each
/// is judged by a plan of the program with its feeds lowered until the drives are cool. First come Hann filters of 30
/// ms, then longer and shorter ones by factors of 1.5, then averages of the same variance, then smaller steps. The work
/// is limited by simulated samples, so that the answer is the same on every machine.
/// @param keep      at the programmed feeds; else feeds are chosen
/// @param deadline  may end the search sooner
/// @returns without a filter if none holds
ProgramFilter fastest_standard_shape(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline,
                                     const std::function<void(const std::string&)>& tell);

}  // namespace accdec
