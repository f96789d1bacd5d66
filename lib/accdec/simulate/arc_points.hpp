#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Points of the arcs of a path, and how far a motion stays from them. Every block of an arc gives one, in its middle
/// by the arc's own angle and radius. The ends of chords are on their arcs, and are judged as joints.
class ArcPoints {
 public:
  /// @param path  its arcs are those of its blocks
  explicit ArcPoints(const Toolpath& path);
  bool empty() const { return block_.empty(); }

  /// A straight piece of the motion, seen from the points of blocks first .. last.
  void look(const double* from, const double* to, std::size_t first, std::size_t last);
  /// The point with the largest part of what is allowed: the larger tolerance of the block's joints, and what the chord
  /// is off the arc there. None without arcs.
  std::optional<ArcError> worst() const;

  std::size_t count() const { return block_.size(); }
  std::size_t block(std::size_t i) const { return block_[i]; }
  const double* point(std::size_t i) const { return point_.data() + i * path_.dimensions(); }
  /// Takes the distance of the motion from a point, m.
  void set_distance(std::size_t i, double distance) { distance2_[i] = distance * distance; }

 private:
  void add_arc(const PathArc& arc, const std::vector<double>& radius);

  const Toolpath& path_;
  std::vector<std::size_t> block_;  // ascending
  std::vector<double> point_, allowed_, distance2_;
  std::size_t first_ = 0;  // the point that `look` begins with
};

}  // namespace accdec
