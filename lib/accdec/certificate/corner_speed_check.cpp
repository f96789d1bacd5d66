#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate/corner_speed_check.hpp>
#include <accdec/certificate/interval.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Upper bounds on any tap, and on any difference of two neighbouring taps or of an end tap and 0.
struct Largest {
  double tap = 1.0, difference = unlimited;
};

Largest largest_taps(const Task& task) {
  Largest largest;
  const Interval t(task.sample_period);
  const auto hold = [](double& bound, const Interval& by) { bound = std::min(bound, by.hi); };
  for (const TaskCorner& corner : task.corners) {
    const Corner& c = corner.geometry();
    for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
      const Axis& axis = task.machine.axes[i];
      const auto a = static_cast<Eigen::Index>(i);
      const Interval start = (Interval(c.feed_in) * Interval(c.direction_in[a])).magnitude(),
                     stop = (Interval(c.feed_out) * Interval(c.direction_out[a])).magnitude();
      for (const Interval& feed : {start, stop}) {
        if (!(feed.lo > 0.0)) continue;
        if (axis.acceleration_max < unlimited) hold(largest.tap, Interval(axis.acceleration_max) * t / feed);
        if (axis.jerk_max < unlimited) hold(largest.difference, Interval(axis.jerk_max) * t * t / feed);
      }
      if (axis.force_max < unlimited && axis.mass > 0.0 && start.lo > 0.0)
        hold(largest.tap, Interval(axis.force_max) * t / (Interval(axis.mass) * start));
    }
  }
  return largest;
}

/// Sums of c_i and of (i + 1) c_i, where c_i = min(tap, max(0, top - i difference)). There may be 10^9 of them, so both
/// parts are summed by formula: those at the tap's bound and the ramp. Rounding leaves open which side of its two ends
/// a c_i is on only within `near` samples of them. These are added one by one.
class Ramp {
 public:
  /// @param top  up to `longest` differences
  Ramp(const Largest& largest, double top) : largest_(largest), top_(top) {
    constexpr double near = 2.0;
    const double kink = (top - largest.tap) / largest.difference, end = top / largest.difference;
    const double full = std::max(0.0, std::floor(kink) - near), first = std::max(0.0, std::ceil(kink) + near),
                 last = std::max(first, std::floor(end) - near), stop = std::ceil(end) + near;
    mass_ = Interval(largest.tap) * Interval(full);
    moment_ = Interval(0.5 * largest.tap) * Interval(full) * Interval(full + 1.0);
    for (double i = full; i < first; ++i) add(i);
    if (last > first) add_ramp(first, last - first);
    for (double i = last; i < stop; ++i) add(i);
  }
  static constexpr double longest = 1e15;  ///< whole numbers up to here are exact
  Interval mass() const { return mass_; }
  Interval moment() const { return moment_; }

 private:
  Interval at(double i) const { return Interval(top_) - Interval(i) * Interval(largest_.difference); }
  void add(double i) {
    const Interval ramp = at(i);
    const Interval tap(std::clamp(ramp.lo, 0.0, largest_.tap), std::clamp(ramp.hi, 0.0, largest_.tap));
    mass_ = mass_ + tap;
    moment_ = moment_ + Interval(i + 1.0) * tap;
  }
  /// c_{first + j} = h - j D for j = 0 .. n - 1.
  void add_ramp(double first, double n) {
    const Interval h = at(first), d(largest_.difference);
    const Interval pairs = Interval(0.5 * n) * Interval(n - 1.0);  // sum j; sum j^2 is (2 n - 1)/3 of it
    const Interval mass = Interval(n) * h - d * pairs;
    mass_ = mass_ + mass;
    moment_ = moment_ + Interval(first + 1.0) * mass + pairs * (h - d * (Interval(2.0 * n - 1.0) / Interval(3.0)));
  }

  const Largest& largest_;
  double top_;
  Interval mass_, moment_;
};

