#pragma once

#include <atomic>
#include <optional>

#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// The best of a few standard shapes (boxcar, trapezoids, Hann, Blackman, with modes Kaiser, too) with the delays they
/// need, near the least order at which each holds the limits: what there is for tasks too large for every other method.
/// Verified; none if no shape holds or the time is up before one was verified.
/// @param seconds  polled between filters: one filter at 10^5 corners takes a fraction of a second
std::optional<DesignResult> best_shape(const Task& task, double seconds, const std::atomic<bool>* cancel = nullptr);

}  // namespace accdec
