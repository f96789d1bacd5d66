#pragma once

#include <accdec/plot/figure.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>

namespace accdec {

/// A planned program on a page, seen along the axis in which it is flattest: its corners in the colours of their errors
/// over their tolerances, on the path (of the joints inside arcs, which are no corners of the program, the title says
/// the worst); where there are many, the part with most of them enlarged; the path in the colours of the commanded
/// speed; and a histogram of the delays. Rapid moves are dashed.
///
/// Blocks shorter than a pixel are drawn as one with the lowest speed of theirs, corners that would hide each other as
/// the one with the largest error; a path too long even for that is drawn as a raster. So the figure of a million
/// blocks is no larger than that of some thousands.
Figure plot_program(const ProgramResult& result);
/// And two panels more: the speed over time, by the limit that binds, and the time lost by the largest classes of
/// corners.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     the task's
Figure plot_program(const ProgramResult& result, const Toolpath& programmed, const Machine& machine);
/// Of plan profiles, which has no commands: the corners, the path in the colours of the motion's speed, and these two.
Figure plot_program(const ProfileResult& result, const Toolpath& programmed, const Machine& machine);

}  // namespace accdec
