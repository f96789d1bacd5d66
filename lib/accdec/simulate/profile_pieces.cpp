#include <algorithm>

#include <accdec/simulate/profile_pieces.hpp>

namespace accdec {

void ProfilePieces::direction(std::size_t b, double* u) const {
  const double* p = path_.point(b);
  for (std::size_t a = 0; a < n_; ++a) u[a] = (p[n_ + a] - p[a]) / chain_.length[b];
}

void ProfilePieces::leg_piece(std::size_t b, double& way, double speed, double acceleration, double duration,
                              const double* u) {
  if (!(duration > 0.0)) return;
  MotionPiece& piece = pieces_.emplace_back();
  piece.duration = duration;
  piece.from = path_.point(b);
  piece.steady = acceleration == 0.0;
  for (std::size_t a = 0; a < n_; ++a) {
    piece.x[a] = u[a] * way;
    piece.v[a] = u[a] * speed;
    piece.a[a] = u[a] * acceleration;
  }
  way += (speed + 0.5 * acceleration * duration) * duration;
}

/// From one speed to another, one piece for every level between them.
void ProfilePieces::ramp_pieces(std::size_t b, double from, double to, double& way, const double* u) {
  const double width = chain_.feed[b] / chain_.levels, low = std::min(from, to), high = std::max(from, to);
  for (int i = 0; i < chain_.levels; ++i) {
    const int k = from < to ? i : chain_.levels - 1 - i;
    const double bottom = std::max(low, k * width),
                 top = k + 1 == chain_.levels ? high : std::min(high, (k + 1) * width);
    if (!(top > bottom)) continue;
    const double rate = chain_.ramp[b * static_cast<std::size_t>(chain_.levels) + static_cast<std::size_t>(k)];
    leg_piece(b, way, from < to ? bottom : top, from < to ? rate : -rate, (top - bottom) / rate, u);
  }
}

void ProfilePieces::begin_leg(std::size_t b) {
  pieces_.clear();
  piece_ = 0;
  std::array<double, program_axis_count> u{};
  direction(b, u.data());
  const double first = chain_.speed[b], last = chain_.speed[b + 1], peak = chain_.peak[b];
  const double ramps = 2.0 * chain_.way(b, peak) - chain_.way(b, first) - chain_.way(b, last);
  const double steady = chain_.length[b] - chain_.taken(b, first) - chain_.taken(b + 1, last) - ramps;
  double way = chain_.taken(b, first) - chain_.coast[b] * first;
  leg_piece(b, way, first, 0.0, chain_.coast[b], u.data());
  ramp_pieces(b, first, peak, way, u.data());
  if (peak > 0.0) leg_piece(b, way, peak, 0.0, steady / peak, u.data());
  ramp_pieces(b, peak, last, way, u.data());
  leg_piece(b, way, last, 0.0, chain_.coast[b + 1], u.data());
}

void ProfilePieces::begin_corner(std::size_t c) {
  pieces_.clear();
  piece_ = 0;
  const double v = chain_.speed[c], tau = chain_.stretch[c] * v;
  if (!(tau > 0.0)) return;
  std::array<double, program_axis_count> in{}, out{};
  direction(c - 1, in.data());
  direction(c, out.data());
  MotionPiece& piece = pieces_.emplace_back();
  piece.duration = tau;
  piece.from = path_.point(c);
  for (std::size_t a = 0; a < n_; ++a) {
    piece.x[a] = -in[a] * 0.5 * v * tau;
    piece.v[a] = in[a] * v;
    piece.a[a] = (out[a] - in[a]) / chain_.stretch[c];
  }
}

}  // namespace accdec
