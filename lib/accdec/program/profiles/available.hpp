#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <accdec/machine/machine.hpp>

namespace accdec {

/// What acceleration the limits of every axis leave at a speed, so that a motion may speed up and brake with it alike:
///   min(a_max, (F_max - c v)/m, (P_max/v - c v)/m, max(P_regen/v, 2 sqrt(P_regen c))/m),
/// which never grows with v. The last term is below (P_regen/v + c v)/m, what braking at v may take.
class AvailableAcceleration {
 public:
  /// @param machine  one axis a dimension of the path, or none; the reference is kept
  /// @param period   s, the sample period T
  /// @param taps     >= 1, of the boxcar that the sampled motion passes last. Its jerk is the change of the
  /// acceleration within `taps` T over
  ///                 that time, so an axis with a jerk limit may change its acceleration by `swing` within that time,
  ///                 and has no more than that
  AvailableAcceleration(const Machine& machine, double period, int taps);

  /// m/s^2 of an axis at `speed` >= 0 m/s of that axis; `unlimited` if nothing limits it, 0 if the speed cannot be
  /// held.
  double of_axis(std::size_t axis, double speed) const;
  /// m/s^2 along the unit vector `u` at `speed` of the path.
  double along(const double* u, std::size_t dimensions, double speed) const;
  /// The largest speed <= `feed` along `u` that all axes can hold and still leave.
  double feed(const double* u, std::size_t dimensions, double feed) const;
  /// Whether the acceleration depends on the speed (force, power or regeneration is limited).
  bool depends_on_speed() const { return depends_; }
  bool any() const { return !machine_.axes.empty(); }
  /// m/s^2: j_max taps T; `unlimited` without a jerk limit.
  double swing(std::size_t axis) const {
    return machine_.axes.empty() ? unlimited : machine_.axes[axis].jerk_max * window_ * jerk_margin;
  }
  /// s: taps T if there is more than one tap, else 0.
  double window() const { return taps_ > 1 ? window_ : 0.0; }
  int taps() const { return taps_; }
  double period() const { return period_; }

  /// Share of every limit that plans use, so that rounding of positions does not break it.
  static constexpr double margin = 1.0 - 1e-9, jerk_margin = 1.0 - 1e-6;

 private:
  const Machine& machine_;
  double period_, window_, blur_;
  int taps_;
  bool depends_ = false;
};

/// The longest a_max/j_max of the axes with a jerk limit, s; none without such an axis.
std::optional<double> longest_jerk_time(const Machine& machine);

/// Why plan `profiles` cannot take a task; empty if it can. Vibration bounds are refused: they judge one filter's
/// frequency response, and here every corner has its own.
std::string profiles_refusal(const Machine& machine);

}  // namespace accdec
