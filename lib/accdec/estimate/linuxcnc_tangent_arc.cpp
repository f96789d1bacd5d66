#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <accdec/estimate/linuxcnc.hpp>

namespace accdec {
namespace {

using Plane2 = Eigen::Vector2d;

/// One side of a corner at the origin of its plane.
struct Side {
  bool arc = false;
  Plane2 direction, normal;  // of a line, away from the corner; towards the blend's centre
  Plane2 center;             // of an arc
  double radius = 0.0;
  double distance = 0.0;  // of the blend's centre from the arc's
  bool with = false;      // the blend lies inside the arc
};

double cross(const Plane2& a, const Plane2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

double angle_between(const Plane2& a, const Plane2& b) {
  return std::abs(std::atan2(cross(a, b), a.dot(b)));
}

/// The centre nearest to the corner, at a distance from a line and from another centre.
std::optional<Plane2> beside_line(const Side& line, const Side& arc, double radius) {
  const double across = radius - arc.center.dot(line.normal), along = arc.center.dot(line.direction);
  const double square = arc.distance * arc.distance - across * across;
  if (square < 0.0) return {};
  const double root = std::sqrt(square), low = along - root, high = along + root;
  const double way = std::min(std::abs(low), std::abs(high));
  return way * line.direction + radius * line.normal;
}

std::optional<Plane2> between_arcs(const Side& first, const Side& second) {
  const Plane2 base = second.center - first.center;
  const double length = base.norm(), square1 = first.distance * first.distance;
  if (!(length > 0.0)) return {};
  const double x = (square1 - second.distance * second.distance + length * length) / (2.0 * length);
  const double square = square1 - x * x;
  if (square < 0.0) return {};
  const Plane2 unit = base / length, up(-unit[1], unit[0]), foot = first.center + x * unit;
  const Plane2 a = foot + std::sqrt(square) * up, b = foot - std::sqrt(square) * up;
  return a.norm() < b.norm() ? a : b;
}

/// From the blend's centre to where it meets a side.
Plane2 contact(const Side& side, const Plane2& center) {
  if (!side.arc) return -side.normal;
  return side.with ? Plane2(center - side.center) : Plane2(side.center - center);
}

/// m, that the blend takes of a side.
double taken(const Side& side, const Plane2& center) {
  if (!side.arc) return std::abs(center.dot(side.direction));
  return side.radius * angle_between(-side.center, center - side.center);
}

}  // namespace

bool bends_with(const Vector& center, const Vector& towards) {
  return center.dot(towards) >= 0.0;
}

std::optional<TangentArc> tangent_arc(const Piece& before, const Piece& after, double radius, double tolerance,
                                      double part_before, double part_after) {
  const Vector normal = before.last.cross(after.first).normalized();
  for (const Piece* piece : {&before, &after}) {
    if (piece->arc && std::abs(piece->axis.dot(normal)) < 1.0 - 1e-9) return {};
  }
  const Vector x = before.last, y = normal.cross(x);
  const auto flat = [&](const Vector& v) { return Plane2(v.dot(x), v.dot(y)); };
  const auto side_of = [&](const Piece& piece, const Vector& away, const Vector& center, const Vector& towards) {
    Side side;
    side.arc = piece.arc;
    side.direction = flat(away);
    side.normal = (flat(towards) - flat(towards).dot(side.direction) * side.direction).normalized();
    side.center = flat(center);
    side.radius = side.center.norm();
    side.with = bends_with(center, towards);
    side.distance = side.with ? side.radius - radius : side.radius + radius;
    return side;
  };
  const Side first = side_of(before, -before.last, before.center_at_end, after.first);
  const Side second = side_of(after, after.first, after.center, -before.last);
  std::optional<Plane2> center;
  if (first.arc && second.arc)
    center = between_arcs(first, second);
  else if (first.arc || second.arc)
    center = first.arc ? beside_line(second, first, radius) : beside_line(first, second, radius);
  else
    center = radius * first.normal +
             radius * std::tan(0.5 * angle_between(Plane2(1.0, 0.0), second.direction)) * first.direction;
  // Between lines, the radius follows from the tolerance.
  if (!center || ((first.arc || second.arc) && center->norm() - radius > tolerance)) return {};
  TangentArc arc;
  arc.taken_before = taken(first, *center);
  arc.taken_after = taken(second, *center);
  if ((first.arc && arc.taken_before > part_before * first.radius) ||
      (second.arc && arc.taken_after > part_after * second.radius))
    return {};
  arc.length = radius * angle_between(contact(first, *center), contact(second, *center));
  return arc;
}

}  // namespace accdec
