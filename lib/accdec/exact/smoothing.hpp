#pragma once

#include <optional>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::exact {

/// Fixed taps g_j behind the designed taps b_i: together c_i = sum_j g_j b_{i-j}. Limits of velocity, acceleration,
/// jerk and vibration are of the command behind the control's own smoothing. Forces are of the motion behind the servo,
/// too.
class Smoothing {
 public:
  static Smoothing of_command(const Machine& machine);
  /// @param machine  of one response of all axes, see machine/response.hpp  @param period  s
  static Smoothing of_motion(const Machine& machine, double period);

  bool none() const { return order() == 0; }
  /// By how many samples the result is longer than the designed taps.
  int order() const { return taps_.order(); }
  /// A designed tap is at most a bound on the taps behind over this, as they have each designed tap times this.
  double largest() const { return largest(0, order()); }
  /// The largest from the first to the last of these; 0 if there is none.
  double largest(int first, int last) const;
  /// Part of designed tap i in tap n behind, by n - i, and in the cumulative response at n.
  double tap(int after) const { return taps_.tap(after); }
  double sum(int after) const { return taps_.cumulative(after); }
  /// The designed filter and these taps as one. Without smoothing it is the filter itself.
  const Filter& behind(const Filter& designed, std::optional<Filter>& made) const;
  /// Adds to the coefficients of the designed taps those that the command's taps have: a_i += sum_j g_j c_{i+j}.
  /// @param command  one per tap of the command, which are `order` more than designed ones
  void add_designed(std::span<const double> command, std::span<double> designed) const;

 private:
  explicit Smoothing(Response response);

  Response response_;
  Filter taps_;
};

/// A weighted sum of designed taps, and of taps and cumulative responses of the command behind a smoothing.
class WeightedTaps {
 public:
  /// Keeps the reference. @param order  of the designed filter
  WeightedTaps(const Smoothing& smoothing, int order);

  /// Coefficients of the designed taps, and of the command's.
  std::span<double> designed() { return designed_; }
  std::span<double> command() { return smoothing_.none() ? std::span(designed_) : std::span(command_); }
  void add_response(int sample, double c) { sums_[static_cast<std::size_t>(sample)] += c; }
  /// The whole sum as coefficients of the designed taps. Call once, at the end.
  std::vector<double>& all();

 private:
  const Smoothing& smoothing_;
  std::vector<double> designed_, command_, sums_;
};

}  // namespace accdec::exact
