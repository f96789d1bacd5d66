#pragma once

#include <atomic>
#include <optional>

#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The best of a few standard shapes with the delays they need, near the least order at which each holds the limits.
/// The shapes are boxcar, trapezoids, Hann and Blackman, and with modes also Kaiser. This is for tasks that are too
/// large for every other method. The result is verified. None if no shape holds, or the time is up before one was
/// verified.
/// @param seconds  polled between filters: one filter at 10^5 corners takes a fraction of a second
std::optional<DesignResult> best_standard_shape(const Task& task, double seconds,
                                                const std::atomic<bool>* cancel = nullptr);

}  // namespace accdec
