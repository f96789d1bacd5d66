#include <algorithm>

#include <accdec/task/verified_contour.hpp>

namespace accdec {
namespace {

/// Distance of a point from the ray along `outward` from the corner point.
double leg_gap(const Eigen::VectorXd& x, const Eigen::VectorXd& outward) {
  const double along = std::max(0.0, x.dot(outward));
  return (x - along * outward).norm();
}

}  // namespace

void ContourWatch::note(double distance, int sample) {
  if (distance > deviation_) deviation_ = distance, sample_ = sample;
}

double ContourWatch::between(const Eigen::VectorXd& x) const {
  double low = 0.0, high = 1.0;
  Eigen::VectorXd middle;
  for (int i = 0; i < 60; ++i) {
    const double at = 0.5 * (low + high);
    middle = previous_ + at * (x - previous_);
    (leg_gap(middle, back_) < leg_gap(middle, forward_) ? low : high) = at;
  }
  middle = previous_ + low * (x - previous_);
  return std::min(leg_gap(middle, back_), leg_gap(middle, forward_));
}

void ContourWatch::add(const Eigen::VectorXd& x, int sample) {
  const double to_back = leg_gap(x, back_), to_forward = leg_gap(x, forward_);
  if (previous_.size() > 0 && to_back_ < to_forward_ && to_back > to_forward) note(between(x), sample - 1);
  note(std::min(to_back, to_forward), sample);
  previous_ = x;
  to_back_ = to_back, to_forward_ = to_forward;
}

}  // namespace accdec
