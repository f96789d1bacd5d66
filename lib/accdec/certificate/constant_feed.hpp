#pragma once

#include <string>

#include <accdec/task/task.hpp>

namespace accdec {

/// A limit that is broken at constant feed already, whatever the filter, in words; empty if none surely is. In interval
/// arithmetic and of its own: what claims such a limit (`contradictions`) is not asked.
std::string broken_at_constant_feed(const Task& task);

}  // namespace accdec
