#pragma once

#include <vector>

#include <accdec/certificate/interval.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The checker's own taps r_0 .. r_R of what follows the designed filter: the control's smoothing and the servo, which
/// must be that of all axes.
class CheckedResponse {
 public:
  /// @throws Rejected if axes differ, a tap is negative, or a gain or taps are out of range
  explicit CheckedResponse(const Task& task);
  bool smooths() const { return smooths_; }  ///< the control does, before the servo
  bool ideal() const { return !smooths_ && !follows_; }
  /// @throws Rejected if there is a response: for rows that are known only without it
  void require_ideal() const;
  /// Taps of the smoothing; {1} without. Each tap of the command behind it is sum_j g_j b_{i-j}.
  const std::vector<Interval>& command() const { return command_; }
  /// The same of the motion behind the servo.
  const std::vector<Interval>& motion() const { return motion_; }
  /// Middles of the taps of the smoothing and of the servo; {1} without.
  const std::vector<double>& smoothing() const { return smoothing_; }
  const std::vector<double>& servo() const { return servo_; }
  int longer() const { return static_cast<int>(gone_.size()) - 1; }
  /// Weight of a tap in the distance that leg 1 has left, x samples before it counts without a response:
  /// sum_j r_j max(0, x + j).
  Interval left(int x) const;
  /// Weight of a tap in the distance that leg 2 has gone, y samples after it counts without a response:
  /// sum_j r_j max(0, y - j).
  Interval gone(int y) const;

 private:
  bool smooths_ = false, follows_ = false;
  std::vector<double> smoothing_{1.0}, servo_{1.0};
  std::vector<Interval> command_{Interval(1.0)}, motion_{Interval(1.0)};
  std::vector<Interval> left_, gone_;  // of x = 0, -1 .. and y = 0, 1 ..
};

}  // namespace accdec
