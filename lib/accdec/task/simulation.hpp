#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

/// The sampled motion of one corner from rest to rest. Columns are machine axes, rows samples.
struct SampledMotion {
  Eigen::MatrixXd velocity;      ///< m/s
  Eigen::MatrixXd acceleration;  ///< m/s^2, (V'[n] - V'[n-1])/T
  Eigen::MatrixXd jerk;          ///< m/s^3
  Eigen::MatrixXd position;      ///< m, relative to the corner point; right-rectangle sum
  int start = 0;                 ///< row of the last rest sample before leg 1: k = 0 of the start
  int corner = 0;                ///< row of the last command sample of leg 1: k = 0 of the blend
  int stop = 0;                  ///< row of the last command sample of leg 2: k = 0 of the stop
  int cruise_in = 0;             ///< a row at full speed on leg 1, between start and blend
  int cruise_out = 0;            ///< a row at full speed on leg 2, between blend and stop
};

/// Plain convolution of the command stream (rest, leg 1, gap, leg 2, rest) with the taps; both legs long enough to
/// reach full speed.
/// @param part  of both feeds, at which the corner is passed (corner_feed.hpp)
SampledMotion simulate_corner(const Filter& filter, const Corner& corner, int delay, double sample_period,
                              double part = 1.0);

/// One corner's command and its motion behind the machine's response (machine/response.hpp). Both have the same rows.
struct SampledResponse {
  SampledMotion command;               ///< behind the control's own smoothing
  std::optional<SampledMotion> moved;  ///< behind the servos of the axes; none if all are ideal
  int longer = 0;                      ///< samples by which the response lengthens the motion
  const SampledMotion& motion() const { return moved ? *moved : command; }
};

/// The same with the machine's response. The smoothing, and taps of a servo that were measured, are convolved. The
/// following error e of a servo of gain Kv is integrated exactly: e' = (1 - g) V' - Kv e, with V' constant in a sample.
/// Axes may differ.
/// @param part  of both feeds, at which the corner is passed (corner_feed.hpp)
SampledResponse simulate_response(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                  const Machine& machine, double part = 1.0);

/// State of an axis in every row: velocity, acceleration and jerk of the command, force and power of the motion.
/// @param a      column of the axis
/// @param still  m/s; a slower motion counts as rest for dry friction
std::vector<AxisState> axis_states(const SampledResponse& sampled, const Axis& axis, Eigen::Index a,
                                   double sample_period, double still);

}  // namespace accdec
