#pragma once

#include <string>
#include <vector>

#include <accdec/task/task.hpp>

namespace accdec {

/// Limits that no filter can hold, whatever its order: feed above an axis velocity, friction above force or power at
/// feed, a smallest speed above the feed or above what any filter keeps
/// within the corner's error (corner_speed.hpp), a vibration band across a multiple of the sample rate. One sentence
/// each; empty when there is none.
std::vector<std::string> contradictions(const Task& task);

}  // namespace accdec
