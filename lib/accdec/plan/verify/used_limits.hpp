#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

#include <accdec/machine.hpp>
#include <accdec/simulate/direct.hpp>

// Internal: the verifier's own formulas of the limits of axes and of the supply, at every sample of a program.

namespace accdec {

/// One limit as the motion uses it, sample by sample.
class UseOfLimit {
 public:
  struct Worst {
    double use = 0.0, value = 0.0;
  };
  /// @param value  at a kept sample  @param motion  the reference is kept
  UseOfLimit(LimitKind kind, double bound, const DirectMotion& motion, std::function<double(std::size_t)> value)
      : kind_(kind), bound_(bound), motion_(motion), value_(std::move(value)) {}

  LimitKind kind() const { return kind_; }
  double bound() const { return bound_; }
  /// By how much simulations that round otherwise may differ in a value whose bound may be 0: in a distance.
  double floor() const;
  double use(double value) const;
  Worst worst() const;
  /// Whether the value of a sample is the worst up to rounding: that of the simulation which chose the sample, and that
  /// of this one.
  bool is_worst(std::int64_t sample, const Worst& worst) const;

 private:
  LimitKind kind_;
  double bound_;
  const DirectMotion& motion_;
  std::function<double(std::size_t)> value_;
};

/// Force of an axis, N. Dry friction is against the motion. An axis that moves less than positions can tell stands
/// still, and its friction takes what it can of the force.
double force_of(const Axis& axis, double velocity, double acceleration, double period);
/// The use of a limit by one axis. References are kept.
UseOfLimit use_of_axis(const DirectMotion& motion, const Axis& axis, std::size_t a, LimitKind kind, double period);
/// Root mean square of the force of an axis over the program's time, N, rests included. The motion behind a servo
/// counts until it rests.
double rms_force(const DirectMotion& motion, const Axis& axis, std::size_t a, double period);
/// The use of the supply by all axes together. References are kept. @param kind  power_total or regeneration_total
UseOfLimit use_of_supply(const DirectMotion& motion, const Machine& machine, LimitKind kind, double period);

}  // namespace accdec
