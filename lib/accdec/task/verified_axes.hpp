#pragma once

#include <string>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/task/simulation.hpp>

// Internal to the room: the verifier's own formulas of the limits of axes, at the samples of its simulation.

namespace accdec {

struct Peak {
  double value = 0.0;
  Event event = Event::start;
  int sample = 0;
};

LimitUse make_use(LimitKind kind, const std::string& axis, const std::string& corner, const Peak& peak, double bound);
/// Speed of a corner's motion below which an axis stands still, m/s.
double still_speed(const Corner& corner);
/// How far out a speed and a force are on their ray from the origin, as part of the way to the force-speed curve.
double part_of_curve(const Axis& axis, double velocity, double force);
/// Power of all axes together at one row, W. @param still  m/s
double total_power(const SampledMotion& motion, const Machine& machine, int row, double still);
/// The value that an axis limit bounds, at one row: of the command, or of the motion behind the servo.
double axis_quantity(LimitKind kind, const SampledResponse& response, const Axis& axis, Eigen::Index a, int row,
                     double still);
/// Uses of the limits of all axes, and of the supply that they share.
void axis_uses(const SampledResponse& response, const Machine& machine, const std::string& corner, double still,
               std::vector<LimitUse>& uses);

}  // namespace accdec
