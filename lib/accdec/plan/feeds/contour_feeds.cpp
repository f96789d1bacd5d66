#include <Eigen/Core>

#include <accdec/corner.hpp>
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
    const double feed = way.norm() / path.duration[b];
    // A corner that goes straight on is passed at constant feed.
    const double off = measure(behind, make_corner(way, way, feed, feed), 0, sample_period).contour_deviation;
    if (off > path.contour_max) parts[b] = path.contour_max / off;
  }
  return parts;
}

void hold_contour(Toolpath& path, const FilterBehind& behind, double sample_period) {
  const std::vector<double> parts = parts_within_contour(path, behind, sample_period);
  for (std::size_t b = 0; b < path.blocks(); ++b) path.duration[b] /= parts[b];
}

}  // namespace accdec
