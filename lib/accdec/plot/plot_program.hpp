#pragma once

#include <accdec/plot/figure.hpp>
#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// A planned program on a page: its path in the colours of the error at each corner over its tolerance (half of every
/// block has the colour of the joint at its end), seen along the axis in which it is flattest, and a histogram of the
/// delays.
///
/// Blocks shorter than a pixel are drawn as one with the largest error of theirs; a path too long even for that is
/// drawn as a raster, every cell in the colour of the largest error in it. So the figure of a million blocks is no
/// larger than that of some thousands.
Figure plot_program(const ProgramResult& result);

}  // namespace accdec
