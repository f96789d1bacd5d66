#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/command/slow_blocks.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/feeds/curve_feeds.hpp>
#include <accdec/plan/filters/pairwise_times.hpp>
#include <accdec/simulate/command_stream.hpp>

namespace accdec {
namespace {

// Work, s, as measured on programs of 200 to 9000 blocks. It differs by a factor of two or so.

double work_of_pairs(const Toolpath& path) {
  return 2e-5 + 6e-7 * static_cast<double>(path.blocks());
}
double work_of_curves(const Toolpath& path, const Filter& filter) {
  return 1e-7 * static_cast<double>(path.blocks()) * (filter.order() + 3.0);
}

bool delays_curves(const Toolpath& path, const std::vector<int>& delays) {
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (!ends_leg(path, b) && delays[b] > 0) return true;
  }
  return false;
}

double seconds(const std::vector<double>& durations) {
  return std::accumulate(durations.begin(), durations.end(), 0.0);
}

/// Durations at the feeds inside legs that need no delay; empty: too many joints.
std::vector<double> slowed(const Toolpath& path, const Filter& filter, double period, const Machine& machine,
                           const std::vector<int>& delays, Effort& effort) {
  constexpr std::size_t most = 300'000;  // joints
  effort.spend(work_of_curves(path, filter));
  return curve_feeds(path, FilterBehind(filter, machine, period), period, delays, path.duration, most).duration;
}

}  // namespace

double sample_way(const Toolpath& path, std::size_t b, double sample_period, bool by_axis) {
  double longest = 0.0;
  for (std::size_t a = 0; a < path.dimensions(); ++a)
    longest = std::max(longest, std::abs(path.point(b + 1)[a] - path.point(b)[a]));
  return (by_axis ? longest : path.length(b)) / path.duration[b] * sample_period;
}

PairwiseTimes::PairwiseTimes(Toolpath path, const Filter& filter, double sample_period, const Machine& machine,
                             Effort& effort, bool slow_curves)
    : filter_(filter) {
  ready_feeds(path, filter, sample_period, machine);
  PairwiseDelays delays = pairwise_delays(path, filter, sample_period, machine);
  effort.spend(work_of_pairs(path));
  curves_delayed_ = delays_curves(path, delays.delays);
  if (slow_curves && curves_delayed_) {
    std::vector<double> slow = slowed(path, filter, sample_period, machine, delays.delays, effort);
    if (!slow.empty()) {
      path.duration = std::move(slow);
      delays = pairwise_delays(path, filter, sample_period, machine);
    }
  }
  if (!delays.limits_possible) {
    const double before = seconds(path.duration);
    limit_feeds(path, filter, sample_period, machine, delays, true, effort.clock());
    by_limits_ = (seconds(path.duration) - before) / sample_period;
  }
  const CommandTiming timing(path, sample_period, delays.delays);
  any_ = static_cast<double>(timing.command_samples() + filter.order() + 1);
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const bool inside = !ends_leg(path, b);
    if (inside) on_curves_ += delays.delays[b];
    if ((inside && delays.delays[b] == 0) || path.joint[b] == Joint::stop) continue;
    joints_.push_back(
        {sample_way(path, b, sample_period, false), sample_way(path, b, sample_period, true), delays.delays[b]});
  }
}

double PairwiseTimes::with(const ControlDelays& control) const {
  double samples = any_;
  for (const Held& joint : joints_) {
    const double step = control.by_axis ? joint.step_of_axis : joint.step;
    const auto delay = control_delay(control, filter_, step, joint.delay);
    if (!delay) return unlimited;
    samples += *delay - joint.delay;
  }
  return samples;
}

double lost_on_curves(Toolpath path, const Filter& filter, double sample_period, const Machine& machine,
                      Effort& effort) {
  ready_feeds(path, filter, sample_period, machine);
  const PairwiseDelays delays = pairwise_delays(path, filter, sample_period, machine);
  effort.spend(work_of_pairs(path));
  const std::vector<double> slow = slowed(path, filter, sample_period, machine, delays.delays, effort);
  if (slow.empty()) return unlimited;
  return (seconds(slow) - seconds(path.duration)) / sample_period;
}

double KnownBySpread::at(double spread, const std::function<double()>& find) {
  constexpr double apart = 1.05;
  const auto above = known_.lower_bound(spread);
  if (above != known_.end() && above->first == spread) return above->second;
  if (above != known_.end() && above != known_.begin()) {
    const auto below = std::prev(above);
    if (above->first <= apart * below->first)
      return std::lerp(below->second, above->second, (spread - below->first) / (above->first - below->first));
  }
  return known_[spread] = find();
}

}  // namespace accdec
