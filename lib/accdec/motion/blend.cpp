#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/corner.hpp>
#include <accdec/motion/least_held.hpp>
#include <accdec/motion/leg_distance.hpp>

namespace accdec {
namespace {

/// Distance of the origin from the segment between points given by leg coordinates.
double segment_distance(double p0, double q0, double p1, double q1, double c) {
  const double dp = p1 - p0, dq = q1 - q0;
  // Inner product of leg coordinates: <(p,q),(r,s)> = p r + q s + c (p s + q r).
  const double length2 = dp * dp + dq * dq + 2.0 * c * dp * dq;
  if (length2 <= 0.0) return leg_distance(p0, q0, c);
  const double along = -(p0 * dp + q0 * dq + c * (p0 * dq + q0 * dp)) / length2;
  const double t = std::clamp(along, 0.0, 1.0);
  return leg_distance(p0 + t * dp, q0 + t * dq, c);
}

}  // namespace

Blend::Blend(const Filter& filter_in, const Filter& filter_out, const Corner& corner, int delay, double sample_period)
    : filter_in_(filter_in),
      filter_out_(filter_out),
      corner_(corner),
      delay_(delay),
      first_(std::min(0, delay)),
      last_(std::max(filter_in.order(), filter_out.order() + delay) + 1),
      sample_period_(sample_period),
      step_in_(corner.feed_in * sample_period),
      step_out_(corner.feed_out * sample_period),
      cos_interior_(corner.cos_interior()) {
  if (!(sample_period > 0.0) || !std::isfinite(sample_period)) {
    throw std::invalid_argument(fmt::format("sample period must be positive and finite, got {} s", sample_period));
  }
}

Eigen::VectorXd Blend::position(int k) const {
  return -distance_in(k) * corner_.direction_in + distance_out(k) * corner_.direction_out;
}

Eigen::VectorXd Blend::velocity(int k) const {
  return speed_in(k) * corner_.direction_in + speed_out(k) * corner_.direction_out;
}

Eigen::VectorXd Blend::acceleration(int k) const {
  const double in = -filter_in_.tap(k - 1) * corner_.feed_in / sample_period_;
  const double out = filter_out_.tap(k - 1 - delay_) * corner_.feed_out / sample_period_;
  return in * corner_.direction_in + out * corner_.direction_out;
}

Eigen::VectorXd Blend::jerk(int k) const {
  return (acceleration(k) - acceleration(k - 1)) / sample_period_;
}

double Blend::distance(int k) const {
  return leg_distance(distance_in(k), distance_out(k), cos_interior_);
}

double Blend::tangential_speed(int k) const {
  return leg_distance(speed_in(k), speed_out(k), -cos_interior_);
}

CornerMeasures measure(const Blend& blend) {
  const double c = blend.corner().cos_interior();
  const double sine = std::sqrt(std::max(0.0, (1.0 - c) * (1.0 + c)));
  CornerMeasures m;
  m.corner_error = blend.distance(blend.first_sample());
  m.corner_error_sample = m.speed_min_sample = blend.first_sample();
  m.polyline_error = m.corner_error;
  m.speed_min = blend.tangential_speed(blend.first_sample());
  double p0 = blend.distance_in(blend.first_sample()), q0 = blend.distance_out(blend.first_sample());
  double deviation = std::min(p0, q0);
  for (int k = blend.first_sample() + 1; k <= blend.last_sample(); ++k) {
    const double p1 = blend.distance_in(k), q1 = blend.distance_out(k);
    const double error = leg_distance(p1, q1, c);
    if (error < m.corner_error) {
      m.corner_error = error;
      m.corner_error_sample = k;
    }
    const double speed = blend.tangential_speed(k);
    if (speed < m.speed_min) {
      m.speed_min = speed;
      m.speed_min_sample = k;
    }
    m.polyline_error = std::min(m.polyline_error, segment_distance(p0, q0, p1, q1, c));
    // Inside the wedge the nearer leg is min(p, q) sin(theta) away. As p falls and q rises, this distance is largest
    // where the polyline crosses p = q.
    deviation = std::max(deviation, std::min(p1, q1));
    if (p0 > q0 && p1 < q1) {
      const double t = (p0 - q0) / ((p0 - q0) + (q1 - p1));
      deviation = std::max(deviation, p0 + t * (p1 - p0));
    }
    p0 = p1;
    q0 = q1;
  }
  m.contour_deviation = deviation * sine;
  return m;
}

double corner_error(const Blend& blend) {
  // Find the smallest k whose successor is not nearer. Equal neighbours occur only where the motion rests (exact stop),
  // and there the distance is the minimum, 0.
  return blend.distance(least_held(blend.first_sample() - 1, blend.last_sample(),
                                   [&](int k) { return blend.distance(k) <= blend.distance(k + 1); }));
}

}  // namespace accdec
