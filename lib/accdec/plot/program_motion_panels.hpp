#pragma once

#include <accdec/plot/figure.hpp>
#include <accdec/plot/program_motion.hpp>

namespace accdec {

// Internal to this folder: panels that show how fast a program runs, and what limits its speed.

/// The speed over time, mm/s over s. There is one series for each limit that binds somewhere, and one for places where
/// none does. It has no more points than visible, but every sample counts. If rapid moves are more than twice as fast
/// as the largest programmed feed, the scale ends there and the title gives their speed.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     as many axes as the path, or none
Panel speed_over_time_panel(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion);

/// A column of the path over time, mm over s: feed moves, and rapid moves dashed.
/// @param path  the one that the motion follows
Panel place_over_time_panel(const Toolpath& path, std::size_t column, const ProgramMotion& motion);

/// The time lost by classes of corners, s: the classes that lose most as bars, the largest first.
Panel time_lost_panel(const Toolpath& programmed, const ProgramMotion& motion);

}  // namespace accdec
