#include <algorithm>
#include <cmath>
#include <tuple>

#include <accdec/plot/shown_time.hpp>

namespace accdec {
namespace {

constexpr double settled_part = 1e-3;  ///< of the largest speed; what differs less from its end is settled
constexpr double at_rest_part = 1e-4;  ///< of the largest speed, of a motion that ends within finite time

/// ms, the part of a leg on which command and motion have the velocity of its last row before `end`. The leg keeps at
/// either end a tenth of the time before that.
std::pair<double, double> steady_part(const CornerMotion& at, Eigen::Index begin, Eigen::Index end) {
  const double most = settled_part * at.motion.velocity.rowwise().norm().maxCoeff();
  const auto settled = [&](Eigen::Index row) {
    return (at.motion.velocity.row(row) - at.motion.velocity.row(end - 1)).norm() <= most &&
           (at.sampled.command.velocity.row(row) - at.sampled.command.velocity.row(end - 1)).norm() <= most;
  };
  Eigen::Index first = end - 1;
  while (first > begin && settled(first - 1)) --first;
  const auto time = [&](Eigen::Index row) { return at.time[static_cast<std::size_t>(row)]; };
  const double kept = 0.1 * (time(first) - time(begin));
  return {time(first) + kept, time(end) - kept};
}

/// From the first motion to the last.
std::pair<double, double> moving_time(const CornerMotion& at) {
  const Eigen::VectorXd speed = at.motion.velocity.rowwise().norm();
  const double zero = (at.sampled.moved ? settled_part : at_rest_part) * speed.maxCoeff();
  const auto moves = [zero](double v) { return std::abs(v) > zero; };
  const auto first = std::find_if(speed.begin(), speed.end(), moves);
  if (first == speed.end()) return {at.time.front(), at.time.back()};
  Eigen::Index last = speed.size() - 1;
  while (!moves(speed[last])) --last;
  return {at.time[static_cast<std::size_t>(std::max<std::ptrdiff_t>(first - speed.begin() - 1, 0))],
          at.time[static_cast<std::size_t>(std::min(last + 1, speed.size() - 1))]};
}

}  // namespace

ShownTime::ShownTime(const CornerMotion& now, const CornerMotion* before) {
  std::tie(from_, to_) = moving_time(now);
  if (before) {
    const auto [from, to] = moving_time(*before);
    from_ = std::min(from_, from), to_ = std::max(to_, to);
  }
  if (!now.sampled.moved) return;
  for (const bool in : {true, false}) {
    const auto part = [&](const CornerMotion& at) {
      return steady_part(at, in ? at.motion.start : at.motion.corner, in ? at.motion.corner : at.motion.stop);
    };
    auto [from, to] = part(now);
    if (before) {
      const auto [other_from, other_to] = part(*before);
      from = std::max(from, other_from), to = std::min(to, other_to);
    }
    if (from < to) left_out_.emplace_back(from, to);
  }
}

std::pair<double, double> ShownTime::range() const {
  const double from = shown(from_), to = shown(to_), air = 0.03 * (to - from);
  return {from - air, to + air};
}

/// The corner command stays at 0: what is before a part that is left out moves later, what is behind it earlier.
double ShownTime::shown(double time) const {
  double moved = time;
  for (const auto& [from, to] : left_out_) {
    if (to <= 0.0) moved += std::max(0.0, to - std::max(time, from));
    if (from >= 0.0) moved -= std::max(0.0, std::min(time, to) - from);
  }
  return moved;
}

void ShownTime::move_together(Panel& panel) const {
  if (!shortened()) return;
  for (Series& series : panel.series) {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < series.x.size(); ++n) {
      const double time = series.x[n];
      // A mark on steady motion stands where that is left out.
      if (series.x.size() > 1 &&
          std::ranges::any_of(left_out_, [time](const auto& part) { return time > part.first && time < part.second; }))
        continue;
      series.x[kept] = shown(time), series.y[kept] = series.y[n];
      ++kept;
    }
    series.x.resize(kept), series.y.resize(kept);
  }
  for (Note& note : panel.notes) note.x = shown(note.x);
}

}  // namespace accdec
