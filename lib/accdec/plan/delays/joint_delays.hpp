#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/known_corners.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {

/// Smallest delays of single joints, as if each were alone. Keeps references.
///
/// It shares the tolerances' DelayFinder and BlendLimits with designs, but not `task/blend_check.hpp`. That needs a
/// task and its corner, which would have to be made for each of 10^6 joints. Joints also differ in their rules: a
/// control's kinds of delays change the search, and tolerances hold to `position_floor`.
class JointDelays {
 public:
  JointDelays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

  /// The delay of a stop, or of a corner taken as one. Factors as for a corner.
  int stop(std::size_t b, double factor_in = 1.0, double factor_out = 1.0);
  /// @param factor_in, factor_out  by which the feeds of both blocks are lowered to whole samples
  int corner(std::size_t b, double factor_in, double factor_out);
  /// The delay of a smooth or straight joint.
  int smooth(std::size_t b);

  /// Whether no joint so far breaks a limit even where its legs do not overlap, or asks its control for a longer
  /// exact stop or in-position than it has.
  bool limits_possible() const { return possible_; }
  /// The same since the last call of this.
  bool take_possible() { return std::exchange(possible_, true); }

 private:
  void load(std::size_t block, double factor, std::array<double, program_axis_count>& velocity, double& speed) const;
  double cos_interior() const;
  /// The delay of the velocities loaded, which needs nothing else than these numbers.
  template <class Compute>
  int known(double number, bool stop, const Compute& compute);
  int within_limits(int delay, bool stop = false);
  int within_contour(int delay) const;
  /// The corner between the blocks loaded.
  Corner loaded() const;
  /// The shortest within the limits that the control has; if it has none, the shortest within the limits.
  int of_control(int delay);
  /// At which the command rests; a servo may still follow.
  int exact_stop() const;
  int within_tolerance(std::size_t b) const;
  /// How long the program dwells at the end of block b, samples.
  std::int64_t dwell_samples(std::size_t b) const;

  const Toolpath& path_;
  const Filter& filter_;  // of the command
  const FilterBehind behind_;
  double period_;
  BlendLimits limits_;
  DelayFinder finder_;
  double spread_ = 0.0;
  std::array<double, program_axis_count> in_{}, out_{};  // velocities, m/s
  double speed_in_ = 0.0, speed_out_ = 0.0;
  bool possible_ = true;
  struct Delay {
    int samples;
    bool possible;
  };
  KnownCorners<Delay> known_;
};

}  // namespace accdec
