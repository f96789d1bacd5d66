#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/force_speed.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The changes of the commanded velocity that a filter allows, as two windows of time.
///
/// A trapezoid of taps is a moving average over tau1 followed by one over tau2. After the first, the acceleration is
/// (V(t) - V(t - tau1))/tau1, where V is the commanded velocity of an axis. The second averages this, which breaks no
/// limit. So
///   |V(t) - V(t - tau1)| <= tau1 a_max                                             holds the acceleration limit, and
///   |V(t) - V(t - tau1) - V(t - tau2) + V(t - tau1 - tau2)| <= tau1 tau2 j_max     the jerk limit.
/// This holds for every t and any V in between; sampling at T averages once more. Steps of tau1 a_max every tau1 keep
/// the acceleration at its limit without interruption. Other taps are treated as tau1 = T/max b_i with the jerk of a
/// single step. Their largest acceleration is that of a step. This is a guess that the simulation must confirm. Limits
/// of force, power and regeneration bound the first difference at the larger of the two speeds, V = max(|V(t)|, |V(t -
/// tau1)|). While speeding up: m a + c V + F_c <= F, (m a + c V + F_c) V <= P. While braking: m a <= F,
/// m a V <= P_regen. F is no more than a force-speed curve allows at V. The shared supply gives the sum of what the
/// axes need that speed up or go on, and takes that of those that brake, less what their friction takes.
class FeedWindow {
 public:
  /// @param machine   as many axes as the path, or none: nothing is limited
  FeedWindow(const Filter& filter, const Machine& machine, double sample_period, std::size_t dimensions);

  double tau1() const { return tau1_; }  ///< s
  double tau2() const { return tau2_; }  ///< s; 0 if no axis has a jerk limit
  double reach() const { return tau1_ + tau2_; }
  /// s from the middle of the motion's filter to its end: a joint passed within this time of its own acts on its error
  double half() const { return half_; }
  bool limited() const { return limited_; }
  bool loads() const { return loads_; }
  bool supply() const { return supply_; }  ///< whether the shared supply is limited
  bool jerk() const { return tau2_ > 0.0; }

  /// Largest change of velocity over tau1 of an axis that acceleration and force allow at rest, and that a single step
  /// keeps jerk with, m/s.
  double step(std::size_t axis) const { return axes_[axis].step; }
  double acceleration_change(std::size_t axis) const { return axes_[axis].change; }
  double jerk_change(std::size_t axis) const { return axes_[axis].jerk; }
  /// Largest |V - before| over tau1, m/s. @param mirrored  time runs backwards: braking is speeding up
  double change(std::size_t axis, double velocity, double before, bool mirrored) const {
    return axes_[axis].loaded ? loaded_change(axis, velocity, before, mirrored) : axes_[axis].change;
  }
  /// Part of the shared supply that a change of all axes over tau1 uses. @param velocities, before  m/s, one an axis
  double supply_use(std::span<const double> velocities, std::span<const double> before, bool mirrored) const;

 private:
  struct AxisWindow {
    double change = unlimited, jerk = unlimited, step = unlimited;
    bool loaded = false;
    std::vector<ForceLine> lines;  // of the force-speed curve
    double fastest = unlimited;    // m/s, its end
  };
  /// Whether the axis is driven in the change, so that friction needs force; else it helps to brake.
  static bool driven(const Axis& axis, double velocity, double before, bool mirrored);
  double loaded_change(std::size_t axis, double velocity, double before, bool mirrored) const;
  double tau1_ = 0.0, tau2_ = 0.0, half_ = 0.0;
  bool limited_ = false, loads_ = false, supply_ = false;
  double power_total_ = unlimited, regeneration_total_ = unlimited;  // W
  std::vector<AxisWindow> axes_;
  std::vector<Axis> machine_;
};

/// The two lengths, in samples, of the moving averages that make a trapezoid of taps, the longer first; {0, 0} if the
/// taps are none.
std::array<int, 2> moving_averages(const Filter& filter);

}  // namespace accdec
