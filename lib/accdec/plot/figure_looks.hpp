#pragma once

#include <cstddef>
#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/figure_style.hpp>

// Internal to this folder: looks of lines and symbols in gnuplot's words.

namespace accdec {

/// @param style  below 0 counts as 0
std::size_t style_index(int style);

const char* colour_of(const Series& s);
int symbol_of(const Series& s);
/// Colour, width and dashes.
std::string line_of(const Series& s);
std::string limit_line();
std::string circle_line();
std::string band_line(const char* colour = figure_style::band_colour);

/// How a legend shows what has a label: a line, a symbol, or both. The first with this label counts.
struct LegendSample {
  std::string line, point;
};
LegendSample sample_of(const Figure& figure, const std::string& label);

}  // namespace accdec
