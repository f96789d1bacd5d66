#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

using Vector = Eigen::Vector3d;
/// One value for each of A B C U V W; a degree counts as a millimetre.
using OtherAxes = std::array<double, 6>;

/// A move as a program gives it to a control: a line, or a whole arc or helix.
struct ControlMove {
  Vector from, to;      ///< m
  Vector first, last;   ///< unit directions at both ends
  double length = 0.0;  ///< m, of the axes that F measures: X Y Z, else U V W, else A B C
  OtherAxes others{};   ///< m, their way; only of linuxcnc-2.9
  double feed = 0.0;    ///< m/s, within the axes' velocities where feeds are clamped
  bool rapid = false, arc = false;
  Eigen::Index x = 0, y = 1;       ///< axes of the arc's plane
  Vector center = Vector::Zero();  ///< m, in the arc's plane
  double radius = 0.0;             ///< m
  double angle = 0.0;              ///< rad, signed
  double dwell = 0.0;              ///< s, at its end
  bool dwells = false;             ///< there is a dwell at its end
  bool ends = false;               ///< the program's last
  bool waits = false;              ///< words that many controls carry out at rest follow: M0, M3 ..
  PathControl control = PathControl::blend;
  double tolerance = 0.0;  ///< m, G64 P; 0: none given
  double merge = 0.0;      ///< m, G64 Q
};

/// The moves of a path. Arcs come back from their chords, and arcs that go on along one circle are one. A move without
/// X Y Z has the direction of X, as LinuxCNC's planner has it.
/// @throws std::invalid_argument for an axis other than X Y Z, unless the control is linuxcnc-2.9
std::vector<ControlMove> control_moves(const Toolpath& path, std::string_view control);

/// The point of an arc at a part of its angle, 0 .. 1.
Vector arc_point(const ControlMove& arc, double part);

/// Limits of X Y Z and of the other axes. Axes that the program does not move may be unlimited.
struct ControlLimits {
  Vector velocity, acceleration;  ///< m/s and m/s^2
  OtherAxes other_velocity{}, other_acceleration{};
};
/// @throws std::invalid_argument if an axis that moves has no acceleration limit
ControlLimits control_limits(const Toolpath& path, const Machine& machine, std::string_view control);

/// The largest value along a direction such that no axis exceeds its own.
double along(const Vector& direction, const Vector& limits);
/// Whether another axis than X Y Z moves.
bool moves_others(const ControlMove& move);
/// The largest value along a move's length by the limits of its other axes.
double along_others(const ControlMove& move, const OtherAxes& limits);

/// s. Duration from one speed to another within a cruising speed, under one acceleration. If the length is too short
/// for the speeds, it is that of a steady change.
double trapezoid_time(double length, double from, double cruise, double to, double acceleration);

}  // namespace accdec
