#pragma once

#include <string>

#include <accdec/plot/program_motion.hpp>
#include <accdec/plot/program_view.hpp>

namespace accdec {

/// One self-contained HTML page (no network, no library). It shows the motion coloured by its speed, with zoom by wheel
/// and drag. It shows the speed over time in the colour of the limit that binds there (the one used most, from 98 %
/// on), with the same zoom. It also shows the time lost compared with the programmed feed, by classes of corners. Every
/// sample counts for the classes and for the binding limits. For long motions, only every n-th point is drawn.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     as many axes as the path, or none
/// @param from        a program that only drills shows its depth over time, unless a view is asked for
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion,
                         ViewFrom from = ViewFrom::automatic);
/// The page of a plan. @param machine  the task's
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result,
                         ViewFrom from = ViewFrom::automatic);

}  // namespace accdec
