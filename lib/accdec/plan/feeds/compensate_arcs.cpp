#include <algorithm>
#include <cmath>
#include <vector>

#include <accdec/motion/circle.hpp>
#include <accdec/plan/feeds/arc_caps.hpp>
#include <accdec/plan/feeds/compensate_arcs.hpp>

namespace accdec {
namespace {

double squared(double x) {
  return x * x;
}

/// Arcs that follow each other smoothly in the same sense and plane.
class ArcGroup {
 public:
  ArcGroup(Toolpath& path, std::span<const PathArc> arcs, const FilterBehind& behind, std::span<const int> delays,
           double period)
      : path_(path), first_(arcs.front().first), last_(arcs.back().last), span_((behind.felt_order() + 1) * period) {
    const auto variance_of = [&](std::size_t axis) { return tap_variance(behind.motion(axis)) * squared(period); };
    const double variance = 0.5 * (variance_of(arcs.front().x) + variance_of(arcs.front().y));
    const std::size_t n = path.dimensions();
    time_.push_back(0.0);
    sum_.push_back(0.0);
    for (std::size_t b = first_; b <= last_; ++b) {
      const PathArc& arc = *arc_of(path, b);
      const double* p = path.point(b);
      const double speed2 =
          (squared(p[n + arc.x] - p[arc.x]) + squared(p[n + arc.y] - p[arc.y])) / squared(path.duration[b]);
      const double rest = b < last_ ? delays[b] * period : 0.0;
      time_.push_back(time_.back() + path.duration[b] + rest);
      sum_.push_back(sum_.back() + path.duration[b] * speed2 * variance / (2.0 * arc.radius));
    }
  }

  void widen() {
    const std::size_t n = path_.dimensions();
    std::vector<double> moved(path_.points.begin() + static_cast<std::ptrdiff_t>(first_ * n),
                              path_.points.begin() + static_cast<std::ptrdiff_t>((last_ + 2) * n));
    for (std::size_t i = first_ + 1; i <= last_; ++i) {
      const PathArc& arc = *arc_of(path_, i);
      double dx = 0.0, dy = 0.0;
      const double radius = arc.from(path_.point(i), dx, dy), error = error_at(i - first_);
      const double wider = 0.5 * (std::sqrt(squared(radius) + 4.0 * error * radius) - radius);
      moved[(i - first_) * n + arc.x] += wider * dx;
      moved[(i - first_) * n + arc.y] += wider * dy;
    }
    for (std::size_t b = first_; b <= last_; ++b) {
      const double *p = path_.point(b), *q = moved.data() + (b - first_) * n;
      double before = 0.0, after = 0.0;
      for (std::size_t a = 0; a < n; ++a) before += squared(p[n + a] - p[a]), after += squared(q[n + a] - q[a]);
      path_.duration[b] *= std::max(1.0, std::sqrt(after / before));
    }
    std::copy(moved.begin(), moved.end(), path_.points.begin() + static_cast<std::ptrdiff_t>(first_ * n));
  }

 private:
  /// Integral of the error up to a time.
  double integral(double t) const {
    const auto after = std::upper_bound(time_.begin(), time_.end(), t);
    if (after == time_.begin()) return 0.0;
    if (after == time_.end()) return sum_.back();
    const auto i = static_cast<std::size_t>(after - time_.begin()) - 1;
    return sum_[i] + (sum_[i + 1] - sum_[i]) * (t - time_[i]) / (time_[i + 1] - time_[i]);
  }
  /// Error to compensate at point i of the group, m.
  double error_at(std::size_t i) const {
    const double end = time_.back(), low = std::max(0.0, time_[i] - 0.5 * span_),
                 high = std::min(end, time_[i] + 0.5 * span_);
    const double u = std::min(1.0, std::min(time_[i], end - time_[i]) / span_);
    return (integral(high) - integral(low)) / (high - low) * u * u * (3.0 - 2.0 * u);
  }

  Toolpath& path_;
  std::size_t first_, last_;  // blocks
  double span_;               // s, of the filter
  std::vector<double> time_;  // s, of every point
  std::vector<double> sum_;   // of the error over time, up to every point
};

}  // namespace

void compensate_arcs(Toolpath& path, const FilterBehind& behind, std::span<const int> delays, double sample_period) {
  if (path.arcs.empty()) return;
  path.programmed = path.points;
  const auto goes_on = [&](const PathArc& a, const PathArc& b) {
    return b.first == a.last + 1 && !ends_leg(path, a.last) && a.x == b.x && a.y == b.y &&
           (a.angle > 0.0) == (b.angle > 0.0);
  };
  for (std::size_t first = 0, end = 1; first < path.arcs.size(); first = end++) {
    while (end < path.arcs.size() && goes_on(path.arcs[end - 1], path.arcs[end])) ++end;
    ArcGroup(path, std::span(path.arcs).subspan(first, end - first), behind, delays, sample_period).widen();
  }
}

}  // namespace accdec
