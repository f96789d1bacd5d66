#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <accdec/plan/verify/verify_path.hpp>
#include <accdec/task/verified_vibration.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

using Place = ProgramPoint;

/// Distances from the nearest of some blocks.
class OffBlocks {
 public:
  OffBlocks(const Toolpath& path, std::span<const std::size_t> near) : path_(path), near_(near) {}

  /// The largest on a step, m.
  double on_step(const Place& from, const Place& to) const {
    const auto [after, block] = off(to);
    auto [worst, block_before] = off(from);
    worst = std::max(worst, after);
    if (block == block_before) return worst;
    constexpr int parts = 64;
    double done = 0.0;
    for (int i = 1; i <= parts; ++i) {
      const double end = static_cast<double>(i) / parts;
      const auto [distance, here] = off(between(from, to, end));
      worst = std::max(worst, distance);
      if (here != block_before) worst = std::max(worst, off(as_far(from, to, done, end, block_before, here)).first);
      done = end, block_before = here;
    }
    return worst;
  }

 private:
  static Place between(const Place& from, const Place& to, double part) {
    Place at{};
    for (std::size_t a = 0; a < at.size(); ++a) at[a] = from[a] + part * (to[a] - from[a]);
    return at;
  }
  double off_block(const Place& at, std::size_t b) const {
    long double along = 0.0L, length = 0.0L, square = 0.0L;
    const double *begin = path_.programmed_point(b), *end = path_.programmed_point(b + 1);
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const long double way = static_cast<long double>(end[a]) - begin[a];
      along += way * (at[a] - static_cast<long double>(begin[a])), length += way * way;
    }
    const long double part = std::clamp(along / length, 0.0L, 1.0L);
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const long double foot = begin[a] + part * (static_cast<long double>(end[a]) - begin[a]);
      square += (at[a] - foot) * (at[a] - foot);
    }
    return static_cast<double>(std::sqrt(square));
  }
  std::pair<double, std::size_t> off(const Place& at) const {
    std::pair<double, std::size_t> nearest{unlimited, 0};
    for (const std::size_t b : near_) nearest = std::min(nearest, {off_block(at, b), b});
    return nearest;
  }
  /// The place between two parts of a step that is as far from one block as from another.
  Place as_far(const Place& from, const Place& to, double low, double high, std::size_t one, std::size_t other) const {
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      const Place at = between(from, to, middle);
      (off_block(at, one) < off_block(at, other) ? low : high) = middle;
    }
    return between(from, to, low);
  }

  const Toolpath& path_;
  std::span<const std::size_t> near_;
};

/// Distances of a motion from the blocks that act on it.
class OffActing {
 public:
  OffActing(const DirectMotion& motion, const Toolpath& path, int order) : motion_(motion), path_(path) {
    // A window ends a filter's length after the command leaves its joint.
    std::int64_t begins = 0;
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      const bool last = b + 1 == path.blocks();
      const std::int64_t ends = last ? std::ssize(motion.position.front()) : motion.windows[b].first + order + 1;
      acts_.emplace_back(begins, ends);
      if (!last) begins = motion.windows[b].last - order - 1;
    }
  }

  /// The largest on the step to a sample, m.
  double on_step(std::size_t k) {
    const auto at = static_cast<std::int64_t>(k);
    near_.clear();
    // Blocks begin and end in their order.
    const auto first = std::ranges::partition_point(acts_, [&](const auto& act) { return act.second < at; });
    for (auto act = first; act != acts_.end() && act->first <= at; ++act)
      near_.push_back(static_cast<std::size_t>(act - acts_.begin()));
    if (near_.empty()) near_.push_back(static_cast<std::size_t>(first - acts_.begin()) - 1);  // in a long rest
    return OffBlocks(path_, near_).on_step(place(k > 0 ? k - 1 : 0), place(k));
  }

 private:
  Place place(std::size_t k) const {
    Place at{};
    for (std::size_t a = 0; a < path_.dimensions(); ++a) at[a] = motion_.position[a][k];
    return at;
  }

  const DirectMotion& motion_;
  const Toolpath& path_;
  std::vector<std::pair<std::int64_t, std::int64_t>> acts_;  // kept samples on which a block acts
  std::vector<std::size_t> near_;
};

/// Changes of the command that count together.
struct Together {
  std::vector<std::pair<std::int64_t, double>> of_axis;  // sample, m/s
  std::vector<std::int64_t> before_corners;              // the last of these samples before each corner
};

