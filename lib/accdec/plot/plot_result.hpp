#pragma once

#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/result.hpp>

namespace accdec {

/// One corner of a result. It shows the path where it leaves the programmed corner, with its error and tolerance, and
/// the distance from the legs over time. For each moving axis, as long as anything moves, it shows velocity,
/// acceleration and every limited quantity, with its limits and every sample that binds, or else the worst. The path's
/// speed and the power of all axes are shown where they are limited. It also shows the taps, and the frequency response
/// with the mode bands. Motion is simulated from the result's taps and delay by plain convolution. The task's filter of
/// today
/// ([baseline]) is drawn in grey in every panel, with its smallest delays, if it holds the limits. The title says what
/// the design saves against it. Behind a servo, steady parts of the legs are left out, and the title says so.
/// @param corner  name; empty: the first
/// @throws std::invalid_argument if there is no such corner (naming those there are), std::runtime_error if the result
/// holds no filter.
Figure plot_result(const DesignResult& result, const std::string& corner = "");

}  // namespace accdec
