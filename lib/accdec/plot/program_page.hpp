#pragma once

#include <functional>
#include <string>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec {

/// What a page shows of a planned program.
struct PageMotion {
  std::string title;
  double sample_period = 0.0;                         ///< s
  std::function<void(const SampleVisitor&)> samples;  ///< calls the visitor for every sample in order
};

/// One HTML page that stands alone (no network, no library): the motion coloured by its speed, to zoom into by wheel
/// and drag; the speed over time in the colour of the limit that binds there (the one most used, from 98 % on), with
/// the same zoom; and the time lost against the programmed feed by classes of corners. Every sample counts for the
/// classes and for which limit binds; of long motions only every n-th point is drawn.
/// @param programmed  the path as the program has it, before a plan changed its feeds
/// @param machine     as many axes as the path, or none
std::string program_page(const Toolpath& programmed, const Machine& machine, const PageMotion& motion);
/// The page of a plan. @param machine  the task's
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result);
std::string program_page(const Toolpath& programmed, const Machine& machine, const ProfileResult& result);

/// Time lost at corners that turn by `turn_from` to `turn_to` degrees, or at stops.
struct CornerLoss {
  double turn_from = 0.0, turn_to = 0.0;
  bool stop = false;
  long count = 0;
  double time = 0.0;  ///< s: of every sample the part by which it is slower than the feed, at the joint nearer to it
};
std::vector<CornerLoss> time_lost(const Toolpath& programmed, const PageMotion& motion);

}  // namespace accdec
