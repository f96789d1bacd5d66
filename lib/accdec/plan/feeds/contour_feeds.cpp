#include <Eigen/Core>

#include <accdec/machine/blend_behind.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>

namespace accdec {

std::vector<double> parts_within_contour(const Toolpath& path, const FilterBehind& behind, double sample_period) {
  std::vector<double> parts(path.blocks(), 1.0);
  if (!(path.contour_max < unlimited) || !behind.differs()) return parts;
  const double longest = behind.felt_order() * sample_period;
  const auto n = static_cast<Eigen::Index>(path.dimensions());
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.duration[b] < longest) continue;
    const Eigen::VectorXd way =
        Eigen::Map<const Eigen::VectorXd>(path.point(b + 1), n) - Eigen::Map<const Eigen::VectorXd>(path.point(b), n);
    const double off = off_line(behind, way.normalized(), way.norm() / path.duration[b] * sample_period);
    if (off > path.contour_max) parts[b] = path.contour_max / off;
  }
  return parts;
}

std::vector<double> hold_contour(Toolpath& path, const FilterBehind& behind, double sample_period) {
  std::vector<double> parts = parts_within_contour(path, behind, sample_period);
  for (std::size_t b = 0; b < path.blocks(); ++b) path.duration[b] /= parts[b];
  return parts;
}

}  // namespace accdec
