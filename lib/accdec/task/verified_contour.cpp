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

void ContourWatch::note(double distance, double time) {
  if (distance > deviation_) deviation_ = distance, time_ = time;
}

void ContourWatch::note_between(const Eigen::VectorXd& x, int sample) {
  double low = 0.0, high = 1.0;
  Eigen::VectorXd middle;
  for (int i = 0; i < 60; ++i) {
    const double at = 0.5 * (low + high);
    middle = previous_ + at * (x - previous_);
    (leg_gap(middle, back_) < leg_gap(middle, forward_) ? low : high) = at;
  }
  middle = previous_ + low * (x - previous_);
  note(std::min(leg_gap(middle, back_), leg_gap(middle, forward_)), sample - 1 + low);
}

void ContourWatch::add(const Eigen::VectorXd& x, int sample) {
  const double to_back = leg_gap(x, back_), to_forward = leg_gap(x, forward_);
  if (previous_.size() > 0 && to_back_ < to_forward_ && to_back > to_forward) note_between(x, sample);
  note(std::min(to_back, to_forward), sample);
  previous_ = x;
  to_back_ = to_back, to_forward_ = to_forward;
}

double off_line(const Eigen::MatrixXd& positions, int first, int last, const Eigen::VectorXd& direction) {
  double most = 0.0;
  for (int n = first; n <= last; ++n) {
    const Eigen::VectorXd x = positions.row(n).transpose();
    most = std::max(most, (x - x.dot(direction) * direction).norm());
  }
  return most;
}

PathDistance path_distance(const Eigen::MatrixXd& positions, const Corner& corner) {
  PathDistance path;
  const Eigen::VectorXd back = -corner.direction_in;
  for (Eigen::Index n = 0; n < positions.rows(); ++n) {
    const Eigen::VectorXd x = positions.row(n).transpose();
    const double here = std::min(leg_gap(x, back), leg_gap(x, corner.direction_out));
    if (n > 0) {
      ContourWatch chord(corner);
      chord.add(positions.row(n - 1).transpose(), static_cast<int>(n - 1)), chord.add(x, static_cast<int>(n));
      // If the nearer leg changes at a sample, only rounding sets the largest distance apart from that sample.
      if (chord.deviation() > (1.0 + 1e-12) * std::max(path.distance.back(), here) &&
          chord.time() != std::floor(chord.time()))
        path.time.push_back(chord.time()), path.distance.push_back(chord.deviation());
    }
    path.time.push_back(static_cast<double>(n)), path.distance.push_back(here);
  }
  return path;
}

}  // namespace accdec
