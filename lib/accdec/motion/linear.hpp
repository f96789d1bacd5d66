#pragma once

#include <Eigen/Core>

namespace accdec {

/// Corner motion by linear Acc/Dec in continuous time and closed form (Shih, Chen, Lee, Eq. 3-15, their misprints
/// corrected): leg 1's speed falls from v1 to 0 over 0 <= t <= tau, leg 2's rises from 0 to v2 over dT <= t <= dT +
/// tau.
///
/// Vectors are in the paper's a-b frame: the corner point is the origin, the b-axis halves the interior angle, motion
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
  /// negative where the overlap begins (z = 0), positive where it ends, with one root between, for the path is convex.
  /// The minimum therefore never lies outside the overlap. Without an overlap, dT >= tau, the motion rests in the
  /// corner from t = tau on, and that is returned.
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

}  // namespace accdec