/// A lower bound of sum (i + 1) c_i over all c_0, c_1 .. >= 0 with this sum. No c_i is above `tap` or more than
/// `difference` below the one before it. The minimum has c_i = min(tap, max(0, top - i difference)): any other sequence
/// with the same sum is first below it and later above it. A top with too small a sum gives a smaller value, so the
/// bound stays safe.
Interval distance(const Largest& largest, const Interval& sum) {
  const double goal = sum.lo;
  if (!(goal > 0.0)) return {};
  if (goal > 1.0 + 1e-9) return Interval(1e30);  // no leg is faster than its feed
  if (largest.difference == unlimited) {
    const double full = std::floor(goal / largest.tap * (1.0 - 1e-15));
    const Interval rest = Interval(goal) - Interval(full) * Interval(largest.tap);
    return Interval(largest.tap) * Interval(0.5 * full) * Interval(full + 1.0) +
           Interval(full + 1.0) * Interval(std::max(0.0, rest.lo));
  }
  double low = 0.0, high = largest.tap + largest.difference * (goal / largest.tap + 1.0);
  for (int i = 0; i < 45; ++i) {
    const double top = 0.5 * (low + high);
    const bool small = top < Ramp::longest * largest.difference && Ramp(largest, top).mass().hi <= goal;
    (small ? low : high) = top;
  }
  return low > 0.0 ? Ramp(largest, low).moment() : Interval{};
}

/// Both legs' speeds near the last sample at which leg 1 is the faster one. The speed of leg 1 right after that sample
/// is alpha; the speed of leg 2 at it is beta.
class Crossing {
 public:
  Crossing(const Largest& largest, const Corner& corner, double speed)
      : largest_(largest),
        in_(corner.feed_in),
        out_(corner.feed_out),
        speed_(speed),
        cosine_(std::max(-1.0, corner.cos_interior() - 1e-15), std::min(1.0, corner.cos_interior() + 1e-15)),
        equal_(speed_ / square_root(Interval(2.0) * (Interval(1.0) - cosine_))) {}

  /// Least sum of both legs' distances from the corner point, in sample periods: every beta is in one of these cells.
  double least_distance() const {
    constexpr int cells = 400;
    double least = unlimited;
    for (int i = 0; i <= cells; ++i) {
      const double width = 2.0 * equal_.lo / cells;
      least = std::min(least, least_between(i * width, i < cells ? (i + 1) * width : unlimited));
    }
    return least;
  }

 private:
  /// Least speed of the faster leg if the slower one has this speed: alpha^2 + beta^2 - 2 alpha beta cos = s^2.
  Interval faster(double slower) const {
    const Interval x(slower), sine2 = (Interval(1.0) - cosine_) * (Interval(1.0) + cosine_);
    return x * cosine_ + square_root(speed_ * speed_ - x * x * sine2);
  }
  /// It is concave up to the point where both are equal; from there the slower leg itself is fast enough.
  double faster_least(double low, double high) const {
    if (low >= equal_.lo) return std::max(low, equal_.lo);
    return std::min(faster(low).lo, high < equal_.lo ? faster(high).lo : equal_.lo);
  }
  /// One sample changes a leg's speed by no more than the largest tap.
  double least_between(double low, double high) const {
    const double alpha = (Interval(faster_least(low, high)) - Interval(largest_.tap) * in_).lo;
    const double beta =
        std::max(low, (Interval(faster_least(std::max(0.0, alpha), unlimited)) - Interval(largest_.tap) * out_).lo);
    if (beta > high) return unlimited;
    return (in_ * distance(largest_, Interval(alpha) / in_) + out_ * distance(largest_, Interval(beta) / out_)).lo;
  }

  const Largest& largest_;
  Interval in_, out_, speed_, cosine_, equal_;
};

}  // namespace

std::string too_fast_for_its_error(const Task& written) {
  const Task task = granted_limits(written);
  const Largest largest = largest_taps(task);
  for (const TaskCorner& corner : task.corners) {
    if (!corner.error_max || !(corner.speed_min > 0.0)) continue;
    const double cosine = corner.geometry().cos_interior() - 1e-15;
    if (!(cosine > -1.0) || !(cosine < 1.0 - 1e-9)) continue;
    const Interval across = square_root(Interval(0.5) * (Interval(1.0) + Interval(cosine)));
    const Interval least = Interval(Crossing(largest, corner.geometry(), corner.speed_min).least_distance());
    if ((Interval(task.sample_period) * across * least).lo > *corner.error_max)
      return fmt::format("corner {}: no filter keeps both its smallest speed and its tolerance", corner.name);
  }
  return {};
}

}  // namespace accdec
