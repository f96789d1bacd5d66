#pragma once

#include <cstddef>
#include <vector>

#include <accdec/task.hpp>

namespace accdec::attack {

/// Rows of as many numbers as there are taps, one behind the other: row . b is what the row measures.
struct Rows {
  std::size_t taps = 0;
  std::vector<double> values;
  std::size_t size() const { return taps == 0 ? 0 : values.size() / taps; }
  const double* row(std::size_t i) const { return &values[i * taps]; }
  double* fresh() {
    values.resize(values.size() + taps);
    return &values[values.size() - taps];
  }
};
double dot(const double* row, const std::vector<double>& taps);

/// Power or regeneration at a sample: |(of_now now - of_before before) now| with the sign, at most `bound`, where now
/// and before are an axis' velocity.
struct PowerLimit {
  std::size_t now, before;  ///< rows of Physics::velocities
  double of_now, of_before, bound, sign;
};
/// Smallest speed at a sample: rows of the velocity in the plane of the legs, x along leg 1.
struct SpeedLimit {
  std::size_t x, y;    ///< rows of Physics::velocities
  double bound, turn;  ///< m/s; rad, from leg 1 to leg 2: the velocity is between
};
/// The error of a corner: of each sample of the blend two rows, its position in the plane of the legs, m.
struct ErrorLimit {
  std::size_t corner;
  double bound;      ///< m; may be 0
  double cut_bound;  ///< m; not below what numbers near it still tell apart
  Rows positions;
  std::size_t first,
      last;  ///< samples that can be nearest: before leg 2 has begun or after leg 1 is over all lead away
};

/// By how many samples the control's own smoothing and the servo of all axes lengthen a motion.
int response_order(const Task& task);
/// Samples that a control takes from within its in-position width to the next block.
int latency_of(const Task& task);
/// Whether some in-position width may give these delays. Corners of equal feeds then wait equally long, faster ones
/// longer or as long, and none longer than the filtered motion.
bool may_have_width(const Task& task, int order, const std::vector<int>& delays);

/// Everything a filter of this order with these delays does, from sampled commands: rest, leg 1, gap, leg 2, rest, once
/// for every unit tap. Nothing of the library but the task's numbers is used.
struct Physics {
  Physics(const Task& task, int order, const std::vector<int>& delays);

  Rows linear;      ///< velocity, acceleration, jerk, force over their bounds, in-position widths: |row . b| <= 1
  Rows cones;       ///< residual vibration over its bound: of each frequency two rows, together of length <= 1
  Rows velocities;  ///< m/s, of the limits that are not convex
  std::vector<PowerLimit> powers;
  std::vector<SpeedLimit> speeds;
  std::vector<ErrorLimit> errors;
  double most = 1.0;  ///< no entry of linear and cones, and no error over its bound, is larger in magnitude

 private:
  void add_corner(const Task& task, std::size_t j, int order, int delay);
  void add_widths(const Task& task, const std::vector<int>& delays);
  /// @param moved      the velocity behind the servo  @param direction  of the motion, if the axis keeps it
  void add_axis(const Axis& axis, const Rows& velocity, const Rows& moved, double period, double direction);
};

/// Largest use of any limit by the taps, 1 is the bound; of each corner's error at its nearest sample.
double worst_use(const Physics& physics, const std::vector<double>& taps);
double nearest(const ErrorLimit& error, const std::vector<double>& taps);
double error_at(const ErrorLimit& error, std::size_t k, const std::vector<double>& taps);
double power_use(const Physics& physics, const PowerLimit& limit, const std::vector<double>& taps);
double speed_use(const Physics& physics, const SpeedLimit& limit, const std::vector<double>& taps);

}  // namespace accdec::attack
