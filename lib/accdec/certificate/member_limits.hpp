#pragma once

#include <memory>
#include <optional>

#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/family_members.hpp>
#include <accdec/machine.hpp>

// Internal to the room: what a member of a family breaks, for the check of proof::FamilyEnumeration.

namespace accdec {

/// The checker's own sums over the samples of legs and corners behind one member, and behind the machine's response.
/// Limits that it calls broken are. It need not see every one: loads of axes with dry friction that hardly move are
/// left out, and so is a supply that axes share.
class MemberLimits {
 public:
  /// @param granted   the task with limits wider than written, as verification grants them; kept, as is the member
  /// @param response  of the task's machine
  MemberLimits(const Task& granted, const FamilyMember& member, const CheckedResponse& response);

  /// The remaining way that a control's in-position check sees, samples at full speed: p(k).
  const std::vector<double>& way_watched() const {
    return granted_.settings->in_position_actual ? motion().way_left : command().way_left;
  }
  /// Order of the filter behind the control's smoothing.
  int command_order() const { return command().order(); }
  /// From here on, longer delays change nothing.
  int longest_delay() const { return order_behind_ + 2; }
  /// A limit that a leg breaks which starts from rest or stops.
  std::optional<LimitKind> broken_by_legs() const;
  /// Whether a vibration is left that is too large. It is looked for at frequencies closer together than the response
  /// can hide a peak between, and at a few damping ratios.
  bool rings() const;
  bool broken_by_blend(const TaskCorner& corner, int delay) const;
  bool contour_broken(const TaskCorner& corner, int delay, int last) const;
  /// Whether the corner is too slow at this delay and all longer ones. If legs do not turn back, leg 2 is slower
  /// sample by sample at a longer delay, and nothing makes up for it.
  bool too_slow_from(const TaskCorner& corner, int delay) const;
  /// Whether a corner at this part of its feeds breaks a limit, or the step down to it or up from it does.
  bool broken_by_corner_feed(const TaskCorner& corner, double part) const;
  /// A delay below which the corner's error is too large. At every shorter delay, leg 2 is at least as far away sample
  /// by sample. The nearest of all such positions therefore bounds the error of them all.
  /// @param between  the motion's positions between samples count, too
  int least_delay(const TaskCorner& corner, bool between = false) const;
  /// Whether the error is too large at this delay and all shorter ones, at this part of both feeds.
  bool too_far(const TaskCorner& corner, int delay, bool between, double part = 1.0) const;

 private:
  const FamilyMember& command() const { return command_ ? *command_ : member_; }
  const FamilyMember& motion() const;
  struct Steepness;
  const Steepness& steepness() const;
  /// @param more  (m/s)^2, by which the square of the speed may be larger
  bool too_slow(const TaskCorner& corner, int delay, double more) const;
  bool legs_hold_together(const Steepness& steep) const;
  std::optional<LimitKind> broken_by_leg(const Steepness& steep, const Axis& axis, double in, double out) const;
  double left(double frequency, double damping) const;

  const Task& granted_;
  const FamilyMember& member_;
  std::optional<FamilyMember> command_;  ///< behind the control's smoothing, where it has any
  const std::vector<double>& servo_;
  int order_behind_;  ///< of the motion
  mutable std::shared_ptr<const Steepness> steepness_;
  mutable std::optional<FamilyMember> motion_;  ///< behind the servo, where it is given: made when it is asked for
};

/// Whether an axis keeps all its limits at all speeds and accelerations up to these, by more than rounding. Unknown
/// with a curve of force over speed.
/// @param speed  m/s  @param acceleration  m/s^2  @param step  m/s^2, from sample to sample
bool surely_holds(const Axis& axis, double speed, double acceleration, double step, double period);

/// A delay below which the corner's error is too large behind this response, whatever non-negative taps come before it.
/// The ways p and q behind the response are convex over time. By Jensen's inequality, those behind taps as well are at
/// least as long as they are earlier by the taps' mean delay.
int least_delay_behind(const CheckedResponse& response, const TaskCorner& corner, double period);

}  // namespace accdec
