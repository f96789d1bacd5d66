#include <algorithm>
#include <cmath>

#include <accdec/plot/path_follower.hpp>

namespace accdec {
namespace {

/// Below this value of 1 + cos(turn), a path turns back on itself, within 0.1 degrees.
constexpr double turns_back = 1e-6;
constexpr double rounding = 1e-9;  // m, of places

/// Place of a point relative to a block.
struct Place {
  double part = 0.0;      ///< of the block, 0 to 1
  double distance = 0.0;  ///< m
};

double length_of(const Toolpath& path, std::size_t block) {
  const double* p = path.point(block);
  double sum = 0.0;
  for (std::size_t a = 0; a < path.dimensions(); ++a) sum += std::pow(p[path.dimensions() + a] - p[a], 2);
  return std::sqrt(sum);
}

Place place_on(const Toolpath& path, std::size_t block, const double* x) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(block);
  double along = 0.0, length2 = 0.0, distance2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    const double u = p[n + a] - p[a];
    along += (x[a] - p[a]) * u;
    length2 += u * u;
  }
  const double part = std::clamp(along / length2, 0.0, 1.0);
  for (std::size_t a = 0; a < n; ++a) distance2 += std::pow(x[a] - p[a] - part * (p[n + a] - p[a]), 2);
  return {part, std::sqrt(distance2)};
}

}  // namespace

/// Whether the motion has passed the corner at the block's end.
bool PathFollower::left(const double* x, const double* v) {
  const double *p = path_.point(block_), *q = p + n_, *r = q + n_;
  const double in = length_of(path_, block_), out = length_of(path_, block_ + 1);
  double dot = 0.0, beyond = 0.0, speed = 0.0;
  for (std::size_t a = 0; a < n_; ++a) {
    const double u = (q[a] - p[a]) / in, w = (r[a] - q[a]) / out;
    dot += u * w;
    beyond += (x[a] - q[a]) * (u + w);
    speed += v[a] * u;
  }
  forward_ = forward_ || speed > 0.0;
  return 1.0 + dot < turns_back ? forward_ && speed < 0.0 : beyond > 0.0;
}

/// A later block that is nearer to the motion than this one. Motions that round several corners at once never cross the
/// bisector of some. They skip blocks that are shorter than their distance.
std::size_t PathFollower::nearer_block(const double* x) const {
  const double away = place_on(path_, block_, x).distance - rounding;
  std::size_t nearest = block_;
  double least = away, skipped = 0.0;
  for (std::size_t b = block_ + 1; b < path_.blocks() && skipped < away; ++b) {
    if (const double distance = place_on(path_, b, x).distance; distance < least) least = distance, nearest = b;
    skipped += length_of(path_, b);
  }
  return nearest;
}

void PathFollower::follow(const double* x, const double* v) {
  for (;;) {
    while (block_ + 1 < path_.blocks() && left(x, v)) enter(block_ + 1);
    const std::size_t nearer = nearer_block(x);
    if (nearer == block_) break;
    enter(nearer);
  }
  part_ = place_on(path_, block_, x).part;
}

}  // namespace accdec
