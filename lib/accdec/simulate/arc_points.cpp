#include <algorithm>
#include <cmath>

#include <accdec/simulate/arc_points.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/tube_check.hpp>

namespace accdec {

namespace {

/// Beside stops, the tolerance of the stop.
void widen_beside_stops(const Toolpath& path, std::vector<double>& radius) {
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] != Joint::stop) continue;
    std::size_t first = b, last = b + 1;
    while (first > 0 && path.joint[first - 1] == Joint::straight) --first;
    while (path.joint[last] == Joint::straight) ++last;
    for (; first <= last; ++first)
      radius[first] = std::max(radius[first], std::min(path.tolerance[b], path.contour_max));
  }
}

}  // namespace

ArcPoints::ArcPoints(const Toolpath& path, bool servo) : path_(path) {
  if (path.arcs.empty()) return;
  std::vector<double> radius = tube_radii(path);
  if (servo) widen_beside_stops(path, radius);
  for (const PathArc& arc : path.arcs) add_arc(arc, radius);
  distance2_.assign(block_.size(), unlimited);
}

void ArcPoints::add_arc(const PathArc& arc, const std::vector<double>& radius) {
  const std::size_t n = path_.dimensions();
  const double *begin = path_.programmed_point(arc.first), *end = path_.programmed_point(arc.last + 1);
  double ux = 0.0, uy = 0.0, vx = 0.0, vy = 0.0;
  const double first = arc.from(begin, ux, uy), wider = arc.from(end, vx, vy) - first;
  double turned = 0.0;
  for (std::size_t b = arc.first; b <= arc.last; ++b) {
    const double *from = path_.programmed_point(b), *to = path_.programmed_point(b + 1);
    arc.from(from, ux, uy);
    arc.from(to, vx, vy);
    const double turn = std::atan2(ux * vy - uy * vx, ux * vx + uy * vy), part = (turned + 0.5 * turn) / arc.angle;
    const double angle = std::atan2(uy, ux) + 0.5 * turn, r = first + part * wider;
    turned += turn;
    double off2 = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
      const double x = a == arc.x   ? arc.center_x + r * std::cos(angle)
                       : a == arc.y ? arc.center_y + r * std::sin(angle)
                                    : begin[a] + part * (end[a] - begin[a]);
      const double off = x - 0.5 * (from[a] + to[a]);
      off2 += off * off;
      point_.push_back(x);
    }
    block_.push_back(b);
    allowed_.push_back(radius[b] + std::sqrt(off2));
  }
}

void ArcPoints::look(const double* from, const double* to, std::size_t first, std::size_t last) {
  // Motions go on from block to block, but the samples inside a filter may lie on several.
  while (first_ > 0 && block_[first_ - 1] >= first) --first_;
  while (first_ < block_.size() && block_[first_] < first) ++first_;
  for (std::size_t i = first_; i < block_.size() && block_[i] <= last; ++i)
    distance2_[i] = std::min(distance2_[i], segment_distance2(from, to, point(i), path_.dimensions()));
}

std::optional<ArcError> ArcPoints::worst() const {
  std::optional<ArcError> worst;
  for (std::size_t i = 0; i < block_.size(); ++i) {
    const double error = std::sqrt(distance2_[i]);
    if (!worst || error * worst->tolerance > worst->error * allowed_[i])
      worst = ArcError{error, allowed_[i], path_.line[block_[i]]};
  }
  return worst;
}

}  // namespace accdec
