#pragma once

#include <optional>
#include <string>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The filter as remarks, "(filter taps: 27*0.037 ..)". Equal taps in a row are written once, with their number; a few
/// per line, each line with a line feed.
std::string filter_remarks(const Filter& filter);

/// The filter in the remarks that emit_program wrote into a program; none if it has none or they make no filter.
std::optional<Filter> emitted_filter(const Toolpath& path);

}  // namespace accdec
