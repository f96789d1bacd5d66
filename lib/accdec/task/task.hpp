#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
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

/// Legs in the plane of the first two axes.
struct PlanarLegs {
  double angle = 0.0;    ///< rad, interior, 0 < angle <= pi
  double heading = 0.0;  ///< rad, travel direction on leg 1 from +x towards +y
  Turn turn = Turn::left;
};
/// Legs along any directions: vectors of any positive length, one number an axis.
struct DirectedLegs {
  std::vector<double> in, out;
};
/// The legs of a corner as given, so that a result can state them.
using CornerLegs = std::variant<PlanarLegs, DirectedLegs>;

/// One corner of a task. Its geometry follows from legs and feeds and cannot disagree with them.
class TaskCorner {
 public:
  /// @param feed_in, feed_out  m/s, > 0
  /// @param axes               of the machine, for planar legs; others say themselves how many there are
  /// @throws std::invalid_argument on values outside these ranges
  TaskCorner(std::string name, CornerLegs legs, double feed_in, double feed_out, int axes = 2);

  std::string name;
  std::optional<double> error_max;  ///< m; none: no bound
  double speed_min = 0.0;           ///< m/s, bound on the smallest tangential speed
  std::optional<int> delay;         ///< samples; none: to be chosen
  double weight = 1.0;              ///< > 0, of this corner in the cycle time

  const CornerLegs& legs() const { return legs_; }
  const Corner& geometry() const { return geometry_; }
  /// @throws std::invalid_argument unless both are positive and finite, m/s
  void set_feeds(double feed_in, double feed_out);

 private:
  CornerLegs legs_;
  Corner geometry_;
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
