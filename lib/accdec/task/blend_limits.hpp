#pragma once

#include <array>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {

/// Limits used up to this factor surely count as held, whatever the simulation rounds (verdict_by_formula).
inline constexpr double surely_granted = 1.0 + 0.5 * verification_tolerance;

/// The axis limits where two legs meet, by the formula of the blend: velocity, acceleration, jerk, force, power and
/// regeneration, also of all axes together. Modes of axes belong to them. Quick delays of designs, delays of given
/// filters and delays of programs all come from here. It is made for millions of joints: bounds for every delay settle
/// most, the others are checked sample by sample with an early exit. With a response of the machine, load limits are
/// those of the motion behind it. The checkers (verifier, check of delays, proofs, samples of programs) have formulas
/// of their own.
class BlendLimits {
 public:
  /// References are kept.
  BlendLimits(const Filter& filter, const Machine& machine, double sample_period);

  bool any() const { return !limited_.empty() || limits_supply(machine_) || !residuals_.empty(); }
  /// The designed filter behind the control's smoothing.
  const Filter& command() const { return filter_; }
  struct Binding {
    LimitKind kind = LimitKind::velocity;
    std::size_t axis = 0;  ///< beyond all axes: the limit is one of the supply
  };
  /// Largest factor <= 1 on a velocity, m/s an axis, with which the filter surely starts it from rest and stops it
  /// within the limits.
  /// @param binding  set to the limit that asks for it, if the factor is below 1
  double start_factor(const double* velocity, Binding* binding = nullptr) const;
  /// Smallest d >= from with all limits held; `from` itself if even legs so far apart that they do not overlap break
  /// one.
  /// @param in, out  velocities of the legs, m/s, one value an axis  @param possible  set to false in that case, else
  /// left alone
  /// @param stop  whether the legs meet in a stop, behind which modes of axes begin again
  int smallest(const double* in, const double* out, int from, bool& possible, bool stop = false) const;
  /// Whether the limits hold with this delay, sample by sample; a leg at rest has velocities of 0.
  /// @param slack  factor on the bounds
  /// @param hint  a sample checked first, set to the first that breaks a limit. The next delay most likely fails at the
  /// same sample, so most delays that fail cost O(axes) instead of O(axes N).
  bool holds(const double* in, const double* out, int delay, double slack = surely_granted, int* hint = nullptr) const;

 private:
  /// @param still  m/s, up to which an axis stands still
  bool sample_holds(std::size_t axis, double in, double out, int delay, int sample, double slack, double still) const;
  bool axes_hold(const double* in, const double* out, int delay, double slack, int* hint) const;
  /// The first sample at which an axis breaks a limit; -1: none.
  int first_broken(const Axis& axis, double in, double out, int delay, int last, double slack, double still) const;
  bool supply_holds(const double* in, const double* out, int delay, double slack, double still) const;
  /// Modes of axes: what a leg that starts or stops leaves, and what both leave together.
  bool residuals_hold(const double* in, const double* out, int delay, double slack) const;
  bool any_delay_holds(const double* in, const double* out, int from) const;
  /// The same of one axis: true only if every delay from `from` on holds its limits.
  bool surely_holds(const Axis& axis, double in, double out, int from) const;

  /// The largest velocity, acceleration, jerk and load of an axis that starts to or stops from a speed, together.
  AxisState peak_at(const Axis& axis, double speed) const;
  /// The same of a largest velocity and changes of it, which the motion's may exceed.
  AxisState peak_of(const Axis& axis, double velocity, double acceleration, double jerk) const;
  /// The state of one axis at a sample.
  AxisState state(AxisSampler& sampler, const Axis& axis, double in, double out, int delay, int sample,
                  double still) const;

  FilterBehind behind_;
  const Filter& filter_;  // of the command
  const Machine& machine_;
  double period_;
  bool dry_;                                 // some axis has dry friction
  double peak_tap_ = 0.0, peak_step_ = 0.0;  // largest tap and difference of neighbours
  std::vector<std::size_t> limited_;         // axes with any limit
  struct Residual {
    const Mode* mode;
    double of_one;                 // largest use by a start to 1 m/s
    std::array<double, 2> at_end;  // the same at either end of the frequencies, with the least damping
  };
  std::vector<Residual> residuals_;  // of modes of axes
  int slowest_ = 0;                  // samples that the slowest of them swings once
};

/// Velocities of a corner's legs, m/s, one value an axis, as BlendLimits takes them.
struct LegVelocities {
  explicit LegVelocities(const Corner& corner);
  std::vector<double> in, out, rest;  ///< rest: zeros
};

}  // namespace accdec
