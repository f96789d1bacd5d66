#pragma once

#include <array>
#include <vector>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/program_motion.hpp>

namespace accdec {

// Internal to the room: the path of a program as lines of a drawing, none shorter than can be seen.

/// What of the path is drawn: the two axes of the largest extent, linear ones first, and a window on them.
struct ProgramView {
  std::size_t across = 0, up = 0;
  std::array<double, 2> low{}, high{};  ///< m, of the window
  double pixel = 1.0;                   ///< m, of the drawing
  double height = 1.0;                  ///< px of the plot
  double scale = 1e3;                   ///< units of the drawing a metre: mm, or m for a path that long

  std::array<double, 2> at(const Toolpath& path, std::size_t point) const;
  bool shows(const std::array<double, 2>& p, const std::array<double, 2>& q) const;  ///< whether a line may be seen
};

/// The whole path.
ProgramView whole_view(const Toolpath& path);
/// A window a quarter as wide and as high, around as many of the places as it can hold.
ProgramView enlarged(const ProgramView& view, const std::vector<std::array<double, 2>>& places);

/// A straight line of the drawing, m. Moves shorter than a pixel or two are put together.
struct Stroke {
  std::array<double, 2> from{}, to{};
  double speed = 0.0;  ///< m/s, the lowest on it
  bool rapid = false;
};
/// With the commanded speeds.
std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramView& view);
/// With the speeds of the motion along the path.
std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramMotion& motion, const ProgramView& view);

/// px, thinner the more of the drawing the strokes fill.
double stroke_width(const std::vector<Stroke>& strokes, const ProgramView& view);

/// Strokes as one series, rapid moves or feed moves; gaps are NaN. Of too many to see every row of pixels once.
Series stroke_series(const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid);

/// Feed moves in the colours of their speed, mm/s, slow ones on top.
ColouredLines speed_lines(const std::vector<Stroke>& strokes, const ProgramView& view);

/// A place and its value.
struct PlaceValue {
  std::array<double, 2> place{};
  double value = 0.0;
};
/// Places as squares in the colours of their values, the largest on top; of those that would hide each other the
/// largest. Sets the line width.
std::vector<ColouredLines::Piece> squares(const std::vector<PlaceValue>& places, const ProgramView& view,
                                          double& line_width);

}  // namespace accdec
