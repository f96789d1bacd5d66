#pragma once

#include <cmath>
#include <utility>

#include <accdec/plot/figure.hpp>

// Internal to the room: what a panel's axes reach over.

namespace accdec {

struct Range {
  double low = INFINITY, high = -INFINITY;
  void add(double x);
};

/// Ranges of x and y of a panel that is drawn `width` by `height` px: of its data with a little air, or as its scales
/// say; with an equal aspect the one that has room is widened.
std::pair<Range, Range> panel_frame(const Panel& panel, double width, double height);

}  // namespace accdec
