#pragma once

#include <string>

#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// Whether a commanded path is the program's: every programmed point passed in order and on straight lines in between,
/// no feed above the programmed one, tolerances, joints and lines the same, every stop and dwell kept. Empty if so,
/// else what is not.
std::string departs_from(const Toolpath& commanded, const Toolpath& programmed);

}  // namespace accdec
