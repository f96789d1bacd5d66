#pragma once

#include <string>
#include <vector>

#include <accdec/motion/circle.hpp>

namespace accdec::paper {

/// One Acc/Dec processor on a circle at constant feed.
struct CircleRow {
  std::string name;
  int order = 0;
  CircleError error;
};

inline constexpr double circle_radius = 0.010;  ///< m; the paper prints no circle
inline constexpr double circle_feed = 0.1;      ///< m/s, the feed of Fig. 12

/// The processors of Fig. 12 at their common order, then the trapezoids and the boxcar with the FIR's own peak
/// acceleration and jerk, on one circle.
std::vector<CircleRow> circle_rows();

/// "The circular contour error caused by the FIR Acc/Dec scheme is also smaller": table and verdict in Markdown.
std::string circle_text();

}  // namespace accdec::paper
