#pragma once

#include <string>

#include <accdec/task.hpp>

namespace accdec {

/// A limit that is broken at constant feed with any filter, in words. Empty if none is surely broken. It uses interval
/// arithmetic and its own formulas, not those of `contradictions`, which claims such a limit.
std::string broken_at_constant_feed(const Task& task);

}  // namespace accdec
