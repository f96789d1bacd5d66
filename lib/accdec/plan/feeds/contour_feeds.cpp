#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include <accdec/machine/blend_behind.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/feeds/radius_error.hpp>

namespace accdec {

namespace {

Eigen::VectorXd way_of(const Toolpath& path, std::size_t b) {
  const auto n = static_cast<Eigen::Index>(path.dimensions());
  return Eigen::Map<const Eigen::VectorXd>(path.point(b + 1), n) - Eigen::Map<const Eigen::VectorXd>(path.point(b), n);
}

bool differ_within(const Toolpath& path, const FilterBehind& behind) {
  return path.contour_max < unlimited && behind.differs();
}

}  // namespace

std::vector<double> parts_within_contour(const Toolpath& path, const FilterBehind& behind, double sample_period) {
  std::vector<double> parts(path.blocks(), 1.0);
  if (!differ_within(path, behind)) return parts;
  const double longest = behind.felt_order() * sample_period;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.duration[b] < longest) continue;
    const Eigen::VectorXd way = way_of(path, b);
    const double off = off_line(behind, way.normalized(), way.norm() / path.duration[b] * sample_period);
    if (off > path.contour_max) parts[b] = path.contour_max / off;
  }
  return parts;
}

std::vector<double> parts_from_rest(const Toolpath& path, const FilterBehind& behind, double sample_period) {
  std::vector<double> parts = parts_within_contour(path, behind, sample_period);
  if (!differ_within(path, behind)) return parts;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const Eigen::VectorXd way = way_of(path, b), direction = way.normalized();
    const double length = way.norm(), samples = path.duration[b] / sample_period;
    // The block is slowed until it lasts k samples without leaving the contour, or longer than the motion's filter.
    double most = 0.0;  // of a start with 1 m a sample
    for (int k = 0; k <= behind.longest_order(); ++k) {
      most = std::max(most, off_line_after(behind, direction, 1.0, k));
      if (k >= samples && length / k * most <= path.contour_max) {
        most = 0.0;
        parts[b] = std::min(parts[b], samples / std::max(samples, static_cast<double>(k)));
        break;
      }
    }
    if (most > 0.0) parts[b] = std::min(parts[b], path.contour_max / (most * length / samples));
  }
  return parts;
}

namespace {

/// Lowers the parts of the chords of arcs to those at which the radius error is within the contour.
void hold_arcs(const Toolpath& path, const FilterBehind& behind, double sample_period, std::vector<double>& parts) {
  if (path.arcs.empty() || path.widen_arcs || !(path.contour_max > 0.0 && path.contour_max < unlimited)) return;
  const RadiusError error(behind, path.dimensions(), sample_period);
  for (const PathArc& arc : path.arcs) {
    const double most = error.speed(arc, beside_chords(path.contour_max, sagitta_of(arc)));
    for (std::size_t b = arc.first; b <= arc.last; ++b) {
      const double *from = path.point(b), *to = path.point(b + 1);
      const double speed = std::hypot(to[arc.x] - from[arc.x], to[arc.y] - from[arc.y]) / path.duration[b];
      if (speed > most) parts[b] = std::min(parts[b], most / speed);
    }
  }
}

}  // namespace

std::vector<double> hold_contour(Toolpath& path, const FilterBehind& behind, double sample_period) {
  std::vector<double> parts = parts_within_contour(path, behind, sample_period);
  hold_arcs(path, behind, sample_period, parts);
  for (std::size_t b = 0; b < path.blocks(); ++b) path.duration[b] /= parts[b];
  return parts;
}

double error_within_contour(double contour, const double* in, const double* out, std::size_t n) {
  constexpr double sharpest = 1e-2;
  double turn2 = 0.0;  // |out - in|^2, that is 4 cos^2(a/2)
  for (std::size_t a = 0; a < n; ++a) turn2 += (out[a] - in[a]) * (out[a] - in[a]);
  return contour / std::max(sharpest, std::sqrt(std::max(0.0, 1.0 - 0.25 * turn2)));
}

Toolpath within_contour(const Toolpath& path) {
  Toolpath within = path;
  if (!(path.contour_max < unlimited)) return within;
  Eigen::VectorXd in = way_of(path, 0).normalized(), out;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b, in.swap(out)) {
    out = way_of(path, b + 1).normalized();
    double& tolerance = within.tolerance[b];
    if (path.joint[b] == Joint::stop || (path.joint[b] == Joint::straight && !(tolerance < unlimited))) continue;
    tolerance = std::min(tolerance, error_within_contour(path.contour_max, in.data(), out.data(), path.dimensions()));
  }
  return within;
}

}  // namespace accdec
