#pragma once

#include <accdec/filter.hpp>

namespace accdec {

/// Smallest d >= 0 with which the path through the samples passes a single joint within `error_max`. The polyline error
/// never grows with d.
/// @param cos_interior       cos(theta), see Corner
/// @param step_in, step_out  full-speed steps v T of both legs, m
int smallest_path_delay(const Filter& filter, double cos_interior, double step_in, double step_out, double error_max,
                        int stop_delay);

}  // namespace accdec
