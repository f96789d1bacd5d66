#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include <accdec/motion/smallest_delay.hpp>
#include <accdec/program/plan/corner_limits.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>

namespace accdec {

/// Smallest delays of single joints, as if each were alone, for any of a set of filters on either side. Keeps
/// references.
class JointDelays {
 public:
  JointDelays(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine);

  /// Of a stop or a corner taken as one.  @param f_in, f_out  filters of the blocks before and after joint b, by index
  int stop(std::size_t b, std::size_t f_in, std::size_t f_out);
  /// @param factor_in, factor_out  by which the feeds of both blocks are lowered to whole samples
  int corner(std::size_t b, std::size_t f_in, std::size_t f_out, double factor_in = 1.0, double factor_out = 1.0);
  /// Of a smooth or straight joint, inside a leg with filter f.
  int smooth(std::size_t b, std::size_t f);
  /// Whether filter f starts the block from rest and stops it within the limits.
  bool starts(std::size_t b, std::size_t f);

  /// Whether no joint so far breaks a limit even where its legs do not overlap.
  bool limits_possible() const { return possible_; }
  /// The same since the last call of this.
  bool take_possible() { return std::exchange(possible_, true); }

 private:
  void load(std::size_t block, double factor, std::array<double, program_axis_count>& velocity, double& speed) const;
  double cos_interior() const;
  int within_limits(std::size_t f_in, std::size_t f_out, int delay);
  const DelayFinder& finder(std::size_t f_in, std::size_t f_out);
  int exact_stop(std::size_t f_in, std::size_t f_out) const;

  const Toolpath& path_;
  std::span<const Filter> filters_;
  double period_;
  CornerLimits limits_;
  std::vector<std::unique_ptr<DelayFinder>> finders_;    // of every pair, made when first asked for
  std::vector<double> spread_;                           // of every filter
  std::array<double, program_axis_count> in_{}, out_{};  // velocities, m/s
  double speed_in_ = 0.0, speed_out_ = 0.0;
  bool possible_ = true;
};

}  // namespace accdec
