#pragma once

#include <string>
#include <string_view>

#include <accdec/plot/figure.hpp>

// Internal to this folder: the parts of every page.

namespace accdec {

extern const std::string_view html_style;   ///< CSS
extern const std::string_view html_script;  ///< JavaScript
/// JavaScript of a program's page: draws the arrays D into #path and #speed, and tells what is under the pointer.
extern const std::string_view program_script;

/// Figures with more points show no values: a page must stay small.
inline constexpr std::size_t most_hover_points = 50'000;

/// The title of a figure, the boxes of its panels, and the places, ranges and points of the panels, as JSON that may
/// stand inside <script>. A figure of too many points has boxes only. Numbers are written so that they read back to
/// the bit. In html_hover.cpp.
std::string hover_json(const Figure& figure);

}  // namespace accdec
