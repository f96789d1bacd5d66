#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/considered_by.hpp>

namespace accdec {

/// The response between the designed filter and the motion: the control's own smoothing, the same for all axes, and
/// then the servo of each axis.
///
/// The limits of velocity, acceleration, jerk and residual vibration are of the command, which is the designed filter
/// behind the smoothing. Force, power, regeneration, errors and the smallest speed are of the motion behind the servo.
///
/// A position control of gain Kv with the part g of the velocity fed forward follows a command that is constant within
/// each sample as the taps
///   r_0 = 1 - c,  r_k = c (1 - a) a^(k-1),  a = exp(-Kv T),  c = (1 - g)(1 - a)/(Kv T).
/// They are not negative and have the sum 1. The following error at feed v is v (1 - g)/Kv. The taps end where less
/// than `response_rest` is left, which the last tap takes.
class Response {
 public:
  /// @param period  s, > 0
  /// @throws std::invalid_argument on a gain, a feedforward or taps outside their ranges, and on a servo that needs
  /// more than `response_taps_max` taps
  Response(const Machine& machine, double period);

  /// Neither smoothing nor servo: the filtered command is the motion.
  bool ideal() const { return prefilter_.empty() && servo_.empty(); }
  /// One response of all axes, without negative taps. The motion is then that of one filter, see `motion`.
  bool common() const { return common_; }
  /// No servo has a negative tap: formulas hold for the filter of every axis, see FilterBehind.
  bool averages() const { return averages_; }
  /// Taps of the smoothing, and of one axis' servo; {1} where there is none.
  std::vector<double> prefilter() const { return prefilter_.empty() ? std::vector{1.0} : prefilter_; }
  std::vector<double> servo(std::size_t axis) const { return servo_.empty() ? std::vector{1.0} : servo_[axis]; }
  /// Taps less one of the smoothing, and of the longest servo: by how many samples they lengthen every motion.
  int prefilter_order() const { return prefilter_.empty() ? 0 : static_cast<int>(prefilter_.size()) - 1; }
  int servo_order() const { return servo_order_; }
  int order() const { return prefilter_order() + servo_order_; }

  /// The designed filter behind the smoothing.
  Filter command(const Filter& designed) const;
  /// The same behind the servo: the filter of the motion, as the response is linear and the same for all axes.
  /// @throws std::logic_error unless `common`
  Filter motion(const Filter& designed) const;
  /// The same of one axis; of either sign if the servo's taps are.
  Filter motion(const Filter& designed, std::size_t axis) const;

 private:
  std::vector<double> prefilter_;
  std::vector<std::vector<double>> servo_;  ///< one an axis; empty if no axis has any
  int servo_order_ = 0;
  bool common_ = true, averages_ = true;
};

/// Part of a servo's response at which its taps end.
inline constexpr double response_rest = 1e-12;
/// A longer response is refused.
inline constexpr int response_taps_max = 50'000;

/// Number of taps of a servo's response, as a real number.
double response_length(double servo_gain, double velocity_feedforward, double period);

/// The designed filter behind a machine's response, as command and as motion. Without a response both are the filter
/// itself, which is not copied.
class FilterBehind {
 public:
  /// Keeps the reference to the filter.
  FilterBehind(const Filter& designed, const Machine& machine, double period);
  FilterBehind(const FilterBehind&) = delete;
  FilterBehind& operator=(const FilterBehind&) = delete;

  bool ideal() const { return motions_.empty(); }
  /// Whether no one filter without negative taps moves all axes: closed forms of one filter do not hold.
  bool differs() const { return alike_.has_value(); }
  /// The motion's filters where they are others: one for all axes, or one an axis. Empty if ideal.
  std::span<const Filter> servo() const { return motions_; }
  const Filter& command() const { return command_ ? *command_ : designed_; }
  /// The motion's filter. If it differs, that of the slowest axis without negative taps, for first guesses.
  const Filter& motion() const { return ideal() ? designed_ : alike_ ? *alike_ : motions_.front(); }
  const Filter& motion(std::size_t axis) const {
    return ideal() ? designed_ : motions_[motions_.size() == 1 ? 0 : axis];
  }
  int longest_order() const;
  /// How much larger velocities and accelerations of the motion may be than the command's: 1 without negative taps.
  double gain() const { return gain_; }
  /// By how many samples the motion is longer than the designed filter's.
  int longer() const { return motion().order() - designed_.order(); }
  /// Order of the motion's filter as far as a planner has to see: without a servo's tail of less than 1e-4.
  int felt_order() const;

 private:
  const Filter& designed_;
  std::optional<Filter> command_;
  std::vector<Filter> motions_;
  std::optional<Filter> alike_;
  double gain_ = 1.0;
};

/// Whether some axis has a servo.
bool has_servo(const Machine& machine);
/// Whether the servos of two axes differ.
bool servos_differ(const Machine& machine);
/// An axis whose measured response has no negative taps any more: only averaging ones have a filter.
Axis averaging(Axis axis);
/// Gives all axes the servo of the one that lags most.
void give_slowest_servo(Machine& machine, double period);
/// @throws std::invalid_argument if an axis has a servo, which `what` does not consider
void require_no_servo(const Machine& machine, const char* what, std::string_view instead = considered_by);
/// The same for the control's own smoothing, too.
void require_no_response(const Machine& machine, const char* what, std::string_view instead = considered_by);

}  // namespace accdec
