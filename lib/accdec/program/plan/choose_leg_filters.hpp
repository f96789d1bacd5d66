#pragma once

#include <accdec/machine/machine.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// For every leg the length of the filter's shape with which the program takes least time.
///
/// The shortest that may be taken starts and stops every block of the leg within the axis limits of its direction. A
/// longer one costs time where legs stand still between them, but overlaps more with its neighbours where the limits
/// would not let shorter ones. The sum of all delays, each the smallest of its pair of filters as if its corner were
/// alone, is made least by dynamic programming over the legs; long programs get fewer lengths to choose from, beyond
/// some hundred thousand legs the shortest only. Lengths that break a vibration bound, or have more taps than the
/// task's design.order_max + 1, are not taken.
/// @param order_max  of the filters
LegFilters choose_leg_filters(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                              int order_max);

}  // namespace accdec
