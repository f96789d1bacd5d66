#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <accdec/motion/least_held.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {

ControlDelays control_of(const ControllerSettings& settings, double width, double sample_period) {
  const auto latency = static_cast<int>(std::lround(settings.in_position_latency / sample_period));
  ControlDelays control{settings.delays, width, settings.in_position_by_axis, latency};
  if (control.names(DelayKind::corner_feed) && !control.names(DelayKind::continuous))
    control.kinds.push_back(DelayKind::continuous);
  return control;
}

ControlDelays control_of(const Task& task, double width) {
  return control_of(*task.settings, width, task.sample_period);
}

ControlDelays planned_control(const Task& task, double width) {
  ControlDelays control = control_of(task, width);
  if (!(width > 0.0) && control.kinds.size() > 1) std::erase(control.kinds, DelayKind::in_position);
  return control;
}

bool runs_on(const ControlDelays& control) {
  return !control.any() && !control.names(DelayKind::exact_stop) && !control.names(DelayKind::in_position);
}

bool waits_at_ends(const ControlDelays& control) {
  return !control.any() && !control.names(DelayKind::continuous);
}

void mark_waits(Toolpath& path, const ControlDelays& control) {
  if (!waits_at_ends(control)) return;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (!ends_leg(path, b) && path.inside_arc[b] == 0) path.joint[b] = Joint::corner;
  }
}

void give_control(Toolpath& path, const ControlDelays& control) {
  path.control = control;
  mark_waits(path, control);
}

bool limits_taps(const ControllerSettings& control) {
  return !control.names_family() && !control.any_delay();
}

bool has_settings(const ControllerSettings& control) {
  return control.names_family() || !control.delays.empty();
}

void require_planned_taps(const ControllerSettings& control) {
  if (control.names(SettingFamily::taps) && control.names_family())
    throw std::invalid_argument(
        "[design] family names \"taps\" beside others; a program is planned with \"taps\" alone or with the others");
}

double corner_feed_step_of(const std::optional<ControllerSettings>& settings) {
  return settings && settings->names(DelayKind::corner_feed) ? settings->corner_feed_step : 0.0;
}

double commanded_feed(const Toolpath& path, std::size_t b) {
  return path.length(b) / path.duration[b];
}

std::array<double, 2> corner_feed_whole(const Toolpath& path, std::size_t b) {
  std::array<double, 2> feeds{commanded_feed(path, b), commanded_feed(path, b + 1)};
  if (path.rapid[b] == path.rapid[b + 1]) return feeds;
  const std::size_t rapid = path.rapid[b] != 0 ? 0 : 1;
  feeds[rapid] = std::min(feeds[0], feeds[1]);
  return feeds;
}

double watched_part(const ControlDelays& control, const double* velocity, std::size_t axes, double speed) {
  if (!control.by_axis) return 1.0;
  double fastest = 0.0;
  for (std::size_t a = 0; a < axes; ++a) fastest = std::max(fastest, std::abs(velocity[a]));
  return fastest / speed;
}

std::optional<int> control_delay_after(const ControlDelays& control, const Filter& filter, int wait, int least) {
  if (control.any()) return least;
  if (least == 0 && control.names(DelayKind::continuous)) return 0;
  const int apart = exact_stop_delay(filter);
  std::optional<int> best;
  if (const int stop = std::max(least, apart); control.names(DelayKind::exact_stop) && stop <= apart + exact_stop_more)
    best = stop;
  if (wait < 0 || !control.names(DelayKind::in_position)) return best;
  const int delay = wait + control.latency;
  if (delay >= least && (!best || delay < *best)) best = delay;
  return best;
}

std::optional<int> control_delay(const ControlDelays& control, const Filter& filter, double step, int least) {
  constexpr int never = -1;
  if (control.any() || !control.names(DelayKind::in_position) || !(control.width > 0.0))
    return control_delay_after(control, filter, never, least);
  // The way left falls to 0.
  const int wait =
      least_held(-1, filter.order() + 1, [&](int k) { return step * filter.remaining_moment(k) <= control.width; });
  return control_delay_after(control, filter, wait, least);
}

}  // namespace accdec
