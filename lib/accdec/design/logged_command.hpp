#pragma once

#include <vector>

#include <Eigen/Core>

#include <accdec/design/motion_log.hpp>

// Internal to the room: the command behind a logged motion.

namespace accdec {

/// Legs of a logged motion at constant speed, before any filter is known. Times are in samples and real: they are later
/// than those of the command by the filter's mean delay.
struct LoggedCommand {
  struct Leg {
    double first = 0.0, last = 0.0;  ///< when the extended part at constant speed begins and ends the leg
    Eigen::VectorXd way;             ///< m
  };
  std::vector<Leg> legs;                  ///< one or two
  Eigen::VectorXd start;                  ///< m
  int moving_first = 0, moving_last = 0;  ///< samples between which the axes move
  double step = 0.0;                      ///< m, of a sample of the faster leg
  int longest_ramp = 0;                   ///< samples from rest to constant speed or back, at most
  /// m, standard deviation of the positions of an axis, as differences show it at rest and at constant speed: the root
  /// of the mean square of the axes that move
  double noise = 0.0;
  /// m, the least noise: positions that are multiples of a step have its part of 1 / sqrt(12), of the same axes
  double rounding = 0.0;
  /// By axis, in inverse proportion to its noise: differences times these have one standard deviation. 0: the axis
  /// rests, and tells nothing of a filter.
  Eigen::VectorXd weights;

  /// Axes that tell something.
  long axes() const { return (weights.array() > 0.0).count(); }
};

/// @throws std::invalid_argument as `identify`
LoggedCommand logged_command(const MotionLog& log);

}  // namespace accdec
