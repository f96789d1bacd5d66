#pragma once

#include <complex>
#include <string>
#include <vector>

#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/family_members.hpp>

// Internal to the room: members that break a limit by their lengths alone, for the check of proof::FamilyEnumeration.

namespace accdec {

/// Refutes moving averages with impulses behind them before their taps are made. There are a hundred times as many as
/// those that need them.
///  * Some tap is at least the largest impulse's weight times the largest tap of the averages. This tap is 1 over the
///    longest average, if that one is as long as the others in series. Otherwise it is at least 1 over their number.
///  * Neighbouring taps of the averages differ by 1 over the product of the two longest ones, a >= b: the difference of
///    an average of length a is 1/a at its first sample, and then nothing until a samples later. Behind the third one,
///    of length c, this lasts from sample c - 1 to b - 1. At sample b - 1 the first impulse's part is added to that of
///    all impulses up to b - c samples later.
///  * The rest of a vibration is a product, one factor for each average and one for the impulses.
class RefutedOutlines {
 public:
  /// @param granted    the task with the limits that verification grants
  /// @param order_end  no member is longer
  RefutedOutlines(const Task& granted, const CheckedResponse& response, int order_end);

  /// The limit that is broken; null: none is seen.
  const char* rule(const AveragesOutline& outline) const;
  /// Whether every start and stop surely holds the limits. No tap is larger than 1 over the longest average. No two
  /// neighbours differ by more than the impulses within the second longest, over the product of both.
  bool legs_hold(const AveragesOutline& outline) const;

 private:
  /// A frequency with a damping ratio: its turn from sample to sample, and what it leaves behind averages by length.
  struct Line {
    std::complex<double> turn;
    double allowed;  ///< over what the control's smoothing leaves
    std::vector<double> left;
  };
  bool rings(const AveragesOutline& outline, double weight) const;

  struct FastestLeg {
    const Axis* axis;
    double speed;
  };
  double period_;
  std::vector<FastestLeg> legs_;  ///< of each axis
  double tap_max_, step_max_;     ///< more breaks an acceleration or a jerk
  std::vector<Line> lines_;
};

}  // namespace accdec
