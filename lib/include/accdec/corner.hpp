// One corner: geometry, motion, errors, closed forms of linear Acc/Dec, smallest delay.
#pragma once

#include <vector>

#include <Eigen/Core>

#include <accdec/filter.hpp>

namespace accdec {

enum class Turn { left, right };

/// Two straight legs that meet in the corner point, in any number of axes (columns = machine axes).
struct Corner {
  Eigen::VectorXd direction_in;   ///< unit vector of travel on leg 1, into the corner
  Eigen::VectorXd direction_out;  ///< unit vector of travel on leg 2, out of the corner; same size
  double feed_in = 0.0;           ///< leg 1 speed v1, m/s, > 0
  double feed_out = 0.0;          ///< leg 2 speed v2, m/s, > 0

  Eigen::Index axes() const { return direction_in.size(); }
  /// cos(theta) of the interior angle: -u1 . u2, clamped to [-1, 1]; theta = 180 deg is straight on.
  double cos_interior() const;
};

/// Corner from two direction vectors of any positive length and equal size (>= 1).
/// @throws std::invalid_argument on a zero or non-finite vector, unequal sizes, or a feed that is not positive and
/// finite.
Corner make_corner(const Eigen::VectorXd& direction_in, const Eigen::VectorXd& direction_out, double feed_in,
                   double feed_out);

/// Corner in the plane of the first two of `axes` axes (>= 2).
/// @param interior_angle  rad, 0 < angle <= pi
/// @param heading         travel direction on leg 1 from +x towards +y, rad
/// @throws std::invalid_argument on values outside these ranges.
Corner planar_corner(double interior_angle, double heading, Turn turn, double feed_in, double feed_out, int axes = 2);

/// The motion around one corner. Leg 1 decelerates through `filter_in`, while leg 2 accelerates through `filter_out`.
/// The command of leg 2 starts `delay` samples after leg 1's command ended. (Eq. 19-29, for a pair of filters; the
/// paper uses the same one twice.)
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

  /// Last sample before anything changes, min(0, d), and first sample with the full speed of leg 2, max(N1, N2 + d) +
  /// 1.
  int first_sample() const { return first_; }
  int last_sample() const { return last_; }
  int delay() const { return delay_; }
  const Corner& corner() const { return corner_; }

  /// Distance left on leg 1 at sample k and distance gone on leg 2 at sample m; both >= 0. Any integers.
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
  int corner_error_sample = 0;     ///< the earliest k at which it occurs
  double polyline_error = 0.0;     ///< distance of the corner point from the polyline through the samples, m
  double contour_deviation = 0.0;  ///< largest distance of that polyline from the two programmed legs, m
  double speed_min = 0.0;          ///< min over the window of the tangential speed |V'[k]|, m/s
  int speed_min_sample = 0;
};

/// Measures a blend over its whole window. O(N + |d|).
CornerMeasures measure(const Blend& blend);

/// Corner error alone, by bisection: as the path is convex, |S[k]| falls, then rises along the window. O(log(N + |d|)).
double corner_error(const Blend& blend);

/// Corner motion by linear Acc/Dec in continuous time and closed form (Shih, Chen, Lee, Eq. 3-15, with misprints
/// corrected). The speed of leg 1 falls from v1 to 0 over 0 <= t <= tau. The speed of leg 2 rises from 0 to v2 over dT
/// <= t <= dT + tau.
///
/// Vectors are in the paper's a-b frame: the corner point is the origin, the b-axis bisects the interior angle, motion
/// runs towards +a. With P the distance left on leg 1 and Q the distance gone on leg 2,
///   S_a = (Q - P) sin(theta/2),  S_b = (Q + P) cos(theta/2).
/// Defined for every t, before, between and after the two ramps, and for every dT >= 0.
class LinearCorner {
 public:
  /// @param interior_angle  theta, rad, 0 < theta <= pi
  /// @param feed_in         v1, m/s, > 0
  /// @param feed_out        v2 = c v1, m/s, > 0
  /// @param acc_dec_time    tau, s, > 0
  /// @param delay           dT, s, >= 0
  /// @throws std::invalid_argument on values outside these ranges or not finite.
  LinearCorner(double interior_angle, double feed_in, double feed_out, double acc_dec_time, double delay = 0.0);

  Eigen::Vector2d position(double t) const;  ///< (S_a, S_b), m: Eq. (5.c-d), (8), (11), (14) within the overlap
  Eigen::Vector2d velocity(double t) const;  ///< (v_a, v_b), m/s: Eq. (5.a-b), (7), (10), (13) within the overlap
  double distance(double t) const;           ///< |S|, m

