#pragma once

#include <Eigen/Core>

namespace accdec {

enum class Turn { left, right };

/// Two straight legs that meet in the corner point, in any number of axes (columns = machine axes).
struct Corner {
  Eigen::VectorXd direction_in;   ///< unit vector of travel on leg 1, into the corner
  Eigen::VectorXd direction_out;  ///< unit vector of travel on leg 2, out of the corner; same size
  double feed_in = 0.0;           ///< leg 1 speed v1, m/s, > 0
  double feed_out = 0.0;          ///< leg 2 speed v2, m/s, > 0

  Eigen::Index axes() const { return direction_in.size(); }
  /// cos(theta) of the interior angle: -u1 . u2, clamped to [-1, 1]; theta = 180 deg is straight on.
  double cos_interior() const;
};

/// Corner from two direction vectors of any positive length and equal size (>= 1).
/// @throws std::invalid_argument on a zero or non-finite vector, unequal sizes, or a feed that is not positive and
/// finite.
Corner make_corner(const Eigen::VectorXd& direction_in, const Eigen::VectorXd& direction_out, double feed_in,
                   double feed_out);

/// Corner in the plane of the first two of `axes` axes (>= 2).
/// @param interior_angle  rad, 0 < angle <= pi
/// @param heading         travel direction on leg 1 from +x towards +y, rad
/// @throws std::invalid_argument on values outside these ranges.
Corner planar_corner(double interior_angle, double heading, Turn turn, double feed_in, double feed_out, int axes = 2);

}  // namespace accdec
