#pragma once

#include <cmath>
#include <utility>

#include <accdec/plot/figure.hpp>

// Internal to this folder: the ranges of a panel's axes.

namespace accdec {

struct AxisRange {
  double low = INFINITY, high = -INFINITY;
  void add(double x);
};

/// Ranges of x and y of a panel that is drawn `width` by `height` px. They follow its data with a small margin, or its
/// scales. With an equal aspect, the axis that has room is widened.
std::pair<AxisRange, AxisRange> panel_frame(const Panel& panel, double width, double height);

}  // namespace accdec
