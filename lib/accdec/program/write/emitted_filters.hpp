#pragma once

#include <optional>
#include <string>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// The filter in remarks, "(filter taps: 27*0.037 ..)": equal taps in a row once, with their number; some a line, each
/// with a line feed.
std::string filter_remarks(const Filter& filter);

/// The filter in the remarks that emit_program wrote into a program; none if it has none or they make no filter.
std::optional<Filter> emitted_filter(const Toolpath& path);

/// The filters of its legs, `filter` stretched to the lengths in the remarks "(filter of 27 taps)"; none if it has
/// none, or where the path cannot change its filter.
std::optional<LegFilters> emitted_legs(const Toolpath& path, const Filter& filter);

}  // namespace accdec
