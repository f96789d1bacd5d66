#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/corner.hpp>

namespace accdec {
namespace {

void require_feed(const char* name, double feed) {
  if (!(feed > 0.0) || !std::isfinite(feed)) {
    throw std::invalid_argument(fmt::format("{} must be positive and finite, got {} m/s", name, feed));
  }
}

Eigen::VectorXd unit(const Eigen::VectorXd& v) {
  const double largest = v.size() == 0 ? 0.0 : v.cwiseAbs().maxCoeff();
  if (!v.allFinite() || !(largest > 0.0)) {
    throw std::invalid_argument("a leg direction must be finite and not all zero");
  }
  return (v / largest).normalized();
}

}  // namespace

double Corner::cos_interior() const {
  const double along = direction_in.dot(direction_out);
  // For nearly collinear legs, the last digit of the product would look like a turn of 1e-8. Their difference is more
  // precise.
  if (along > 0.5) return std::clamp(0.5 * (direction_out - direction_in).squaredNorm() - 1.0, -1.0, 1.0);
  return std::clamp(-along, -1.0, 1.0);
}

Corner make_corner(const Eigen::VectorXd& direction_in, const Eigen::VectorXd& direction_out, double feed_in,
                   double feed_out) {
  require_feed("feed_in", feed_in);
  require_feed("feed_out", feed_out);
  if (direction_in.size() != direction_out.size()) {
    throw std::invalid_argument(fmt::format("leg directions have {} and {} components, must be equal",
                                            direction_in.size(), direction_out.size()));
  }
  return {unit(direction_in), unit(direction_out), feed_in, feed_out};
}

Corner planar_corner(double interior_angle, double heading, Turn turn, double feed_in, double feed_out, int axes) {
  if (!(interior_angle > 0.0) || interior_angle > std::numbers::pi) {
    throw std::invalid_argument(fmt::format("interior angle must be in (0, pi] rad, got {}", interior_angle));
  }
  if (!std::isfinite(heading)) throw std::invalid_argument("heading must be finite");
  if (axes < 2) throw std::invalid_argument(fmt::format("a planar corner needs at least 2 axes, got {}", axes));
  // The heading changes by pi - theta. A straight pass must be exactly straight. In floating point sin(pi) is not 0,
  // and a sideways component of 1e-16 would move an axis that stands still.
  const double change = std::numbers::pi - interior_angle;
  const double sign = turn == Turn::left ? 1.0 : -1.0;
  const auto snap = [](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; };
  const double c = snap(std::cos(heading)), s = snap(std::sin(heading));
  const double cd = std::cos(change), sd = sign * std::sin(change);
  Eigen::VectorXd in = Eigen::VectorXd::Zero(axes), out = Eigen::VectorXd::Zero(axes);
  in[0] = c;
  in[1] = s;
  out[0] = snap(c * cd - s * sd);
  out[1] = snap(s * cd + c * sd);
  return make_corner(in, out, feed_in, feed_out);
}

}  // namespace accdec
