#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <accdec/plan/feeds/arc_caps.hpp>

namespace accdec {
namespace {

/// Largest |cos| within `half` of an angle.
double largest_cosine(double angle, double half) {
  const double off = std::abs(std::remainder(angle, std::numbers::pi));
  return off <= half ? 1.0 : std::cos(off - half);
}

/// Speeds at one joint of an arc.
struct ArcHeading {
  const FeedWindow& window;
  std::array<std::size_t, 2> axes;  ///< of the plane
  double radius, angle;             ///< m; rad, where the joint is as seen from the centre
  double margin;                    ///< share of the window's changes

  /// Part of the acceleration, jerk, force and power limits that a speed in the plane uses.
  double use(double v) const {
    const double turned = std::min(v / radius * window.tau1(), std::numbers::pi), half = 0.5 * turned;
    const double second = std::min(v / radius * window.tau2(), std::numbers::pi);
    double most = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      const double normal = angle - (i == 0 ? 0.0 : 0.5 * std::numbers::pi), tangent = normal + 0.5 * std::numbers::pi;
      const std::size_t axis = axes[i];
      const double change = 2.0 * v * std::sin(half) * largest_cosine(normal, half);
      const double after = v * std::cos(tangent + half), before = v * std::cos(tangent - half);
      const double allowed =
          std::min(window.change(axis, after, before, false), window.change(axis, before, after, false));
      most = std::max(most, change / (margin * allowed));
      if (!window.jerk()) continue;
      const double jerk =
          4.0 * v * std::sin(half) * std::sin(0.5 * second) * largest_cosine(tangent, half + 0.5 * second);
      most = std::max(most, jerk / (margin * window.jerk_change(axis)));
    }
    return most;
  }
};

}  // namespace

const PathArc* arc_of(const Toolpath& path, std::size_t b) {
  const auto after = std::upper_bound(path.arcs.begin(), path.arcs.end(), b,
                                      [](std::size_t block, const PathArc& arc) { return block < arc.first; });
  if (after == path.arcs.begin()) return nullptr;
  const PathArc& arc = *std::prev(after);
  return b <= arc.last ? &arc : nullptr;
}

ArcCaps::ArcCaps(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind, const FeedWindow& window,
                 double sample_period)
    : path_(path), feeds_(feeds), window_(window), radius_error_(behind, path.dimensions(), sample_period) {}

std::optional<double> ArcCaps::speed(std::size_t b, double tolerance) const {
  const PathArc* arc = arc_of(path_, b);
  if (arc == nullptr || b == arc->last) return std::nullopt;
  const double chords = arc->last - arc->first + 1.0, angle = std::abs(arc->angle),
               done = (b - arc->first + 1.0) / chords;
  const double* at = path_.programmed_point(b + 1);
  const double* from = path_.programmed_point(b);
  // On a helix only a part of the length lies in the plane.
  const double in_plane = std::hypot(at[arc->x] - from[arc->x], at[arc->y] - from[arc->y]) / feeds_.length[b];
  const double top = std::max(feeds_.length[b] / path_.duration[b], feeds_.length[b + 1] / path_.duration[b + 1]);
  double v = top * in_plane;
  if (tolerance < unlimited) v = std::min(v, radius_error_.speed(*arc, beside_chords(tolerance, sagitta_of(*arc))));
  double dx = 0.0, dy = 0.0;
  arc->from(at, dx, dy);
  const ArcHeading point{window_,
                         {arc->x, arc->y},
                         arc->radius,
                         std::atan2(dy, dx),
                         static_cast<double>(std::min(feeds_.margin[b], feeds_.margin[b + 1]))};
  if (window_.limited() && point.use(v) > 1.0) {
    double low = 0.0, high = v;
    while (high - low > 1e-4 * high && high > 1e-6 * v) {
      const double middle = 0.5 * (low + high);
      (point.use(middle) <= 1.0 ? low : high) = middle;
    }
    v = low;
  }
  const double reach = v * std::max(window_.half(), window_.reach()), length = arc->radius * angle;
  if (std::min(done, 1.0 - done) * length < reach) return std::nullopt;
  return v / in_plane;
}

}  // namespace accdec
