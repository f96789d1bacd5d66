#pragma once

#include <functional>
#include <string>

#include <accdec/program.hpp>

namespace accdec {

/// Plan fixed: chooses the filter, plans and verifies what was read. The filter is the task's, the one in a program
/// that --emit wrote, or one designed for the program. If none holds, the result is failed and says why.
///
/// If arcs were read in finer chords than kept feeds need (see ProgramFileOptions), the program is also planned with
/// the longer chords. The faster plan is the answer: under long filters fine chords are no better, and kept feeds need
/// the longer ones. If the filter was designed for chosen feeds, the plan of kept feeds with its own filter is a
/// candidate, too: chosen feeds are never slower. With compensated arcs the program is first planned without
/// compensation. If that is faster, it is the answer, and ProgramResult::compensation says so.
/// @param file  its path is taken; its `reading` becomes that of the answer
/// @param tell  one line a step, may be empty
ProgramResult run_fixed_plan(ProgramFile file, const Task& task, const ProgramFileOptions& options,
                             const std::function<void(const std::string&)>& tell);

}  // namespace accdec
