#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/motion/corner.hpp>
#include <accdec/motion/filter_spec.hpp>

namespace accdec {

/// What a design minimises: see objective.hpp.
enum class Objective { cycle, corner };

/// Bounds on what the design may choose, and what it is to minimise.
struct DesignBounds {
  int order_min = 1;
  int order_max = 400;
  bool symmetric = false;
  Objective objective = Objective::cycle;
  double runs = 1.0;  ///< > 0; from rest to rest, together they pass every corner as often as its weight says
};

/// One corner of a task. Angles are kept as given, so that a result can state them.
struct TaskCorner {
  std::string name;
  double angle = 0.0;    ///< rad, interior, 0 < angle <= pi
  double heading = 0.0;  ///< rad
  Turn turn = Turn::left;
  std::vector<double> direction_in,
      direction_out;                ///< instead of angle, heading and turn, for any number of axes; else empty
  double feed_in = 0.0;             ///< m/s
  double feed_out = 0.0;            ///< m/s
  std::optional<double> error_max;  ///< m; none: no bound
  double speed_min = 0.0;           ///< m/s, bound on the smallest tangential speed
  std::optional<int> delay;         ///< samples; none: to be chosen
  double weight = 1.0;              ///< > 0, of this corner in the cycle time

  Corner geometry;  ///< made from the above by the reader, as many axes as the machine
};

/// A design task: what accdec reads from a task file. SI throughout.
struct Task {
  std::string title;
  double sample_period = 1e-3;         ///< s
  std::optional<FilterSpec> filter;    ///< none: to be designed
  std::optional<FilterSpec> baseline;  ///< [baseline]: the filter the machine has today, to compare designs with
  DesignBounds design;
  Machine machine;
  std::vector<TaskCorner> corners;
  std::optional<double> program_error_max;  ///< m, [program] error_max_um
};

}  // namespace accdec
