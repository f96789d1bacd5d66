#pragma once

#include <optional>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::exact {

/// The control's own smoothing behind the designed taps. Limits of velocity, acceleration, jerk and vibration are of
/// the command behind it, whose taps are c_i = sum_j g_j b_{i-j}.
class Smoothing {
 public:
  explicit Smoothing(const Machine& machine);

  bool none() const { return taps_.size() == 1; }
  /// By how many samples the command is longer than the designed taps.
  int order() const { return static_cast<int>(taps_.size()) - 1; }
  /// A designed tap is at most a bound on the command's taps over this, as the command has each of them times this.
  double largest() const;
  /// The command of a designed filter. Without smoothing that is the filter itself.
  const Filter& command(const Filter& designed, std::optional<Filter>& made) const;
  /// Adds to the coefficients of the designed taps those that the command's taps have: a_i += sum_j g_j c_{i+j}.
  /// @param command  one per tap of the command, which are `order` more than designed ones
  void add_designed(std::span<const double> command, std::span<double> designed) const;

 private:
  Response response_;  ///< without servos
  std::vector<double> taps_;
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
