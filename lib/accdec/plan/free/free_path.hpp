#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The path with its tube and the limits of the axes: a free motion must keep them.
struct FreePath {
  const Toolpath path;         ///< its tolerances within its contour
  const Machine& machine;      ///< as many axes as the path
  double period;               ///< s
  std::vector<double> radius;  ///< m, of the tube around every block, see allowed_off
  std::vector<double> feed;    ///< m/s, of every block; unlimited for rapid moves, which their axes bound
  bool jerk = false;           ///< some axis limits its jerk
  double slack = 0.0;          ///< m, by which samples that are not yet shortened may be off the tube

  FreePath(const Toolpath& toolpath, const Machine& limits, double sample_period);
  /// Under a contour, the motion passes a joint where it is within the contour of both blocks. So no step from one to
  /// the other is farther off. That place may be farther from the joint than the tube is wide.
  bool has_contour() const { return path.contour_max < unlimited; }
  /// Largest distance in m at which the joint at the end of a block is passed.
  double passes_within(std::size_t joint) const {
    const double tolerance = path.tolerance[joint];
    return has_contour() && tolerance < unlimited ? tolerance : std::min(tolerance, radius[joint]);
  }
  std::size_t dimensions() const { return path.dimensions(); }
  /// Samples on either side of a part that its limits see.
  std::size_t border() const { return jerk ? 3 : 2; }
  /// Samples of rest for the dwells at the end of a block.
  std::size_t rests_at(std::size_t block) const;
};

/// A motion, sample by sample; the first sample is at rest in the first point, the last at rest in the last.
struct FreeSamples {
  std::vector<double> position;  ///< rows of `dimensions`, m
  std::vector<double> passes;    ///< of every joint, the sample at which it is passed, with a fraction; ascending
  std::size_t count(std::size_t dimensions) const { return position.size() / dimensions; }
};

/// The block of every sample.
std::vector<std::size_t> legs_of(const Toolpath& path, const FreeSamples& motion);

}  // namespace accdec
