#pragma once

#include <string>

#include <accdec/task.hpp>

namespace accdec {

/// A corner whose smallest speed no filter keeps within its error, in words. Empty if there is surely no such corner.
/// It uses interval arithmetic and its own formulas, not those of task/corner_speed.hpp, which makes the claim and
/// explains it.
std::string too_fast_for_its_error(const Task& task);

}  // namespace accdec
