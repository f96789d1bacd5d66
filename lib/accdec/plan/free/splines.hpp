#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <accdec/plan/free/free_path.hpp>
#include <accdec/plan/free/shorten.hpp>

namespace accdec {

/// The tube and the limits of control points of cubic splines. Bounds on the differences of control points bound the
/// derivatives of the spline, and so the differences of its samples.
class SplineTube {
 public:
  /// @param spacing  samples from a control point to the next, a power of two
  SplineTube(const FreePath& fine, std::size_t spacing);
  SplineTube(const SplineTube&) = delete;
  SplineTube& operator=(const SplineTube&) = delete;

  std::size_t spacing() const { return spacing_; }
  /// Whether the tolerances of a part's joints have room for what a spline is off its control points.
  bool has_room(const FreePart& part) const;
  /// A part of the program's motion (rows), shortened as splines: a window of control points is longer in time. Windows
  /// of samples join it to the motion around it. The part stays as it is where that does not make it faster.
  /// @param size  control points of a window
  ShortenedPart shorten(const std::vector<double>& position, const FreePart& part, std::size_t size,
                        const std::function<bool()>& stop) const;

 private:
  ShortenedPart joined(const std::vector<double>& position, const FreePart& part, const std::vector<double>& spline,
                       std::size_t taken, ShortenedPart result) const;

  const FreePath& fine_;
  const std::size_t spacing_;
  const double loss_;  // m, of tolerances
  const Toolpath path_;
  const Machine machine_;
  FreePath tube_;
};

}  // namespace accdec
