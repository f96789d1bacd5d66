#pragma once

#include <map>
#include <optional>
#include <vector>

#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/checked_tube.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

/// How often the acceleration is differenced over T to give the limited value: the checker's own list. None: other
/// limits.
std::optional<int> checked_differences(LimitKind kind);
/// Dry friction is against a start and helps a stop: what it adds to the force limit.
Interval checked_friction(const Axis& axis, bool stop);
/// Signed speed of an axis along a leg, m/s.
Interval checked_speed(const TaskCorner& corner, std::size_t axis, bool in);

/// A corner's interior angle.
struct CheckedAngle {
  Interval cosine, sine;
};
CheckedAngle checked_angle(const Corner& corner);

/// Bounds on taps, their differences and the response that all corners together leave, at the fastest leg of every
/// axis.
class CheckedTapBounds {
 public:
  CheckedTapBounds(const Task& task, const CheckedResponse& response);
  double tap_max() const { return tap_max_; }  ///< of the designed taps
  /// Largest tap of the command behind the control's smoothing that the accelerations leave.
  double command_max() const { return command_max_; }
  /// Largest difference of the command's taps that a limit on differences of the acceleration leaves; unlimited where
  /// there is none.
  double ramp_max(LimitKind kind) const;
  /// Lower end of the largest speed at which the axis starts, or stops, m/s.
  double event_speed(std::size_t axis, bool stop) const { return (stop ? stop_ : start_)[axis]; }
  /// Bounds on the motion's responses within the cuts; none if no filter is left. Its taps and their differences are
  /// averages of the command's.
  std::optional<CheckedTube> tube(int order, const std::vector<CheckedCut>& cuts) const {
    return checked_tube(plants_, command_max_, ramp_max(LimitKind::jerk), order + longer_, cuts);
  }

 private:
  void add_plants(const Axis& axis, double start, double stop, const Interval& period);
  void add_limits(const Axis& axis, double start, double stop, const Interval& period, bool ideal);

  int longer_;  // order of the response
  double tap_max_ = 1.0, command_max_ = 1.0;
  std::map<LimitKind, double> ramp_max_;
  std::vector<double> start_, stop_;
  std::vector<CheckedPlant> plants_;
};

}  // namespace accdec
