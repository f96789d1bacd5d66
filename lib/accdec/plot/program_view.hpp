#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// The direction from which a program is seen. `automatic` takes the plane in force (G17, G18, G19) for most of the
/// feed distance, if feed moves have both its axes. Otherwise it takes the two axes along which feed moves go farthest,
/// linear ones first. Rapid moves never decide. `iso`: from the front, the right and above, lengths along x, y and z as
/// they are.
enum class ViewFrom : std::uint8_t { automatic, xy, xz, yz, iso };
/// @param name  "auto", "xy", "xz", "yz" or "iso"  @throws std::invalid_argument for another
ViewFrom view_from(const std::string& name);

// The rest is internal to the room.

/// The part of the path that is drawn: a projection of its points, and a window on it.
struct ProgramView {
  /// Coefficients of the path's columns, for the drawing's two axes; all 0 for an axis that the path does not move.
  std::array<ProgramPoint, 2> rows{};
  std::array<std::string, 2> names;     ///< of the drawing's axes: x; several axes: isometric
  std::array<bool, 2> rotary{};         ///< a degree counts as a millimetre
  std::size_t dimensions = 0;           ///< of the path
  std::array<double, 2> low{}, high{};  ///< m, of the window
  double pixel = 1.0;                   ///< m, of the drawing
  double height = 1.0;                  ///< px of the plot
  double scale = 1e3;                   ///< units of the drawing a metre: mm, or m for a path that long
  /// How many times longer each axis is drawn than its lengths; `rows` and the window are stretched.
  std::array<double, 2> stretch{1.0, 1.0};
  std::optional<std::size_t> over_time;  ///< of a program that only drills: the column shown over time

  std::array<double, 2> at(const double* point) const;
  /// A length of the window in units of the drawing.
  double drawn(std::size_t axis, double length) const { return length * scale / stretch[axis]; }
  bool shows(const std::array<double, 2>& p, const std::array<double, 2>& q) const;  ///< whether a line may be seen
};

/// The whole path.
ProgramView whole_view(const Toolpath& path, ViewFrom from = ViewFrom::automatic);
/// A long and thin path would leave empty sides beside it. If it fills less than a third of its plot's width or height,
/// the view has its short axis stretched by a round number, 2 to 100. Straight and isometric ones are left as they are.
ProgramView stretched(ProgramView view);
/// A window a quarter as wide and as high (half along a stretched axis), around as many of the places as it can hold.
ProgramView enlarged(const ProgramView& view, const std::vector<std::array<double, 2>>& places);

inline constexpr double view_width = 640.0;  ///< px of a plot

}  // namespace accdec
