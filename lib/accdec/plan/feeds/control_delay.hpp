#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The delays that a control has for a program. A corner feed is there a feed of the blocks beside a corner, which the
/// planner chooses (Feeds::choose) and --emit writes as F words. Such a control does the same at a lower feed
/// as at the whole feed: DelayKind::continuous.
ControlDelays control_of(const ControllerSettings& settings, double width, double sample_period);
/// The same, of a task with settings.
ControlDelays control_of(const Task& task, double width);
/// The same for a plan. Without a width a control that has other kinds of delays plans as one without "in-position".
ControlDelays planned_control(const Task& task, double width);

/// Whether the control runs on at every corner: only lower feeds hold a tolerance.
bool runs_on(const ControlDelays& control);

/// Whether the control waits at the end of every block, with a turn or without: it has no kind that runs on. A block
/// then has one feed, as each step of it would end a block.
bool waits_at_ends(const ControlDelays& control);
/// The ends of blocks at which such a control waits, as corners. Points inside arcs are no ends.
/// @param path  as it was read
void mark_waits(Toolpath& path, const ControlDelays& control);
/// The same, and its delays for the path.
void give_control(Toolpath& path, const ControlDelays& control);

/// Whether a control of free taps has only some delays.
bool limits_taps(const ControllerSettings& control);
/// Whether a program's answer is what to set and the kind of each delay.
bool has_settings(const ControllerSettings& control);

/// @throws std::invalid_argument for free taps beside other families
void require_planned_taps(const ControllerSettings& control);

/// The part of both feeds of whose multiples corner feeds are; 0 if the control has none.
double corner_feed_step_of(const std::optional<ControllerSettings>& settings);

/// The feed of block b, m/s.
double commanded_feed(const Toolpath& path, std::size_t b);

/// The feeds, m/s, of whose multiples corner feeds before and behind the end of block b are: those of the path. A rapid
/// move beside a feed move has no more than that one's.
std::array<double, 2> corner_feed_whole(const Toolpath& path, std::size_t b);

/// The part of a leg's speed that a control compares with its in-position width: all, or that of the fastest axis.
double watched_part(const ControlDelays& control, const double* velocity, std::size_t axes, double speed);

/// The shortest delay of at least `least` samples that a control can give a corner that is reached at a constant feed.
/// None if it has none as long.
/// @param step  v1 T, m; of the fastest axis where the control watches each axis, see watched_part
std::optional<int> control_delay(const ControlDelays& control, const Filter& filter, double step, int least);
/// The same where the motion is within the in-position width after so many samples. The control's latency is added.
/// @param wait  negative: never
std::optional<int> control_delay_after(const ControlDelays& control, const Filter& filter, int wait, int least);

}  // namespace accdec
