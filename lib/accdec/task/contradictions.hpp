#pragma once

#include <string>
#include <vector>

#include <accdec/task.hpp>

namespace accdec {

/// Limits that no filter of any order can hold. These are a feed above an axis velocity, friction above force or power
/// at feed, and a vibration band across a multiple of the sample rate. A smallest speed may also be above the feed, or
/// above what any filter keeps within the corner's error (corner_speed.hpp). One sentence each; empty when there is
/// none.
std::vector<std::string> contradictions(const Task& task);

}  // namespace accdec
