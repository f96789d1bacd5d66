#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/machine/blend_behind.hpp>
#include <accdec/motion/least_held.hpp>
#include <accdec/plan/delays/joint_delays.hpp>
#include <accdec/plan/delays/path_delay.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {

JointDelays::JointDelays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine)
    : path_(path),
      filter_(filter),
      behind_(filter, machine, sample_period),
      period_(sample_period),
      limits_(filter, machine, sample_period),
      finder_(behind_.motion()),
      known_(path.blocks()) {
  const Filter& motion = behind_.motion();
  // Half the mean absolute deviation of the taps: a smooth joint passed without delay errs by it times |v2 u2 - v1 u1|
  // T at most.
  for (int i = 0; i <= motion.order(); ++i) spread_ += motion.tap(i) * std::max(0.0, i - motion.mean_delay());
}

void JointDelays::load(std::size_t block, double factor, std::array<double, program_axis_count>& velocity,
                       double& speed) const {
  const std::size_t n = path_.dimensions();
  const double* p = path_.point(block);
  const double scale = factor / path_.duration[block];
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    velocity[i] = (p[n + i] - p[i]) * scale;
    sum += velocity[i] * velocity[i];
  }
  speed = std::sqrt(sum);
}

double JointDelays::cos_interior() const {
  double dot = 0.0;
  for (std::size_t i = 0; i < path_.dimensions(); ++i) dot += in_[i] * out_[i];
  return std::clamp(-dot / (speed_in_ * speed_out_), -1.0, 1.0);
}

template <class Compute>
int JointDelays::known(double number, bool stop, const Compute& compute) {
  const auto n = static_cast<std::ptrdiff_t>(path_.dimensions());
  KnownCorners<Delay>::Key key{number, stop ? 1.0 : 0.0};
  const auto end = std::copy_n(out_.begin(), n, std::copy_n(in_.begin(), n, key.data() + 2));
  const Delay delay = known_.get({key.data(), end}, [&] {
    const bool before = std::exchange(possible_, true);
    const int samples = compute();
    return Delay{samples, std::exchange(possible_, before)};
  });
  possible_ = possible_ && delay.possible;
  return delay.samples;
}

int JointDelays::within_limits(int delay, bool stop) {
  return limits_.any() ? limits_.smallest(in_.data(), out_.data(), delay, possible_, stop) : delay;
}

Corner JointDelays::loaded() const {
  const auto n = static_cast<Eigen::Index>(path_.dimensions());
  return make_corner(Eigen::Map<const Eigen::VectorXd>(in_.data(), n),
                     Eigen::Map<const Eigen::VectorXd>(out_.data(), n), speed_in_, speed_out_);
}

namespace {

/// The least delay from `first` on: errors mostly fall with the delay. The last one counts as held.
template <class Held>
int least_delay(int first, int last, const Held& held) {
  return last <= first || held(first) ? first : least_held(first, last, held);
}

}  // namespace

int JointDelays::within_contour(int delay) const {
  if (!(path_.contour_max < unlimited)) return delay;
  const Corner corner = loaded();
  return least_delay(delay, finder_.exact_stop_delay(), [&](int d) {
    return measure(behind_, corner, d, period_).contour_deviation <= path_.contour_max + position_floor;
  });
}

int JointDelays::of_control(int delay) {
  const double step = watched_part(path_.control, in_.data(), path_.dimensions(), speed_in_) * speed_in_ * period_;
  for (;;) {
    delay = within_limits(delay);
    const auto given = control_delay(path_.control, filter_, step, delay);
    const bool waits = path_.control.names(DelayKind::exact_stop) || path_.control.width > 0.0;
    if (!given && waits) possible_ = false;
    if (given.value_or(delay) == delay) return delay;
    delay = *given;
  }
}

int JointDelays::exact_stop() const {
  return exact_stop_delay(filter_);
}

int JointDelays::stop(std::size_t b, double factor_in, double factor_out) {
  load(b, factor_in, in_, speed_in_);
  load(b + 1, factor_out, out_, speed_out_);
  // A limit that spans several samples may ask for a longer rest between the legs. A dwell is part of this rest.
  const bool bounded = path_.tolerance[b] < unlimited || path_.contour_max < unlimited;
  const int least =
      !behind_.ideal() && bounded ? std::max(exact_stop(), within_contour(within_tolerance(b))) : exact_stop();
  const int held = known(least, true, [&] { return within_limits(least, true); });
  const std::int64_t rest = held - dwell_samples(b);
  if (!path_.control.any() && rest > least + exact_stop_more) possible_ = false;
  return static_cast<int>(std::max<std::int64_t>(exact_stop(), rest));
}

std::int64_t JointDelays::dwell_samples(std::size_t b) const {
  std::int64_t samples = 0;
  for (const auto& [block, dwell] : path_.dwells_at(b)) samples += whole_samples(dwell / period_);
  return samples;
}

int JointDelays::corner(std::size_t b, double factor_in, double factor_out) {
  load(b, factor_in, in_, speed_in_);
  load(b + 1, factor_out, out_, speed_out_);
  return known(path_.tolerance[b], false, [&] { return of_control(within_contour(within_tolerance(b))); });
}

int JointDelays::within_tolerance(std::size_t b) const {
  if (!(path_.tolerance[b] < unlimited)) return 0;
  if (!behind_.differs()) return finder_(cos_interior(), speed_in_ * period_, speed_out_ * period_, path_.tolerance[b]);
  const Corner corner = loaded();
  return least_delay(0, behind_.longest_order() + 1, [&](int d) {
    return corner_error(behind_, corner, d, period_) <= path_.tolerance[b] + position_floor;
  });
}

int JointDelays::smooth(std::size_t b) {
  load(b, 1.0, in_, speed_in_);
  load(b + 1, 1.0, out_, speed_out_);
  double change2 = 0.0;
  for (std::size_t i = 0; i < path_.dimensions(); ++i) change2 += (out_[i] - in_[i]) * (out_[i] - in_[i]);
  const double bound = path_.tolerance[b], spread = spread_ * period_;
  int delay = 0;
  if (spread * spread * change2 > bound * bound) {
    delay = smallest_path_delay(behind_.motion(), cos_interior(), speed_in_ * period_, speed_out_ * period_, bound,
                                finder_.exact_stop_delay());
  }
  if (spread * spread * change2 > path_.contour_max * path_.contour_max) delay = within_contour(delay);
  delay = within_limits(delay);
  return delay > 0 ? of_control(delay) : 0;
}

}  // namespace accdec
