#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// m, of a full-speed sample of a block: the way that the control watches.
/// @param by_axis  of the fastest axis; else along the path
double sample_way(const Toolpath& path, std::size_t b, double sample_period, bool by_axis);

/// Samples guessed for a program at its feeds, every corner with the delay that it needs by itself.
class PairwiseTimes {
 public:
  /// Keeps the reference to the filter.
  /// @param effort       counts the work
  /// @param slow_curves  lower the feeds inside legs to those that need no delay
  PairwiseTimes(Toolpath path, const Filter& filter, double sample_period, const Machine& machine, Effort& effort,
                bool slow_curves);

  /// With delays of any number of samples.
  double any() const { return any_; }
  /// The same with lower feeds in place of the delays inside legs. Where limits lower feeds, too, only the longer loss
  /// counts.
  /// @param lost  samples, see lost_on_curves
  double any_slowed(double lost) const { return any_ - on_curves_ + std::max(0.0, lost - by_limits_); }
  /// Whether joints inside legs need delays at the feeds of the program.
  bool curves_delayed() const { return curves_delayed_; }
  /// With the control's delays; `unlimited` if it has none that do.
  double with(const ControlDelays& control) const;

 private:
  struct Held {
    double step, step_of_axis;  // m, of the leg that ends there, and of its fastest axis
    int delay;
  };
  const Filter& filter_;
  double any_ = 0.0;
  double on_curves_ = 0.0;  // samples, of delays inside legs
  double by_limits_ = 0.0;  // samples, of feeds that limits lower
  bool curves_delayed_ = false;
  std::vector<Held> joints_;
};

/// Samples that a program takes longer if its feeds inside legs are those that need no delay, see curve_feeds.
/// `unlimited` if it has too many joints to look at.
double lost_on_curves(Toolpath path, const Filter& filter, double sample_period, const Machine& machine,
                      Effort& effort);

/// What lower feeds on curves cost depends on the standard deviation of the taps alone, as long as the curves are longer
/// than the filter. Values are found for few deviations and interpolated between them.
class KnownBySpread {
 public:
  /// @param spread  > 0  @param find  the value at this one
  double at(double spread, const std::function<double()>& find);

 private:
  std::map<double, double> known_;
};

}  // namespace accdec
