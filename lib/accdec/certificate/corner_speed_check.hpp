#pragma once

#include <string>

#include <accdec/task/task.hpp>

namespace accdec {

/// A corner whose smallest speed no filter keeps within its error, in words; empty if none surely is. In interval
/// arithmetic and of its own: what claims it (task/corner_speed.hpp, which says why) is not asked.
std::string too_fast_for_its_error(const Task& task);

}  // namespace accdec
