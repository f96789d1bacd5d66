#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {

/// Checks the ends of a proof's tree: parts of all designs that no filter is in.
class CheckedLeaves {
 public:
  /// References are kept.
  /// @param stop  asked again and again; once true the proof is rejected
  CheckedLeaves(const Task& task, const std::vector<proof::Multipliers>& multipliers, const std::function<bool()>& stop)
      : rows_(task), multipliers_(multipliers), stop_(stop) {}

  const CheckedRows& rows() const { return rows_; }
  /// Samples by which the machine's response lengthens the motion.
  int longer() const { return rows_.longer(); }
  /// @param symmetric  only symmetric filters of exactly the box's order are to be refuted
  /// @throws Rejected if the rows times their multipliers may hold somewhere in the box
  void refute(int multipliers, CheckedBox box, bool symmetric);
  /// The same of all instants of the box. The tangents of the corner's error in one direction are linear in the
  /// instant. So it is above its bound at all of them if it is at both ends.
  void refute_instants(const proof::RefutedInstants& node, CheckedBox box, bool symmetric);
  /// @throws Rejected if a filter may have a response within the box's cuts
  void require_unreachable(const CheckedBox& box);
  std::size_t checked() const { return checked_; }

 private:
  const proof::Multipliers& set(int index) const;
  /// Lower ends of the sum's coefficients on taps, with responses written as sums of taps.
  std::vector<double> least_of_taps(CheckedSum& sum, bool symmetric) const;

  CheckedRows rows_;
  const std::vector<proof::Multipliers>& multipliers_;
  const std::function<bool()>& stop_;
  std::size_t checked_ = 0;
};

}  // namespace accdec
