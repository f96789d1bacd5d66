#pragma once

#include <cstddef>
#include <optional>

#include <accdec/machine.hpp>
#include <accdec/plan/trajectory/last_filter.hpp>

namespace accdec {

/// The acceleration that the limits of every axis leave at a speed, for both speeding up and braking:
///   min(a_max, (F_max - c v)/m, (P_max/v - c v)/m, max(P_regen/v, 2 sqrt(P_regen c))/m),
/// which never grows with v. The last term is below (P_regen/v + c v)/m, what braking at v may take.
class AvailableAcceleration {
 public:
  /// @param machine  one axis per dimension of the path, or none
  /// @param period   s, the sample period T
  /// @param last     which the sampled motion passes last. Its jerk is at most the change of the acceleration within
  ///                 the window over the swing time, so an axis with a jerk limit may change its acceleration by
  ///                 `swing` within the window, and has no more than that
  AvailableAcceleration(const Machine& machine, double period, LastFilter last);

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
  /// m/s^2: j_max times the swing time; `unlimited` without a jerk limit.
  double swing(std::size_t axis) const {
    return machine_.axes.empty() ? unlimited : machine_.axes[axis].jerk_max * last_.swing_time() * jerk_margin;
  }
  const LastFilter& last() const { return last_; }
  /// s, of the last filter.
  double window() const { return last_.window(); }
  double period() const { return period_; }

  /// Part of every limit that plans use, so that rounding of positions does not break it.
  static constexpr double margin = 1.0 - 1e-9, jerk_margin = 1.0 - 1e-6;

 private:
  const Machine& machine_;
  double period_;
  LastFilter last_;
  double blur_;
  bool depends_ = false;
};

/// The longest a_max/j_max of the axes with a jerk limit, s; none without such an axis. An axis without a limit of
/// acceleration has as much as reversing from the fastest speed (m/s) needs, sqrt(2 v j_max).
std::optional<double> longest_jerk_time(const Machine& machine, double fastest);

}  // namespace accdec
