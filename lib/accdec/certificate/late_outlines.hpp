#pragma once

#include <array>
#include <vector>

#include <accdec/certificate/family_members.hpp>

// Internal to the room: members that are late as shorter ones were, for the check of proof::FamilyEnumeration.

namespace accdec {

/// Which members are late because a member was that is in no stage longer. Only the largest ones of these are compared
/// with their limits.
///
/// Averages of more samples, and impulses farther apart, spread the taps around their middle: for every convex f,
/// sum_i b_i f(i - M) is at least as large. Both ways of a corner are such sums, p(k) of f = max(i - k, 0) and q of
/// f = max(m - i, 0). So the longer member is nowhere nearer to the corner than the shorter one was earlier, by the
/// difference of their mean delays. If that is not whole, the earlier position lies between two samples. The longer
/// member thus needs delays at least as long, and its filter costs more.
class LateOutlines {
 public:
  /// Whether such a member was late. Outlines are asked about in the order of visit_family.
  bool covers(const AveragesOutline& outline);
  /// The outline asked about last is late by its errors. @param between  and if positions between samples count, too
  void remember(bool between);
  /// Whether remembering it between samples would tell more.
  bool asks_between() const;

 private:
  static constexpr std::size_t classes = 3;  ///< even and odd order, and any mean delay
  struct Place {
    std::vector<int> before;  ///< lengths but the last one that varies
    double last = 0.0;        ///< that one, or twice the mean delay of the impulses
    std::size_t parity = 2;   ///< 2: twice the mean delay is not whole
  };
  static Place place_of(const AveragesOutline& outline);
  void enter(const std::vector<int>& before);

  Place asked_;
  std::vector<std::array<double, classes>> from_;  ///< by the last of `before`: late from here on
  std::array<double, classes>* here_ = nullptr;
};

}  // namespace accdec
