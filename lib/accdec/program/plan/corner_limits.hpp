#pragma once

#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/machine/utilisation.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// Whether a lone joint with a delay holds the axis limits while the legs overlap: velocity, acceleration, jerk, force,
/// power, regeneration, the same bounds as `axis_utilisation` without its ends at rest. Made for millions of joints:
/// most are settled by what holds for every delay, the others sample by sample with an early way out.
class CornerLimits {
 public:
  /// References are kept.
  CornerLimits(const LegFilters& filters, const Machine& machine, double sample_period);

  bool any() const { return !limited_.empty(); }
  struct Binding {
    LimitKind kind = LimitKind::velocity;
    std::size_t axis = 0;
  };
  /// Largest factor <= 1 on a velocity, m/s an axis, with which filter f surely starts it from rest and stops it within
  /// the limits.
  /// @param binding  set to the limit that asks for it, if the factor is below 1
  double start_factor(std::size_t f, const double* velocity, Binding* binding = nullptr) const;
  /// Smallest d >= from with all limits held; `from` itself if even legs so far apart that they do not overlap break
  /// one.
  /// @param f_in, f_out  filters of the legs, by index
  /// @param in, out  velocities of the legs, m/s, one value an axis  @param possible  set to false in that case, else
  /// left alone
  int smallest(std::size_t f_in, std::size_t f_out, const double* in, const double* out, int from,
               bool& possible) const;
  /// Whether the limits hold with this delay, sample by sample; a leg at rest has velocities of 0.
  bool holds(const Filter& filter_in, const Filter& filter_out, const double* in, const double* out, int delay) const;

 private:
  struct Peaks {
    double tap = 0.0, step = 0.0;  // largest tap and difference of neighbours
  };
  bool any_delay_holds(std::size_t f_in, std::size_t f_out, const double* in, const double* out, int from) const;

  const LegFilters& filters_;
  const Machine& machine_;
  double period_;
  std::vector<Peaks> peaks_;          // of every filter
  std::vector<std::size_t> limited_;  // axes with any limit
};

}  // namespace accdec
