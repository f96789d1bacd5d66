#pragma once

#include <utility>
#include <vector>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/path_panels.hpp>

// Internal to the library.

namespace accdec {

/// The time that panels show, ms from the corner command: from the first motion to the last. Behind a servo, simulated
/// legs are long, for the axes settle on them. The steady parts of these legs are left out: before and behind them the
/// speed is that of the feed to 0.1 %.
class ShownTime {
 public:
  /// @param before  motion of today's filter, or null
  ShownTime(const CornerMotion& now, const CornerMotion* before);

  /// With some air at both ends.
  std::pair<double, double> range() const;
  bool shortened() const { return !left_out_.empty(); }
  /// Moves what a panel draws together. Its range stays.
  void move_together(Panel& panel) const;

 private:
  double shown(double time) const;

  std::vector<std::pair<double, double>> left_out_;
  double from_ = 0.0, to_ = 0.0;
};

}  // namespace accdec
