#include <algorithm>
#include <cmath>

#include <accdec/estimate/linuxcnc.hpp>

namespace accdec {
namespace {

constexpr std::size_t merged_max = 100;

void set_modes(Piece& piece, const ControlMove& move) {
  piece.tolerance = move.tolerance;
  piece.end = move.control == PathControl::blend        ? PieceEnd::parabolic
              : move.control == PathControl::exact_path ? PieceEnd::exact
                                                        : PieceEnd::stop;
}

/// Moves that are in line within their Q, until they are one piece.
class Chain {
 public:
  Chain(std::vector<Piece>& pieces, const ControlLimits& limits) : pieces_(pieces), limits_(limits) {}

  void add(const Vector& from, const Vector& to, const ControlMove& move) {
    const bool alone = moves_others(move) || moves_others(move_);
    if (!points_.empty() && (alone || !(same_modes(move) && in_line(to)))) flush();
    if (points_.empty()) {
      start_ = from;
      move_ = move;
    }
    points_.push_back(to);
  }
  void flush() {
    if (points_.empty()) return;
    const Vector way = points_.back() - start_;
    points_.clear();
    const double straight = way.norm();
    if (!(straight > 0.0) && !moves_others(move_)) return;
    Piece& piece = pieces_.emplace_back();
    piece.length = piece.nominal = straight > 0.0 ? straight : move_.length;
    piece.first = piece.last = straight > 0.0 ? Vector(way / straight) : move_.first;
    piece.rapid = move_.rapid;
    piece.others = moves_others(move_);
    set_modes(piece, move_);
    piece.speed = along_others(move_, limits_.other_velocity);
    piece.acceleration = along_others(move_, limits_.other_acceleration);
    if (straight > 0.0) {
      piece.speed = std::min(piece.speed, along(piece.first, limits_.velocity));
      piece.acceleration = std::min(piece.acceleration, along(piece.first, limits_.acceleration));
    }
    piece.request = move_.rapid ? piece.speed : std::min(move_.feed, piece.speed);
  }

 private:
  bool same_modes(const ControlMove& move) const {
    return !move.rapid && !move_.rapid && move.control == PathControl::blend && move_.control == move.control &&
           move.tolerance == move_.tolerance && move.merge == move_.merge && move.merge > 0.0 &&
           std::abs(move.feed - move_.feed) <= 1e-6 * move.feed && points_.size() <= merged_max;
  }
  bool in_line(const Vector& to) const {
    const Vector way = to - start_;
    const double length2 = way.squaredNorm();
    if (!(length2 > 0.0)) return false;
    return std::all_of(points_.begin(), points_.end(), [&](const Vector& point) {
      const double part = std::clamp(way.dot(point - start_) / length2, 0.0, 1.0);
      return (point - start_ - part * way).norm() <= move_.merge;
    });
  }

  std::vector<Piece>& pieces_;
  const ControlLimits& limits_;
  Vector start_ = Vector::Zero();
  std::vector<Vector> points_;
  ControlMove move_;
};

Piece arc_piece(const ControlMove& arc, const ControlLimits& limits) {
  Piece piece;
  piece.arc = true;
  piece.first = arc.first;
  piece.last = arc.last;
  piece.length = piece.nominal = arc.length;
  Vector rise = arc.to - arc.from;
  rise[arc.x] = rise[arc.y] = 0.0;
  piece.center = arc.center - arc.from;
  piece.center_at_end = arc.center - arc.to;
  for (const Eigen::Index a : {0, 1, 2}) {
    if (a != arc.x && a != arc.y) piece.center[a] = piece.center_at_end[a] = 0.0;
  }
  piece.axis[3 - arc.x - arc.y] = 1.0;
  piece.turn = std::abs(arc.angle);
  const double planar = arc.radius * piece.turn;
  const double velocity = std::min(limits.velocity[arc.x], limits.velocity[arc.y]);
  const double acceleration = std::min(limits.acceleration[arc.x], limits.acceleration[arc.y]);
  const double planar_speed = std::min(velocity, std::sqrt(normal_part * acceleration * arc.radius));
  double time = planar / planar_speed, time2 = planar / acceleration;
  const Vector chord = arc.to - arc.from;
  if (const double straight = chord.norm(); straight > 0.0) {
    time = std::max(time, straight / along(chord / straight, limits.velocity));
    time2 = std::max(time2, straight / along(chord / straight, limits.acceleration));
  }
  piece.speed = std::min(arc.length / time, along_others(arc, limits.other_velocity));
  piece.acceleration = std::min(arc.length / time2, along_others(arc, limits.other_acceleration));
  piece.others = moves_others(arc);
  piece.request = std::min(arc.feed, piece.speed);
  // A helix bends less than its circle.
  piece.radius = arc.radius + rise.squaredNorm() / (piece.turn * piece.turn * arc.radius);
  return piece;
}

/// An arc that leaves the lines through its middle by less than Q becomes two lines.
bool flat(const ControlMove& arc) {
  return arc.arc && !moves_others(arc) && arc.x + arc.y == 1 && arc.control == PathControl::blend &&
         arc.radius * (1.0 - std::cos(0.5 * arc.angle)) < arc.merge;
}

}  // namespace

std::vector<Piece> linuxcnc_pieces(const std::vector<ControlMove>& moves, const ControlLimits& limits) {
  std::vector<Piece> pieces;
  Chain chain(pieces, limits);
  for (const ControlMove& move : moves) {
    if (move.arc && !flat(move)) {
      chain.flush();
      pieces.push_back(arc_piece(move, limits));
      set_modes(pieces.back(), move);
    } else {
      const Vector middle = move.arc ? arc_point(move, 0.5) : move.from;
      if (move.arc) chain.add(move.from, middle, move);
      chain.add(middle, move.to, move);
    }
    if (!(move.dwells || move.ends || move.waits)) continue;
    chain.flush();
    pieces.back().empties = true;
    pieces.back().dwell += move.dwell;
  }
  return pieces;
}

}  // namespace accdec
