#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include <accdec/corner.hpp>

namespace accdec {

/// The verifier's contour deviation: the largest distance of the polyline through the samples from the nearer of the
/// two programmed legs. Leg 1 is the ray from the corner point against its direction, leg 2 the ray along its own.
class ContourWatch {
 public:
  explicit ContourWatch(const Corner& corner) : back_(-corner.direction_in), forward_(corner.direction_out) {}

  /// The next sample of the motion, m from the corner point.
  void add(const Eigen::VectorXd& x, int sample);
  double deviation() const { return deviation_; }  ///< m, so far
  /// The time at which it is so large, in samples: a fraction on the chord between two.
  double time() const { return time_; }
  /// The sample there, or that before the chord.
  int sample() const { return static_cast<int>(std::floor(time_)); }

 private:
  void note(double distance, double time);
  /// The largest distance on the chord to x, where the nearer leg changes.
  void note_between(const Eigen::VectorXd& x, int sample);

  Eigen::VectorXd back_, forward_, previous_{};
  double to_back_ = 0.0, to_forward_ = 0.0, deviation_ = 0.0, time_ = 0.0;
};

/// The largest distance of rows `first` .. `last` from a leg's line, m. At constant feed, servos that differ keep it,
/// so it is the contour deviation of a leg far from its corner.
double off_line(const Eigen::MatrixXd& positions, int first, int last, const Eigen::VectorXd& direction);

/// Distance of a path from the nearer leg: at every sample, and between two where it is largest there.
struct PathDistance {
  std::vector<double> time, distance;  ///< samples, fractions between two; m
};
/// @param positions  of the samples, one a row, m from the corner point
PathDistance path_distance(const Eigen::MatrixXd& positions, const Corner& corner);

}  // namespace accdec
