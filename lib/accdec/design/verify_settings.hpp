#pragma once

#include <string>
#include <vector>

#include <accdec/result.hpp>

namespace accdec {

/// Checks that a filter is one of the task's families, and the one that the values to enter make.
void compare_setting(const Task& task, const ChosenSettings& chosen, const Filter& filter,
                     std::vector<std::string>& reasons);

/// Checks that a result's settings are what its taps and delays are, and what its task's controller can be set to.
/// Members are built, and remaining ways summed, by the code of the proof's checker and not the search's.
void compare_settings(const DesignResult& result, std::vector<std::string>& reasons);

}  // namespace accdec
