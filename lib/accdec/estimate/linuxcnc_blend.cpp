#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include <accdec/estimate/linuxcnc.hpp>

namespace accdec {
namespace {

constexpr double pi = std::numbers::pi;

/// Half the angle between two directions, the first reversed.
double half_angle(const Vector& in, const Vector& out) {
  return 0.5 * std::acos(std::clamp(-in.dot(out), -1.0, 1.0));
}

/// The largest of something in any direction of a plane.
double in_plane(const Vector& normal, const Vector& limits) {
  double most = unlimited;
  for (Eigen::Index a = 0; a < 3; ++a) {
    const double part = std::sqrt(std::max(0.0, 1.0 - normal[a] * normal[a]));
    if (part > 0.0) most = std::min(most, limits[a] / part);
  }
  return most;
}

/// The part of a piece that a blend may take.
struct Room {
  double length = 0.0;  // m
  double turn = 0.0;    // rad, of an arc
  double less = 0.0;    // rad, by which the arc's chord lowers half the angle of the corner
};
Room room_of(const Piece& piece, const Vector& center, const Vector& towards, double part, double theta) {
  if (!piece.arc) return {std::min(piece.length, 0.5 * piece.nominal)};
  const bool with = bends_with(center, towards);
  const double turn = std::min(piece.turn * part, with ? theta : 0.5 * pi);
  if (with) return {std::sin(0.25 * turn) * piece.radius, turn, 0.25 * turn};
  return {turn * piece.radius, turn};
}

struct ArcBlend {
  Piece piece;
  TangentArc arc;
  bool whole = false;  // all of the piece before
};

/// Largest speed of a blend by the velocity limits: along the base of the triangle of both speeds, or in its plane.
double blend_speed_max(const Piece& before, const Piece& after, double phi, double planar) {
  if (before.arc || after.arc) return planar;
  const double stretch = std::cos(std::min(phi, 0.49 * pi));
  const double v1 = std::min(before.speed, after.speed / stretch), v2 = std::min(after.speed, before.speed / stretch);
  const double base = (v2 * after.first - v1 * before.last).norm();
  return std::max(v1 * v2 * std::sin(phi) / base, planar);
}

/// An arc of constant speed between two pieces within the tolerance; none where it would have no size.
std::optional<ArcBlend> arc_blend(const Piece& before, const Piece& after, const ControlLimits& limits,
                                  const ControlSettings& settings) {
  const double tangents = half_angle(before.last, after.first);
  if (0.5 * pi - tangents < 1e-6 || tangents < 1e-6) return {};
  const Room r1 = room_of(before, before.center_at_end, after.first, 2.0 / 3.0, tangents);
  const Room r2 = room_of(after, after.center, -before.last, 1.0 / 3.0, tangents);
  const double theta = tangents - std::max(r1.less, r2.less), phi = pi - 2.0 * theta;
  const auto own = [](const Piece& piece) {
    return piece.tolerance > 0.0 ? std::min(piece.tolerance, 0.25 * piece.nominal) : 0.25 * piece.nominal;
  };
  const Vector plane = before.last.cross(after.first).normalized();
  const double acceleration = in_plane(plane, limits.acceleration);
  const double most = settings.at("max_feed_override");
  const auto at = [](const Piece& piece, double scale) { return std::min(scale * piece.request, piece.speed); };
  const double goal = std::min(std::max(at(before, most), at(after, most)),
                               blend_speed_max(before, after, phi, in_plane(plane, limits.velocity)));
  const double tolerance = std::min(own(before), own(after));
  const double by_tolerance = std::cos(theta) * tolerance / (1.0 - std::sin(theta));
  const double room = std::min({r1.length, r2.length, by_tolerance});
  const double largest = std::tan(theta) * room;
  const double speed = std::min(std::sqrt(normal_part * acceleration * largest), goal);
  // As long as a parabolic blend would take.
  const double time = std::min(std::sqrt(acceleration * room), speed) / (0.5 * acceleration);
  const double radius = std::max(speed * speed / (normal_part * acceleration), std::min(time * speed / phi, largest));
  if (radius < 1e-15 || radius * phi < 1e-9) return {};
  const auto arc = tangent_arc(before, after, radius, tolerance, r1.turn, r2.turn);
  if (!arc) return {};
  ArcBlend blend;
  blend.arc = *arc;
  const double rest = before.length - arc->taken_before;
  blend.whole = !before.arc && !before.blended &&
                rest / speed < settings.at("arc_blend_gap_cycles") * settings.at("servo_period");
  Piece& piece = blend.piece;
  piece.blend = true;
  piece.first = before.last;
  piece.last = after.first;
  piece.length = piece.nominal = arc->length + (blend.whole ? rest : 0.0);
  piece.rapid = before.rapid;
  piece.request = std::max(at(before, 1.0), at(after, 1.0));
  piece.speed = speed;
  piece.acceleration = acceleration;
  piece.tolerance = before.tolerance;
  piece.end = PieceEnd::tangent;
  return blend;
}

void set_kink(Piece& before, Piece& after, double speed, double reduced) {
  before.kink_speed = speed;
  before.reduced = std::max(reduced, before.reduced);
  after.reduced_before = std::max(reduced, after.reduced_before);
}

void remove_kink(Piece& before, Piece& after) {
  before.kink_speed = -1.0;
  before.reduced = after.reduced_before = 0.0;
}

/// Passes a joint without a blend where the turn at speed asks for little acceleration.
/// @return whether the joint is done
bool pass_kink(Piece& before, Piece& after, const ControlLimits& limits, const ControlSettings& settings) {
  constexpr double reversal = 2.0 * pi / 180.0;
  if (before.end == PieceEnd::stop) return true;
  if ((before.last + after.first).squaredNorm() < reversal * reversal) {
    before.end = PieceEnd::stop;
    return true;
  }
  const double most = settings.at("max_feed_override"), ratio = settings.at("arc_blend_kink_ratio");
  const double speed =
      std::min(std::min(most * before.request, before.speed), std::min(most * after.request, after.speed));
  const Vector change = (speed / settings.at("servo_period") + after.acceleration) * (after.first - before.last);
  double use = change.cwiseAbs().cwiseQuotient(limits.acceleration).maxCoeff();
  if (before.arc || after.arc) use *= 2.0;
  if (use < ratio) {
    before.end = PieceEnd::tangent;
    set_kink(before, after, speed, use);
    return true;
  }
  set_kink(before, after, speed * ratio / use, ratio);
  return false;
}

}  // namespace

double piece_acceleration(const Piece& piece) {
  double part = 1.0 - std::max(piece.reduced, piece.reduced_before);
  if (piece.blended || piece.end == PieceEnd::parabolic) part *= 0.5;
  if (piece.arc || piece.blend) part *= piece.tangential;
  return piece.acceleration * part;
}

ParabolicBlend parabolic_blend(const Piece& before, const Piece& after, double part) {
  const double a1 = piece_acceleration(before), a2 = piece_acceleration(after);
  const double v1 = std::min(std::sqrt(a1 * before.length * part), before.target());
  const double v2 = std::min(std::sqrt(a2 * after.length * part), after.target());
  const double time = std::min(std::min(before.length / v1, after.length / v2), std::max(v1 / a1, v2 / a2));
  ParabolicBlend blend{std::min(v1, time * a1), std::min(v2, time * a2), 0.0};
  const double theta = half_angle(before.last, after.first), cosine = std::cos(theta);
  if (before.tolerance > 0.0 && cosine > std::sin(1e-3)) {
    const double speed = 2.0 * std::sqrt(a1 * before.tolerance / cosine);
    blend.speed_before = std::min(blend.speed_before, speed);
    blend.speed_after = std::min(blend.speed_after, speed);
  }
  blend.speed = 0.5 * std::sin(theta) * (blend.speed_before + blend.speed_after);
  return blend;
}

void fix_length(Piece& piece, double period) {
  piece.speed = std::min(piece.speed, piece.length / period);
  if (!piece.arc) return;
  double acceleration = piece.acceleration * (1.0 - std::max(piece.reduced, piece.reduced_before));
  if (piece.blended || piece.end == PieceEnd::parabolic) acceleration *= 0.5;
  const double across = piece.speed * piece.speed / piece.radius, most = normal_part * acceleration;
  if (across > most) {
    piece.speed = std::sqrt(most * piece.radius);
    piece.tangential = 0.5;
  } else {
    piece.tangential = std::sqrt(1.0 - across * across / (acceleration * acceleration));
  }
}

void add_piece(std::vector<Piece>& queue, Piece piece, const ControlLimits& limits, const ControlSettings& settings) {
  const double period = settings.at("servo_period");
  piece.speed = std::min(piece.speed, piece.length / period);
  if (queue.empty()) {
    queue.push_back(piece);
    return;
  }
  Piece& before = queue.back();
  if (before.rapid != piece.rapid) before.end = PieceEnd::stop;
  std::optional<ArcBlend> blend;
  if (before.others || piece.others) {
    piece.blended = before.end == PieceEnd::parabolic;
  } else if (!pass_kink(before, piece, limits, settings) && before.end == PieceEnd::parabolic) {
    blend = arc_blend(before, piece, limits, settings);
    // Parabolas leave both pieces half of their acceleration, which counts as half of their speed.
    Piece half1 = before, half2 = piece;
    half2.blended = true;
    const double parabolic = 0.5 * parabolic_blend(half1, half2, 0.5).speed, tangent = before.kink_speed;
    const double arc = blend ? blend->piece.speed : 0.0;
    if (arc <= std::max(parabolic, tangent)) blend.reset();
    if (blend || parabolic >= tangent) remove_kink(before, piece);
    if (!blend) {
      before.end = parabolic >= tangent ? PieceEnd::parabolic : PieceEnd::tangent;
      piece.blended = before.end == PieceEnd::parabolic;
    }
  }
  if (blend) {
    piece.length -= blend->arc.taken_after;
    if (blend->whole) {
      queue.pop_back();
    } else {
      before.length -= blend->arc.taken_before;
      before.end = PieceEnd::tangent;
      fix_length(before, period);
    }
    queue.push_back(blend->piece);
  } else {
    fix_length(before, period);
  }
  queue.push_back(piece);
}

}  // namespace accdec
