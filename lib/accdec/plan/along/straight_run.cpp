#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/plan/along/straight_run.hpp>

namespace accdec {
namespace {

constexpr double longest_run = 2e6;     // samples
constexpr double least_length = 1e-12;  // m

/// Along the line, m/s, m/s^2, m/s^3.
struct LineLimits {
  double speed = unlimited, acceleration = unlimited, jerk = unlimited;
};

/// Motion from rest to rest, the second half a mirror image of the first.
class RestToRest {
 public:
  RestToRest(double length, const LineLimits& limits) : length_(length) {
    const double a = limits.acceleration, full = a / limits.jerk;  // s, of a rise to the largest acceleration
    speed_ = limits.speed;
    if (speed_ * ramp(speed_, a, limits.jerk) > length) {
      speed_ = 0.5 * a * (std::sqrt(full * full + 4.0 * length / a) - full);
      if (speed_ < a * full) speed_ = std::cbrt(0.25 * length * length * limits.jerk);
    }
    ramp_ = ramp(speed_, a, limits.jerk);
    rise_ = std::min(full, 0.5 * ramp_);
    steepest_ = speed_ / (ramp_ - rise_);
  }

  double time() const { return ramp_ + length_ / speed_; }
  /// Way after t <= time()/2, s and m.
  double way(double t) const { return t < ramp_ ? risen(t) : speed_ * (t - 0.5 * ramp_); }

 private:
  /// s, from rest to a speed.
  static double ramp(double speed, double acceleration, double jerk) {
    return speed * jerk >= acceleration * acceleration ? speed / acceleration + acceleration / jerk
                                                       : 2.0 * std::sqrt(speed / jerk);
  }
  double risen(double t) const {
    if (t < rise_) return steepest_ * t * t * t / (6.0 * rise_);
    if (t <= ramp_ - rise_) return steepest_ * (rise_ * rise_ / 6.0 + 0.5 * t * (t - rise_));
    const double left = ramp_ - t;
    return speed_ * (t - 0.5 * ramp_) + (rise_ > 0.0 ? steepest_ * left * left * left / (6.0 * rise_) : 0.0);
  }

  double length_, speed_, ramp_ = 0.0, rise_ = 0.0;  // m, m/s, s: of a ramp and of its jerk
  double steepest_ = 0.0;                            // m/s^2
};

/// @param direction  of length 1
LineLimits limits_along(const FreePath& free, const double* direction, double feed) {
  LineLimits limits;
  limits.speed = feed;
  for (std::size_t a = 0; a < free.dimensions(); ++a) {
    const double part = std::abs(direction[a]);
    if (part > 0.0) limits.speed = std::min(limits.speed, of_limits * free.machine.axes[a].velocity_max / part);
  }
  for (std::size_t a = 0; a < free.dimensions(); ++a) {
    const Axis& axis = free.machine.axes[a];
    const double part = std::abs(direction[a]);
    if (!(part > 0.0)) continue;
    double most = axis.acceleration_max;
    // Friction leaves the least force at the highest speed.
    if (axis.force_max < unlimited && axis.mass > 0.0)
      most = std::min(most, (axis.force_max - axis.damping * limits.speed * part) / axis.mass);
    else if (axis.force_max < unlimited && axis.damping * limits.speed * part > axis.force_max)
      most = 0.0;
    limits.acceleration = std::min(limits.acceleration, of_limits * most / part);
    limits.jerk = std::min(limits.jerk, of_limits * axis.jerk_max / part);
  }
  return limits;
}

}  // namespace

std::optional<StraightLeg> straight_leg(const FreePath& free, std::size_t first, std::size_t last) {
  StraightLeg leg;
  for (std::size_t b = first; b <= last; ++b) {
    if (b < last && free.path.joint[b] != Joint::straight) return {};
    leg.feed = std::min(leg.feed, free.feed[b]);
  }
  const double* const from = free.path.point(first);
  const double* const to = free.path.point(last + 1);
  for (std::size_t a = 0; a < free.dimensions(); ++a)
    leg.length = std::hypot(leg.length, leg.direction[a] = to[a] - from[a]);
  if (!(leg.length > least_length)) return {};
  for (double& part : leg.direction) part /= leg.length;
  return leg;
}

AlongRun on_line(const FreePath& free, std::size_t first, std::size_t last, const std::vector<double>& done) {
  const std::size_t n = free.dimensions();
  const double* const from = free.path.point(first);
  const double* const to = free.path.point(last + 1);
  AlongRun run;
  for (std::size_t i = 1; i < done.size(); ++i) {
    for (std::size_t a = 0; a < n; ++a)
      run.position.push_back(done[i] < 0.5 ? from[a] + done[i] * (to[a] - from[a])
                                           : to[a] - (1.0 - done[i]) * (to[a] - from[a]));
  }
  double length = 0.0;
  for (std::size_t a = 0; a < n; ++a) length = std::hypot(length, to[a] - from[a]);
  std::size_t k = 0;
  for (std::size_t b = first; b < last; ++b) {
    double way = 0.0;
    for (std::size_t a = 0; a < n; ++a) way = std::hypot(way, free.path.point(b + 1)[a] - from[a]);
    while (k + 2 < done.size() && done[k + 1] < way / length) ++k;
    const double step = done[k + 1] - done[k];
    run.passes.push_back(static_cast<double>(k) + std::clamp((way / length - done[k]) / step, 0.0, 1.0));
  }
  return run;
}

std::optional<AlongRun> straight_run(const FreePath& free, std::size_t first, std::size_t last) {
  const std::optional<StraightLeg> leg = straight_leg(free, first, last);
  if (!leg) return {};
  const LineLimits limits = limits_along(free, leg->direction.data(), leg->feed);
  if (!(limits.speed > 0.0) || !(limits.speed < unlimited) || !(limits.acceleration > 0.0) ||
      !(limits.acceleration < unlimited))
    return {};
  const RestToRest motion(leg->length, limits);
  const double count = std::max(1.0, std::ceil(motion.time() / free.period - 1e-9));
  if (!(count < longest_run)) return {};
  std::vector<double> done{0.0};  // part of the way, of every sample
  for (double k = 1.0; k <= count; ++k) {
    const bool late = 2.0 * k > count;
    const double part = motion.way((late ? count - k : k) / count * motion.time()) / leg->length;
    done.push_back(late ? 1.0 - part : part);
  }
  return on_line(free, first, last, done);
}

}  // namespace accdec
