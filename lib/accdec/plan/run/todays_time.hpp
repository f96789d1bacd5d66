#pragma once

#include <string>
#include <vector>

#include <accdec/program.hpp>

namespace accdec {

/// Those asked for. A control that waits at the end of every block has one feed a block.
Feeds feeds_of(const Task& task, Feeds asked);

/// "jerk x in line 3": what the block slowed most breaks at its programmed feed; empty if none is slowed for a limit.
std::string breaks_at_feed(const std::vector<SlowedFeeds>& too_fast);

/// A program with today's setting of its task's control.
struct TodaysTime {
  double time = unlimited;  ///< s; unlimited: no plan with it holds
  std::string breaks{};     ///< "jerk x in line 3": what it breaks at programmed feeds that are to be kept
  bool cut = false;         ///< a clock ended the planning
};

/// Plans the program as with any setting. Feeds that are to be kept are what a setting is held to: a plan that lowers
/// them for a limit is none with it. The same on every machine unless a clock ends it.
/// @param path   as it was read  @param task  with settings, and with a setting of today, see todays_filter
/// @param asked  for the feeds
/// @param width, plan  end the search for an in-position width, and the plan
TodaysTime todays_time(Toolpath path, const Task& task, Feeds asked, const Deadline& width, const Deadline& plan);

}  // namespace accdec
