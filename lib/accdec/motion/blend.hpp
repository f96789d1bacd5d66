#pragma once

#include <Eigen/Core>

#include <accdec/motion/corner.hpp>
#include <accdec/motion/filter.hpp>

namespace accdec {

/// The motion around one corner: leg 1 decelerates through `filter_in` while leg 2, commanded `delay` samples after leg
/// 1's command ended, accelerates through `filter_out` (Eq. 19-29, for a pair of filters; the paper uses the same one
/// twice).
///
/// Sample k counts from the last full-speed sample of leg 1. Position is the right-rectangle sum of Eq. (29) and linear
/// in the taps:
///   S[k] = -p(k) v1 T u1 + q(k - d) v2 T u2,  p = filter_in.remaining_moment, q = filter_out.elapsed_moment.
/// Holds references: the filters and the corner must outlive it.
class Blend {
 public:
  /// @param delay          d in samples; may be negative for a pair of filters (leg 2's command starts before leg 1's
  /// ends)
  /// @param sample_period  T in s, > 0
  Blend(const Filter& filter_in, const Filter& filter_out, const Corner& corner, int delay, double sample_period);
  Blend(const Filter& filter, const Corner& corner, int delay, double sample_period)
      : Blend(filter, filter, corner, delay, sample_period) {}

  /// Last sample before anything changes, min(0, d); and the first with all of leg 2's speed, max(N1, N2 + d) + 1.
  int first_sample() const { return first_; }
  int last_sample() const { return last_; }
  int delay() const { return delay_; }
  const Corner& corner() const { return corner_; }

  /// Distance left on leg 1 and distance gone on leg 2 at sample k, m; both >= 0. Any integer k.
  double distance_in(int k) const { return filter_in_.remaining_moment(k) * step_in_; }
  double distance_out(int k) const { return filter_out_.elapsed_moment(k - delay_) * step_out_; }

  /// Speed along each leg at sample k, m/s.
  double speed_in(int k) const { return filter_in_.remaining(k) * corner_.feed_in; }
  double speed_out(int k) const { return filter_out_.cumulative(k - delay_) * corner_.feed_out; }

  Eigen::VectorXd position(int k) const;      ///< m, relative to the corner point
  Eigen::VectorXd velocity(int k) const;      ///< m/s
  Eigen::VectorXd acceleration(int k) const;  ///< m/s^2, a'[k] = (V'[k] - V'[k-1])/T
  Eigen::VectorXd jerk(int k) const;          ///< m/s^3, (a'[k] - a'[k-1])/T

  /// |S[k]|, m.
  double distance(int k) const;
  /// |V'[k]|, m/s.
  double tangential_speed(int k) const;
  /// Duration of the blend, (last_sample - first_sample) T: (N + 1 + d) T for one filter and d >= 0. s.
  double corner_time() const { return (last_ - first_) * sample_period_; }

 private:
  const Filter& filter_in_;
  const Filter& filter_out_;
  const Corner& corner_;
  int delay_, first_, last_;
  double sample_period_, step_in_, step_out_, cos_interior_;
};

/// The three different distances and the speed of a corner; see each. Never mix the first three.
struct CornerMeasures {
  double corner_error = 0.0;       ///< min over samples of |S[k]|, m: the paper's error, what tolerances bound
  int corner_error_sample = 0;     ///< the k it occurs at (the earliest)
  double polyline_error = 0.0;     ///< distance of the corner point from the polyline through the samples, m
  double contour_deviation = 0.0;  ///< largest distance of that polyline from the two programmed legs, m
  double speed_min = 0.0;          ///< min over the window of the tangential speed |V'[k]|, m/s
  int speed_min_sample = 0;
};

/// Measures a blend over its whole window. O(N + |d|).
CornerMeasures measure(const Blend& blend);

/// Corner error alone, by bisection: |S[k]| falls, then rises along the window, for the path is convex. O(log(N +
/// |d|)).
double corner_error(const Blend& blend);

}  // namespace accdec
