#include <algorithm>
#include <cmath>

#include <accdec/estimate/linuxcnc.hpp>

namespace accdec {
namespace {

constexpr double fewest_periods = 1.02;  // that a piece takes
constexpr double ramp_time = 0.01;       // s; pieces that take less change their speed steadily

/// The largest speeds at the ends of all pieces, with each optimisation as deep as LinuxCNC's.
std::vector<double> final_speeds(const std::vector<Piece>& queue, std::size_t depth) {
  std::vector<double> speeds(queue.size(), 0.0);
  for (std::size_t i = 0; i + 1 < queue.size(); ++i) {
    if (queue[i].end != PieceEnd::tangent) continue;
    std::size_t last = i + 1;
    while (last + 1 < queue.size() && last < i + depth && queue[last].end == PieceEnd::tangent) ++last;
    double speed = 0.0;
    for (std::size_t k = last; k > i; --k) {
      const Piece &piece = queue[k], &before = queue[k - 1];
      double most = std::min(piece.speed, before.speed);
      if (before.kink_speed >= 0.0) most = std::min(most, before.kink_speed);
      speed = std::min(most, std::sqrt(speed * speed + 2.0 * piece_acceleration(piece) * piece.length));
    }
    speeds[i] = speed;
  }
  return speeds;
}

/// One run from rest to rest.
double linuxcnc_run(std::vector<Piece>& queue, const ControlSettings& settings) {
  const double period = settings.at("servo_period");
  fix_length(queue.back(), period);
  for (std::size_t i = 1; i < queue.size(); ++i) {
    if (queue[i - 1].end == PieceEnd::tangent)
      queue[i].speed = std::min(queue[i].speed, queue[i].length / (fewest_periods * period));
  }
  const auto depth = static_cast<std::size_t>(settings.at("arc_blend_optimization_depth"));
  const std::vector<double> final = final_speeds(queue, depth);
  double time = 0.0, from = 0.0;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Piece& piece = queue[i];
    const double a = piece_acceleration(piece), target = piece.target(), gain = 2.0 * a * piece.length;
    double to = 0.0;
    if (piece.end == PieceEnd::tangent && i + 1 < queue.size())
      to = std::min({final[i], target, queue[i + 1].target()});
    to = std::clamp(to, std::sqrt(std::max(0.0, from * from - gain)), std::sqrt(from * from + gain));
    const bool ramps = piece.end == PieceEnd::tangent && !piece.rapid && to > 0.0 &&
                       2.0 * piece.length < ramp_time * (from + std::min(final[i], target));
    time += ramps ? 2.0 * piece.length / (from + to) : trapezoid_time(piece.length, from, target, to, a);
    if (piece.end == PieceEnd::parabolic && i + 1 < queue.size())
      time -= parabolic_blend(piece, queue[i + 1], 1.0).speed_before / a;
    from = to;
  }
  return time + queue.back().dwell;
}

}  // namespace

double linuxcnc_time(const std::vector<ControlMove>& moves, const ControlLimits& limits,
                     const ControlSettings& settings) {
  std::vector<Piece> queue;
  double time = 0.0;
  for (const Piece& piece : linuxcnc_pieces(moves, limits)) {
    add_piece(queue, piece, limits, settings);
    if (!piece.empties) continue;
    time += linuxcnc_run(queue, settings);
    queue.clear();
  }
  return time;
}

}  // namespace accdec
