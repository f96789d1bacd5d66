#pragma once

#include <optional>

#include <accdec/exact/workbench.hpp>

namespace accdec::exact {

/// A bound without linear programs, which take seconds each at thousands of taps. Two facts give it. Taps are bounded,
/// so that the filter has at least so many of them. And over all filters with such taps, one row of the error of a
/// single corner refutes a range of samples at delays that are too short.
class QuickBound {
 public:
  /// References are kept.
  explicit QuickBound(Workbench& bench) : bench_(bench), model_(bench.model()) {}

  /// The proof of the largest target found by halving, up to 0.2 %. None if nothing is proved.
  /// @param high  samples; nothing above is tried
  std::optional<Proof> prove(double high);

 private:
  bool refute(double target);
  bool close(const Box& whole);
  /// The multiplier of one row that refutes the box.
  std::optional<Multipliers> refuting(const Box& box) const;
  /// By how much the row of an angle refutes the box; not positive: it does not.
  double refuted_by(const Box& box, double angle) const;

  Workbench& bench_;
  const LimitModel& model_;
  int nodes_ = 0;
};

}  // namespace accdec::exact
