#pragma once

#include <accdec/program.hpp>

namespace accdec {

/// Those asked for. A control that waits at the end of every block has one feed a block.
Feeds feeds_of(const Task& task, Feeds asked);

/// A program with today's setting of its task's control.
struct TodaysTime {
  double time = unlimited;  ///< s; unlimited: no plan with it holds
  bool cut = false;         ///< a clock ended the planning
};

/// Plans the program as with any setting. The same on every machine unless a clock ends it.
/// @param path   as it was read  @param task  with settings, and with a setting of today, see todays_filter
/// @param feeds  see feeds_of
/// @param width, plan  end the search for an in-position width, and the plan
TodaysTime todays_time(Toolpath path, const Task& task, Feeds feeds, const Deadline& width, const Deadline& plan);

}  // namespace accdec
