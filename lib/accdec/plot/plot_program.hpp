#pragma once

#include <accdec/plot/figure.hpp>
#include <accdec/plot/program_view.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// A planned program on a page, seen as `from` says. It shows the corners on the path, coloured by their errors over
/// their tolerances, and enlarges the part with most of them. (Joints inside arcs are no corners; the title gives the
/// worst of them.) It shows the path coloured by the commanded speed, for plan profiles by the motion's. A program that
/// only drills shows its depth over time. Plans with delays get a histogram of them.
/// Rapid moves are dashed.
///
/// Blocks shorter than a pixel are drawn as one, with their lowest speed. Corners that would hide each other are drawn
/// as the one with the largest error. A path that is still too long is drawn as a raster. So the figure of a million
/// blocks is no larger than that of some thousands.
Figure plot_program(const ProgramResult& result, ViewFrom from = ViewFrom::automatic);
/// The same with two more panels: the speed over time, by the limit that binds, and the time lost by the largest
/// classes of corners.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     the task's
Figure plot_program(const ProgramResult& result, const Toolpath& programmed, const Machine& machine,
                    ViewFrom from = ViewFrom::automatic);

}  // namespace accdec
