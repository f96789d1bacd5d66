#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/simulate/contour_watch.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

constexpr int halvings = 40;     // of a step: far below rounding
constexpr int few_halvings = 4;  // to tell where a step leaves the path, if another leaves it by more

}  // namespace

PathContour::PathContour(const Toolpath& path, std::size_t first)
    : path_(path),
      n_(path_.dimensions()),
      first_(first),
      low_(first),
      high_(first),
      before_(path_.point(first), path_.point(first) + n_),
      block_before_(first) {}

PathContour::PathContour(const CommandTiming& timing, std::int64_t reach, std::size_t first, std::size_t last)
    : PathContour(timing.path(), first) {
  reach_ = reach;
  last_ = last;
  times_ = block_times(timing, first, last);
}

PathContour::Nearest PathContour::nearest(const double* point) const {
  Nearest found{low_, unlimited};
  for (std::size_t b = low_; b <= high_; ++b) {
    const double square = segment_distance2(path_.programmed_point(b), path_.programmed_point(b + 1), point, n_);
    if (square < found.distance) found = {b, square};
  }
  found.distance = std::sqrt(found.distance);
  return found;
}

void PathContour::note(const Nearest& found, const double* point) {
  if (found.distance > worst_) worst_ = found.distance, worst_block_ = found.block, worst_sample_ = number_;
  if (holds(found.distance, path_.contour_max)) return;
  const auto square = [&](std::size_t p) {
    double sum = 0.0;
    for (std::size_t a = 0; a < n_; ++a)
      sum += (path_.programmed_point(p)[a] - point[a]) * (path_.programmed_point(p)[a] - point[a]);
    return sum;
  };
  std::size_t at = low_;
  for (std::size_t p = low_ + 1; p <= high_ + 1; ++p) {
    if (square(p) < square(at)) at = p;
  }
  const double use = utilisation_of(LimitKind::contour, found.distance, path_.contour_max);
  if (off_.empty() || off_.back().point != at) off_.push_back({static_cast<std::uint32_t>(at), use});
  off_.back().use = std::max(off_.back().use, use);
}

/// The distance from one block is convex along a step. So no point of it is farther away than the farther end.
void PathContour::between(const double* from, const double* to, int depth) {
  double most = unlimited;
  for (std::size_t b = low_; b <= high_; ++b) {
    most =
        std::min(most, std::max(segment_distance2(path_.programmed_point(b), path_.programmed_point(b + 1), from, n_),
                                segment_distance2(path_.programmed_point(b), path_.programmed_point(b + 1), to, n_)));
  }
  const double farthest = std::sqrt(most);
  const bool told = holds(farthest, path_.contour_max) || depth >= few_halvings;
  if (depth == halvings || (told && farthest <= worst_ * (1.0 + 1e-9) + position_floor)) return;
  std::array<double, program_axis_count> middle{};
  for (std::size_t a = 0; a < n_; ++a) middle[a] = 0.5 * (from[a] + to[a]);
  note(nearest(middle.data()), middle.data());
  between(from, middle.data(), depth + 1);
  between(middle.data(), to, depth + 1);
}

void PathContour::look(const double* now) {
  const Nearest found = nearest(now);
  note(found, now);
  if (found.block != block_before_) between(before_.data(), now, 0);
  std::copy_n(now, n_, before_.begin());
  block_before_ = found.block;
}

void PathContour::look(std::int64_t number, std::int64_t count, const double* const* position) {
  std::array<double, program_axis_count> now{};
  for (std::int64_t i = 0; i < count; ++i) {
    number_ = number + i;
    for (std::size_t a = 0; a < n_; ++a) now[a] = position[a][i];
    const auto k = static_cast<double>(number_);
    while (high_ < last_ && times_.begins[high_ - first_ + 1] <= k) ++high_;
    // The step to this sample begins at the one before. If the command rests, the block before it stays.
    while (low_ < high_ && times_.ends[low_ - first_] + static_cast<double>(reach_) + 1.0 < k) ++low_;
    look(now.data());
  }
}

void PathContour::look(std::int64_t number, const double* position, std::size_t first, std::size_t last) {
  number_ = number;
  // The step begins on the blocks of the sample before.
  low_ = std::min(oldest_, first);
  high_ = std::max(high_, last);
  oldest_ = first;
  look(position);
}

LimitUse PathContour::use() const {
  LimitUse use;
  use.kind = LimitKind::contour;
  use.value = worst_;
  use.bound = path_.contour_max;
  use.utilisation = worst_ <= position_floor ? 0.0 : utilisation_of(use.kind, worst_, use.bound);
  use.sample = worst_sample_;
  use.line = path_.line[worst_block_];
  return use;
}

std::vector<Simulation::OffPath> PathContour::off() const {
  std::vector<Simulation::OffPath> off = off_;
  const auto same = [](const Simulation::OffPath& a, const Simulation::OffPath& b) { return a.point == b.point; };
  std::ranges::sort(
      off, [](const auto& a, const auto& b) { return a.point != b.point ? a.point < b.point : a.use > b.use; });
  off.erase(std::unique(off.begin(), off.end(), same), off.end());
  return off;
}

void PathContour::finish(Simulation& result) const {
  result.limits.push_back(use());
  result.off = off();
}

PathContour contour_of(const Toolpath& path, const Trajectory& trajectory, double sample_period) {
  PathContour contour(path);
  std::int64_t number = 0;
  if (trajectory.is_free()) {
    const double* position = trajectory.free.position.data();
    for (const std::size_t block : trajectory.free.block) {
      contour.look(++number, position, block, block);
      position += path.dimensions();
    }
    return contour;
  }
  ProfileMotion motion(path, trajectory.chain, sample_period, trajectory.last);
  const auto block = [&](std::int64_t place) { return std::min(static_cast<std::size_t>(place), path.blocks() - 1); };
  while (motion.next()) {
    // In a corner it may be on the blocks on both sides.
    const std::size_t first = block(motion.place_first() / 2), last = block((motion.place_last() + 1) / 2);
    contour.look(++number, motion.position(), first, last);
    if (const std::int64_t steady = motion.pass_steady(); steady > 0)
      contour.look(number += steady, motion.position(), first, last);
  }
  return contour;
}

}  // namespace accdec