  /// The instant of closest approach, Eq. (2): the root of S . V = 0. s.
  ///
  /// While both ramps overlap, with z = (t - dT)/(tau - t) and c = v2/v1, S . V has the sign of
  ///   c^2 z^3 - c cos(theta) z^2 + c cos(theta) z - 1,
  /// This is negative where the overlap begins (z = 0) and positive where it ends. As the path is convex, there is one
  /// root between. The minimum therefore never lies outside the overlap. Without an overlap (dT >= tau) the motion
  /// rests in the corner from t = tau on, and tau is returned.
  double closest_time() const;
  /// Corner error min |S(t)|, Eq. (1), exact for every v2/v1. It is that without delay times (1 - dT/tau)^2. m.
  double corner_error() const { return distance(closest_time()); }
  /// The same over the samples t = k T, k integer, only: what the paper's Table 1 prints. @param sample_period T, s, >
  /// 0. m.
  double sampled_corner_error(double sample_period) const;

  /// S_b where v_b = 0, t = (tau + c dT)/(c + 1) (Eq. 15 in 14.b): v1 tau/2 c/(c + 1) cos(theta/2) (1 - dT/tau)^2. Eq.
  /// (6), (9) and (12) are its cases; exact for equal feeds, else a little too small (1.9 % at c = 2, 90 deg). 0 for dT
  /// >= tau. m.
  double approximate_corner_error() const;

  /// Smallest delay dT, 0 .. tau, whose exact corner error is within the bound, whatever `delay` is here. @param
  /// error_max m, >= 0. s.
  double smallest_delay(double error_max) const;

 private:
  double distance_in(double t) const;
  double distance_out(double t) const;

  double sin_half_, cos_half_, cos_interior_, feed_in_, feed_out_, tau_, delay_;
};

/// Finds the smallest command delay that brings a corner's error at samples within a bound, for a fixed filter (or
/// pair). It is built once per filter and then called for millions of corners. Copies what it needs; const calls from
/// many threads are safe.
///
/// For every sample k, the law of cosines gives the farthest point that leg 2 may have reached, q_max(P(k)). The
/// smallest real delay is then d(k) = k - Qinv(q_max(P(k))), with Q interpolated linearly. The path (P(k), Q(k - d)) is
/// a convex curve and q_max is concave. So for every D the k with d(k) <= D are consecutive: d(k) falls, then rises.
/// Doubling steps from a guess bracket its minimum, and golden section narrows it. Each step takes one square root and
/// one table look-up for Qinv: O(log N).
///
/// Up to 90 deg the answer is the minimum rounded up. On flat corners whole samples may step over the ball around the
/// corner. So delays are tried one by one from there; the search for each starts at the nearest sample of the one
/// before. One or two are enough unless the tolerance is far below the distance moved in a sample. The worst case, an
/// almost straight pass with such a tolerance, tries O(N) delays.
class DelayFinder {
 public:
  explicit DelayFinder(const Filter& filter) : DelayFinder(filter, filter) {}
  DelayFinder(const Filter& filter_in, const Filter& filter_out);

  /// @param cos_interior  cos(theta), -1 .. 1
  /// @param step_in       v1 T, m, > 0: length of a full-speed sample of leg 1
  /// @param step_out      v2 T, m, > 0
  /// @param error_max     bound on min_k |S[k]|, m, >= 0 (a negative bound or NaN is taken as 0)
  /// @return the smallest d >= 0 with corner error <= error_max, ties by rounding aside (1e-12 of the bound); never
  /// more
  ///         than the d of an exact stop. The error of the delay returned, as computed by `corner_error`, satisfies the
  ///         bound to the last bit.
  int operator()(double cos_interior, double step_in, double step_out, double error_max) const;

  /// The smallest delay at which the motion stops exactly in the corner: last non-zero tap of leg 1's filter less first
  /// of leg 2's, and at least 0.
  int exact_stop_delay() const { return stop_delay_; }

 private:
  /// A convex, non-decreasing sequence from 0, and its inverse by a table. The table is uniform in the square root of
  /// the value, which spreads the parabolic ends of usual Acc/Dec shapes evenly.
  class Ramp {
   public:
    explicit Ramp(const std::vector<double>& values);
    double operator[](int m) const { return points_[static_cast<std::size_t>(m)].value; }
    double top() const { return points_.back().value; }
    int last() const { return static_cast<int>(points_.size()) - 1; }
    /// Largest m with value <= x, for 0 <= x < top. Expected O(1), never more than O(log size).
    int floor(double x) const;
    /// Real m by linear interpolation; beyond the top the sequence goes on with slope 1.
    double inverse(double x) const;

   private:
    struct Point {
      double value, per_step;  ///< and 1 / (next value - value)
    };
    std::vector<Point> points_;
    std::vector<int> cell_;  ///< largest m whose value lies in an earlier cell
    double scale_ = 0.0;
  };

  Ramp in_;   ///< in_[m] = remaining_moment(last_ - m) of leg 1's filter
  Ramp out_;  ///< out_[m] = elapsed_moment(m + first_) of leg 2's
  int last_, first_, stop_delay_;
  double mean_delay_out_;
  double exponent_ = 2.0;
};

}  // namespace accdec
