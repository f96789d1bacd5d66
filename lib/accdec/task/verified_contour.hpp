#pragma once

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
  /// The sample at which it is so large, or that before the chord on which it is.
  int sample() const { return sample_; }

 private:
  void note(double distance, int sample);
  /// Largest distance on the chord to x, where the nearer leg changes.
  double between(const Eigen::VectorXd& x) const;

  Eigen::VectorXd back_, forward_, previous_{};
  double to_back_ = 0.0, to_forward_ = 0.0, deviation_ = 0.0;
  int sample_ = 0;
};

}  // namespace accdec
