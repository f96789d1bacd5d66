#pragma once

#include <array>

#include <accdec/plot/figure.hpp>

namespace accdec::figure_style {

// Style of figures, drawn by gnuplot, by the scripts of pages and by the explorer.

/// Colours of styles 0, 1, ... of series, repeated cyclically. With the white of the paper they are at least 31 apart
/// in CIE L*a*b*, also for people who see no red or no green. Two that differ by 2 can just be told apart side by side.
inline constexpr std::array<const char*, 8> colours{"#000000", "#0b5fa5", "#c8501e", "#021bd0",
                                                    "#ff9a00", "#57b8eb", "#4e442e", "#8a8a8a"};
/// Styles with a meaning: the design, the limit that binds, the filter of today, a thin line for what is given, the
/// speed along the path.
inline constexpr int design_style = 1, binding_style = 2, baseline_style = 7, thin_style = 16, speed_style = 22;
/// px on and off.
inline constexpr std::array<const char*, 8> dashes{"solid",  "(9,4)",          "(9,3,2,3)", "(2,3)",
                                                   "(16,4)", "(12,3,2,3,2,3)", "(4,2)",     "(1,4)"};
/// gnuplot's numbers of symbols.
inline constexpr std::array<int, 15> points{7, 6, 5, 4, 9, 8, 11, 12, 2, 13, 1, 10, 3, 15, 14};
/// px, of the first eight styles, the next eight, ...
inline constexpr std::array<const char*, 3> widths{"1.7", "2.8", "1"};
static_assert(dashes.size() * widths.size() == most_lines);

inline constexpr const char* limit_colour = "#771100";
inline constexpr const char* circle_colour = "#606060";
inline constexpr const char* band_colour = "#d4d4d4";
inline constexpr const char* disc_colour = "#ececec";

/// Light to dark, so that lightness alone shows the value. The lightest colour differs clearly from the paper, which
/// means no value.
inline constexpr const char* heat_palette = "0 '#e6bd72', 0.35 '#dd8a4a', 0.65 '#a9443a', 1 '#2b0f3a'";
/// Two colours that get darker away from 0; the colour at 0 also differs from the paper.
inline constexpr const char* signed_palette = "-1 '#123f73', -0.5 '#5f93c4', 0 '#d9d9d2', 0.5 '#d9824a', 1 '#7a1f1f'";
/// As for heat maps, but without colours so light that a line is hard to see: the contrast to the paper is 3 and more.
inline constexpr const char* line_palette = "0 '#c9862f', 0.35 '#b5523a', 0.65 '#7d2b41', 1 '#2b0f3a'";

}  // namespace accdec::figure_style