/// @param command  that no filter has passed
std::vector<Together> together(const DirectMotion& command, const Toolpath& path, double period, std::size_t axis,
                               int span) {
  std::vector<Together> all(1);
  std::int64_t last = 0, left_out = 0;
  std::size_t cut = 0, joint = 0;
  const auto& velocity = command.velocity;
  const double still = position_floor / period;
  for (std::size_t k = 1; k < velocity.front().size(); ++k) {
    for (; cut < command.cuts.size() && command.cuts[cut].before <= static_cast<std::int64_t>(k); ++cut)
      left_out += command.cuts[cut].count;
    bool moved = false, changed = false;
    for (const std::vector<double>& v : velocity) {
      moved = moved || std::abs(v[k - 1]) > still;
      changed = changed || std::abs(v[k] - v[k - 1]) > still;
    }
    if (!changed) continue;
    const std::int64_t now = static_cast<std::int64_t>(k) + left_out;
    if (moved && now - last > span) all.emplace_back();
    while (joint < command.windows.size() && command.windows[joint].first + 1 < static_cast<std::int64_t>(k)) ++joint;
    const bool reached =
        joint < command.windows.size() && command.windows[joint].first + 1 == static_cast<std::int64_t>(k);
    Together& event = all.back();
    if (reached && path.joint[joint] == Joint::corner && !event.of_axis.empty())
      event.before_corners.push_back(event.of_axis.back().first);
    const double by = velocity[axis][k] - velocity[axis][k - 1];
    if (std::abs(by) > still) event.of_axis.emplace_back(now, by);
    last = now;
    // The change to rest at a stop ends what came before.
    const bool rests = std::ranges::all_of(velocity, [&](const auto& v) { return std::abs(v[k]) <= still; });
    if (reached && rests && path.joint[joint] == Joint::stop) all.emplace_back();
  }
  return all;
}

/// The part of a distance that is across a way.
long double across(const Place& at, const double* begin, const double* end, std::size_t axes) {
  long double length = 0.0L, square = 0.0L;
  for (std::size_t a = 0; a < axes; ++a) length += std::pow(static_cast<long double>(end[a]) - begin[a], 2);
  // Every pair of axes has a part of the area that both ways span.
  for (std::size_t a = 0; a < axes; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const long double area = (static_cast<long double>(at[a]) - begin[a]) * (end[b] - begin[b]) -
                               (static_cast<long double>(at[b]) - begin[b]) * (end[a] - begin[a]);
      square += area * area;
    }
  }
  return std::sqrt(square / length);
}

}  // namespace

std::map<std::uint32_t, double> off_legs(const DirectMotion& motion, const Toolpath& path, int order, int felt) {
  std::map<std::uint32_t, double> most;
  std::int64_t from = 0;
  for (std::size_t first = 0, last = 0; first < path.blocks(); first = ++last) {
    while (last + 1 < path.blocks() && path.joint[last] == Joint::straight) ++last;
    const bool end = last + 1 == path.blocks();
    // Its window begins when the command reaches a joint, and ends a filter's length after the command leaves it.
    const std::int64_t leaves = end ? std::ssize(motion.position.front()) - 1 : motion.windows[last].last - order - 1;
    const std::int64_t reached = end ? leaves : motion.windows[last].first;
    // Only a smooth joint may be passed between two samples; the command does not rest there.
    const bool between = path.joint[last] == Joint::smooth && leaves == reached + 1;
    const bool chord = path.inside_arc[first] != 0 || (first > 0 && path.inside_arc[first - 1] != 0);
    for (std::int64_t k = from; k <= (between ? reached : leaves) && !chord; ++k) {
      Place at{};
      for (std::size_t a = 0; a < path.dimensions(); ++a) at[a] = motion.position[a][static_cast<std::size_t>(k)];
      double& worst = most[path.line[first]];
      worst = std::max(worst, static_cast<double>(across(at, path.programmed_point(first),
                                                         path.programmed_point(last + 1), path.dimensions())));
    }
    from = (between ? leaves : reached) + felt + 1;
  }
  return most;
}

double off_blocks(const Toolpath& path, std::size_t first, std::size_t last, const ProgramPoint& from,
                  const ProgramPoint& to) {
  std::vector<std::size_t> near;
  for (std::size_t b = first; b <= last; ++b) near.push_back(b);
  return OffBlocks(path, near).on_step(from, to);
}

UseOfLimit use_of_contour(const DirectMotion& motion, const Toolpath& path, int order) {
  return {LimitKind::contour, path.contour_max, motion,
          [off = OffActing(motion, path, order)](std::size_t k) mutable { return off.on_step(k); }};
}

UseOfLimit use_of_mode(const DirectMotion& command, const Toolpath& path, double period, std::span<const int> delays,
                       const Filter& filter, const Mode& mode) {
  const auto axis = static_cast<std::size_t>(mode.axis);
  const DirectMotion raw = direct_motion(path, period, delays, BlockFilters{{Filter({1.0})}, {}, filter.order()});
  std::map<std::size_t, double> left;  // by kept sample
  for (const Together& event : together(raw, path, period, axis, filter.order() - filter.first_nonzero_tap())) {
    if (event.of_axis.empty()) continue;
    const std::int64_t end = event.of_axis.back().first;
    RawChanges changes{event.of_axis, {}};
    std::set<std::int64_t> judged(event.before_corners.begin(), event.before_corners.end());
    judged.insert(end);
    for (std::size_t k = 0; k < event.of_axis.size(); ++k)
      if (judged.contains(event.of_axis[k].first)) changes.judged.push_back(k);
    const LimitUse worst = verified_residual(changes, filter, mode, period);
    const std::vector<double> each = displacements_left(changes, filter, worst.frequency, worst.damping, period);
    for (std::size_t i = 0; i < each.size(); ++i) {
      const std::int64_t at = event.of_axis[changes.judged[i]].first + filter.order();
      double& there = left[static_cast<std::size_t>(command.kept(at))];
      there = std::max(there, each[i]);
    }
  }
  return {LimitKind::residual, mode.displacement_max, command, [left = std::move(left)](std::size_t k) {
            const auto at = left.find(k);
            return at == left.end() ? 0.0 : at->second;
          }};
}

}  // namespace accdec
