#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// Place of a path and its first two derivatives by the parameter u, one value a dimension.
struct PathPlace {
  std::array<double, program_axis_count> position{}, first{}, second{};
};

/// The smooth curve through the ends of the chords of a spline: a cubic spline by the length of the chords, whose
/// second derivatives go on evenly at both ends.
class ChordCurve {
 public:
  /// Blocks first .. last, at least two.
  ChordCurve(const Toolpath& path, std::size_t first, std::size_t last);
  double length() const { return knot_.back(); }
  /// The parameter at the end of chord i; that of its begin is end(i - 1).
  double end(std::size_t i) const { return knot_[i + 1]; }
  std::size_t chords() const { return knot_.size() - 1; }
  PathPlace at(double u) const;
  /// m, of the curve from its chords, at most.
  double off_chords() const;

 private:
  std::size_t n_;
  std::vector<double> point_, knot_, second_;  // of every end of a chord: position, parameter, second derivative
};

}  // namespace accdec
