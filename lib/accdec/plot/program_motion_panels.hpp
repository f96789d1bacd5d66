#pragma once

#include <accdec/plot/figure.hpp>
#include <accdec/plot/program_motion.hpp>

namespace accdec {

// Internal to the room: panels of a figure that show how fast a program runs, and what keeps it from running faster.

/// The speed over time, mm/s over s, one series for each limit that binds somewhere and one for where none does. No
/// more points than can be seen, but every sample counts. Where rapid moves are more than twice as fast as the largest
/// programmed feed, the scale ends there and the title says how fast they are.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     as many axes as the path, or none
Panel speed_over_time_panel(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion);

/// The time lost by classes of corners, s: the classes that lose most as bars, the largest first.
Panel time_lost_panel(const Toolpath& programmed, const ProgramMotion& motion);

}  // namespace accdec
