#pragma once

#include <vector>

#include <accdec/task.hpp>

namespace accdec::attack {

enum class Verdict { no, yes, undecided };

/// Whether filters of this order hold every limit of the task with these delays. It enumerates the samples at which
/// corners are nearest, adds cuts, and splits speeds and directions for the limits that are not convex. An answer that
/// changes within a relative 1e-6 of the bounds is undecided (1e-4 if a vibration bound holds over a band, which is
/// sampled here).
Verdict exists(const Task& task, int order, const std::vector<int>& delays);

/// Whether any order and delays of the task's give a shorter time than this many weighted samples.
Verdict shorter_exists(const Task& task, double samples);

/// The task's objective, in sample periods.
double cost(const Task& task, int order, const std::vector<int>& delays);

}  // namespace accdec::attack
