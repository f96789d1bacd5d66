#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// How a control gives the delays of a command.
struct CommandDelays {
  std::vector<DelayKind> kinds;        ///< at the end of each block
  std::optional<WidthInterval> width;  ///< where a joint is in-position
  std::vector<int> delays;             ///< samples, one a block, with those that the width gives; else as they were
  std::string wrong;                   ///< the first joint whose delay cannot be had; empty: the control gives them all
};

/// More than the part of a duration by which whole samples may lower it (snap_durations, snap_runs).
inline constexpr double snapped_part = 1e-5;

/// Follows the command, so that feeds that change shortly before a joint count. A joint is in-position in the first
/// sample in which the filtered command is within the width of it. Its delay is longer by the control's latency.
/// @param delays  samples, one a block
CommandDelays command_delays(const Toolpath& path, const Filter& filter, double sample_period,
                             const std::vector<int>& delays);

/// Whether each corner that is passed without a delay, at a feed lowered beside it, has a part of both programmed feeds
/// that is a multiple of the control's step.
/// @param programmed  has the same corners at the programmed feeds  @param step  0: any part will do
bool corner_feeds_had(const Toolpath& path, const Toolpath& programmed, const std::vector<int>& delays, double step);

}  // namespace accdec
