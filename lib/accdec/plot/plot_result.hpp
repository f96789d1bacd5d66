#pragma once

#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/task/result.hpp>

namespace accdec {

/// One corner of a result: the path around the programmed corner with its error circle, enlarged and whole; velocity,
/// acceleration and every limited quantity of each moving axis from rest to rest, its limits and its worst sample; the
/// taps, and the frequency response with the mode bands. Motion is simulated from the result's taps and delay by plain
/// convolution.
/// @param corner  name; empty: the first
/// @throws std::invalid_argument if there is no such corner (naming those there are), std::runtime_error if the result
/// holds no filter.
Figure plot_result(const DesignResult& result, const std::string& corner = "");

}  // namespace accdec
