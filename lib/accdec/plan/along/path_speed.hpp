#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace accdec {

/// The fastest way along a path whose acceleration and jerk are bounded axis by axis. The unknowns are the squared
/// speeds x of the parameter u at nodes. In a cell between two nodes the speed changes at a constant acceleration b,
/// and an axis accelerates by q'' x + q' b in its middle. Its jerk at a node is the change of this over the time
/// between the middles of both cells.
///
/// Acceleration is linear in x, jerk is not. A barrier keeps every step inside all bounds (S. Boyd, L. Vandenberghe:
/// Convex Optimization, 11.3); every matrix has half-bandwidth 2.
struct PathSpeed {
  std::size_t axes = 0;
  std::vector<double> node;                        ///< u, ascending; the motion rests at both ends
  std::vector<double> cap;                         ///< of x, of every node
  std::vector<double> first, second;               ///< rows of `axes`: q' and q'' in the middle of every cell
  std::vector<double> acceleration_max, jerk_max;  ///< of every axis; may be unlimited

  std::size_t cells() const { return node.size() - 1; }
  /// Whether all bounds hold, with room.
  bool holds(const std::vector<double>& x) const;
  /// Makes x as fast as its bounds allow. @param x  a start that holds, see `holds`
  /// @param most  s; ends as soon as the least time is above it by the barrier's multipliers, which is right without
  ///              jerk limits and nearly so with them
  /// @param stop  ends it earlier, with what holds
  /// @returns false if the least time is above `most`
  bool solve(std::vector<double>& x, double most, const std::function<bool()>& stop) const;
  /// s, at the squared speeds x.
  double time(const std::vector<double>& x) const;
};

}  // namespace accdec
