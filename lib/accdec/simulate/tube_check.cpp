#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/tube_check.hpp>

namespace accdec {
namespace {

constexpr double at_point = 1e-9;    // m
constexpr double feed_slack = 1e-6;  // of programmed feeds, which durations give

}  // namespace

std::vector<double> tube_radii(const Toolpath& path) {
  const std::size_t blocks = path.blocks();
  const auto granted = [&](std::size_t b) {
    if (path.joint[b] == Joint::stop) return 0.0;
    if (path.tolerance[b] < unlimited) return path.tolerance[b];
    // A path without tolerances may be bounded by its contour alone.
    return path.joint[b] == Joint::straight || !(path.contour_max < unlimited) ? 0.0 : path.contour_max;
  };
  std::vector<double> radius(blocks);
  for (std::size_t first = 0; first < blocks;) {
    std::size_t last = first;
    while (path.joint[last] == Joint::straight) ++last;
    const double widest = std::max(first > 0 ? granted(first - 1) : 0.0, granted(last));
    for (; first <= last; ++first) radius[first] = widest;
  }
  return radius;
}

std::vector<double> allowed_off(const Toolpath& path) {
  std::vector<double> radius = tube_radii(path);
  for (double& most : radius) most = std::min(most, path.contour_max);
  return radius;
}

std::vector<double> feed_limits(const Toolpath& path) {
  std::vector<double> feeds(path.blocks(), unlimited);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.rapid[b] == 0) feeds[b] = path.length(b) / path.duration[b];
  }
  return feeds;
}

TubeCheck::TubeCheck(const Toolpath& path, double sample_period)
    : path_(path),
      period_(sample_period),
      radius_(allowed_off(path)),
      feed_(feed_limits(path)),
      before_(path.point(0), path.point(0) + path.dimensions()),
      rested_(path.blocks(), 0) {}

void TubeCheck::wrong(const std::string& what, std::size_t block) {
  if (wrong_.empty()) wrong_ = fmt::format("line {}, sample {}: {}", path_.line[block], sample_, what);
}

/// Counts the samples that stand in the ends of blocks where the motion has to stop.
void TubeCheck::look_stops(std::size_t block) {
  const std::size_t n = path_.dimensions();
  for (std::size_t b = block > 0 ? block - 1 : 0; b <= block; ++b) {
    if (path_.joint[b] == Joint::stop && distance(before_.data(), path_.point(b + 1), n) <= at_point) ++rested_[b];
  }
}

void TubeCheck::look(const double* position, std::size_t block) {
  const std::size_t n = path_.dimensions();
  ++sample_;
  if (block < block_) wrong("goes back to an earlier block", block);
  for (std::size_t b = block_; b < block; ++b) {
    if (path_.joint[b] == Joint::stop && rested_[b] == 0 && !(distance(position, path_.point(b + 1), n) <= at_point))
      wrong("passes a stop", b);
  }
  const double off = std::sqrt(segment_distance2(path_.point(block), path_.point(block + 1), position, n));
  if (!holds(off, radius_[block]))
    wrong(fmt::format("is {:.6g} um off its leg, {:.6g} um are allowed", 1e6 * off, 1e6 * radius_[block]), block);
  const double speed = distance(position, before_.data(), n) / period_;
  const double feed = std::max(feed_[block], feed_[block_]);
  if (speed > feed * (1.0 + feed_slack) + 2.0 * at_point)
    wrong(fmt::format("moves at {:.6g} mm/s, programmed are {:.6g}", 1e3 * speed, 1e3 * feed), block);
  left_ = left_ || distance(position, path_.point(0), n) > at_point;
  if (!left_) rested_first_ = sample_;
  std::copy_n(position, n, before_.begin());
  block_ = block;
  look_stops(block);
}

std::string TubeCheck::finish() {
  if (static_cast<double>(rested_first_) * period_ < path_.dwell_first - 1e-9)
    wrong("does not rest for the dwell before its first move", 0);
  for (const auto& [b, time] : path_.dwell) {
    // The first sample that stands there begins the dwell.
    if (static_cast<double>(rested_[b] - 1) * period_ < time - 1e-9) wrong("does not rest for its dwell", b);
  }
  if (!wrong_.empty()) return wrong_;
  const std::size_t last = path_.blocks() - 1;
  if (distance(before_.data(), path_.point(last + 1), path_.dimensions()) > at_point)
    wrong("does not end where the program does", last);
  return wrong_;
}

}  // namespace accdec
