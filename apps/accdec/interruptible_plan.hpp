#pragma once

#include <accdec/program.hpp>

namespace accdec::cli {

/// A plan that the first Ctrl-C ends with the best one so far, such as plan free. A line on standard error then says
/// how far the search was. The second Ctrl-C ends the program.
ProgramResult interruptible_plan(const ProgramFileOptions& options, bool quiet, ProgramFile file, const Task& task);

}  // namespace accdec::cli
