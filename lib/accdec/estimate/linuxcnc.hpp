#pragma once

#include <optional>
#include <vector>

#include <accdec/estimate/control_moves.hpp>
#include <accdec/estimate/planners.hpp>

// The parts of linuxcnc_time: moves, then blends, then speeds.

namespace accdec {

/// Part of the acceleration that arcs have across them, sqrt(3)/2; half of it is left along them.
inline constexpr double normal_part = 0.8660254037844386;

/// How a piece's end is passed.
enum class PieceEnd { parabolic, tangent, exact, stop };

/// A piece of LinuxCNC's queue: a line, an arc, or an arc that blends two of them.
struct Piece {
  Vector first, last;                  ///< unit directions at both ends
  double length = 0.0, nominal = 0.0;  ///< m; before blends took their parts
  bool arc = false, blend = false, rapid = false;
  bool others = false;                    ///< another axis than X Y Z moves: it is blended by parabolas only
  Vector center = Vector::Zero();         ///< m, from the arc's start
  Vector axis = Vector::Zero();           ///< unit, across an arc's plane
  Vector center_at_end = Vector::Zero();  ///< m, from the arc's end
  double radius = 0.0, turn = 0.0;        ///< m and rad > 0, of an arc
  double request = 0.0, speed = 0.0;      ///< m/s, of the program and largest
  double acceleration = 0.0;              ///< m/s^2
  double tolerance = 0.0;                 ///< m; 0: a quarter of the length
  PieceEnd end = PieceEnd::stop;
  bool blended = false;                        ///< the piece before ends with a parabolic blend
  double kink_speed = -1.0;                    ///< m/s, at its end; negative: any
  double reduced = 0.0, reduced_before = 0.0;  ///< parts of the acceleration kept for the kinks at its ends
  double tangential = 0.5;                     ///< part of the acceleration along an arc
  double dwell = 0.0;                          ///< s, at its end
  bool empties = false;                        ///< the queue is empty at its end

  double target() const { return request < speed ? request : speed; }
};

/// Part of its acceleration that a piece has along it.
double piece_acceleration(const Piece& piece);

/// The moves that the planner is given: those in line within Q merged, flat arcs as two lines.
std::vector<Piece> linuxcnc_pieces(const std::vector<ControlMove>& moves, const ControlLimits& limits);

/// An arc within the tolerance of a corner, tangent to both pieces.
struct TangentArc {
  double length = 0.0;                           ///< m
  double taken_before = 0.0, taken_after = 0.0;  ///< m, of the pieces
};
/// If a piece is an arc, the sides of both decide which of several arcs of this radius it is. None where it leaves
/// the tolerance, the plane of the pieces or the parts of them that it may take.
/// @param radius     m  @param tolerance  m
/// @param part_before, part_after  rad, of arcs
std::optional<TangentArc> tangent_arc(const Piece& before, const Piece& after, double radius, double tolerance,
                                      double part_before, double part_after);
/// Whether an arc and the blend beside it lie on the same side of their tangent. @param towards  from the corner
bool bends_with(const Vector& center, const Vector& towards);

/// The times that two pieces overlap in a parabolic blend.
struct ParabolicBlend {
  double speed_before = 0.0, speed_after = 0.0;  ///< m/s, where it begins and ends
  double speed = 0.0;                            ///< m/s, in its middle, along it
};
/// @param part  of the lengths that may be used: 0.5 where further blends may shorten them
ParabolicBlend parabolic_blend(const Piece& before, const Piece& after, double part);

/// Adds the next piece with the blend before it. The last piece of the queue changes, or goes where a blend takes all
/// of it.
void add_piece(std::vector<Piece>& queue, Piece piece, const ControlLimits& limits, const ControlSettings& settings);

/// No blend changes the piece any more: its largest speed follows from its length and curvature.
void fix_length(Piece& piece, double period);

}  // namespace accdec
