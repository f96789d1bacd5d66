#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/corner.hpp>

namespace accdec {
namespace {

void require(bool good, const char* name, const char* range, double value) {
  if (!good || !std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("{} must be {} and finite, got {}", name, range, value));
  }
}

/// The positive root of s^3 - a s^2 + b s - 1, if there is only one: Newton's method inside a shrinking bracket.
double positive_root(double a, double b) {
  const double bound =
      1.0 + std::max({std::abs(a), std::abs(b), 1.0});  // Cauchy's; 1/s obeys the same cubic with a, b swapped
  double low = 1.0 / bound, high = bound, s = 1.0;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double value = ((s - a) * s + b) * s - 1.0;
    if (value == 0.0) break;
    (value < 0.0 ? low : high) = s;
    const double slope = (3.0 * s - 2.0 * a) * s + b;
    double next = s - value / slope;
    if (!(next > low && next < high)) next = std::sqrt(low * high);
    if (next == s) break;
    s = next;
  }
  return s;
}

}  // namespace

LinearCorner::LinearCorner(double interior_angle, double feed_in, double feed_out, double acc_dec_time, double delay)
    : sin_half_(std::sin(0.5 * interior_angle)),
      cos_half_(std::sin(0.5 * (std::numbers::pi - interior_angle))),  // exactly 0 for a straight pass
      cos_interior_(std::cos(interior_angle)),
      feed_in_(feed_in),
      feed_out_(feed_out),
      tau_(acc_dec_time),
      delay_(delay) {
  require(interior_angle > 0.0 && interior_angle <= std::numbers::pi, "interior angle", "in (0, pi]", interior_angle);
  require(feed_in > 0.0, "feed_in", "positive", feed_in);
  require(feed_out > 0.0, "feed_out", "positive", feed_out);
  require(acc_dec_time > 0.0, "Acc/Dec time", "positive", acc_dec_time);
  require(delay >= 0.0, "delay", "non-negative", delay);
}

double LinearCorner::distance_in(double t) const {
  if (t >= tau_) return 0.0;
  return t <= 0.0 ? feed_in_ * (0.5 * tau_ - t) : feed_in_ * (tau_ - t) * (tau_ - t) / (2.0 * tau_);
}

double LinearCorner::distance_out(double t) const {
  const double u = t - delay_;
  if (u <= 0.0) return 0.0;
  return u >= tau_ ? feed_out_ * (u - 0.5 * tau_) : feed_out_ * u * u / (2.0 * tau_);
}

Eigen::Vector2d LinearCorner::position(double t) const {
  const double p = distance_in(t), q = distance_out(t);
  return {(q - p) * sin_half_, (q + p) * cos_half_};
}

Eigen::Vector2d LinearCorner::velocity(double t) const {
  const double in = feed_in_ * std::clamp(1.0 - t / tau_, 0.0, 1.0);
  const double out = feed_out_ * std::clamp((t - delay_) / tau_, 0.0, 1.0);
  return {(out + in) * sin_half_, (out - in) * cos_half_};
}

double LinearCorner::distance(double t) const {
  return position(t).norm();
}

double LinearCorner::closest_time() const {
  if (delay_ >= tau_) return tau_;
  // z = c^(-2/3) s brings the outer coefficients to 1, whatever the ratio of the feeds.
  const double third = std::cbrt(feed_out_ / feed_in_);
  const double z = positive_root(cos_interior_ / third, cos_interior_ * third) / (third * third);
  return delay_ + (tau_ - delay_) * z / (1.0 + z);
}

double LinearCorner::sampled_corner_error(double sample_period) const {
  require(sample_period > 0.0, "sample period", "positive", sample_period);
  // The distance falls up to the closest instant and rises after it. So the nearest sample is one of the two beside it.
  const double k = std::floor(closest_time() / sample_period);
  return std::min(distance(k * sample_period), distance((k + 1.0) * sample_period));
}

double LinearCorner::approximate_corner_error() const {
  const double overlap = std::max(0.0, 1.0 - delay_ / tau_);
  return 0.5 * feed_in_ * tau_ * feed_out_ / (feed_in_ + feed_out_) * cos_half_ * overlap * overlap;
}

double LinearCorner::smallest_delay(double error_max) const {
  require(error_max >= 0.0, "error_max", "non-negative", error_max);
  LinearCorner undelayed = *this;
  undelayed.delay_ = 0.0;
  const double error = undelayed.corner_error();
  return error <= error_max ? 0.0 : tau_ * (1.0 - std::sqrt(error_max / error));
}

}  // namespace accdec
