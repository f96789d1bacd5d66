#pragma once

#include <string>

#include <accdec/plot/program_motion.hpp>

namespace accdec {

/// One HTML page that stands alone (no network, no library): the motion coloured by its speed, to zoom into by wheel
/// and drag; the speed over time in the colour of the limit that binds there (the one most used, from 98 % on), with
/// the same zoom; and the time lost against the programmed feed by classes of corners. Every sample counts for the
/// classes and for which limit binds; of long motions only every n-th point is drawn.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     as many axes as the path, or none
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramMotion& motion);
/// The page of a plan. @param machine  the task's
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result);
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProfileResult& result);

}  // namespace accdec
