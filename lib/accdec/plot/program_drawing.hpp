#pragma once

#include <array>
#include <vector>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/plot/program_view.hpp>

namespace accdec {

// Internal to the room: the path of a program as lines of a drawing, no two in a row shorter than can be seen.

/// A straight line of the drawing, m. Moves shorter than a pixel or two are combined.
struct Stroke {
  std::array<double, 2> from{}, to{};
  double speed = 0.0;  ///< m/s, the lowest on it
  bool rapid = false;
};
/// The strokes with the commanded speeds.
std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramView& view);
/// The strokes with the speeds of the motion along the path.
std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramMotion& motion, const ProgramView& view);

/// Width in px; the more of the drawing the strokes fill, the thinner they are.
double stroke_width(const std::vector<Stroke>& strokes, const ProgramView& view);

/// Strokes as one series, rapid moves or feed moves; gaps are NaN. If there are too many to see, every row of pixels
/// once.
Series stroke_series(const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid);

/// Feed moves in the colours of their speed, mm/s, slow ones on top.
ColouredLines speed_lines(const std::vector<Stroke>& strokes, const ProgramView& view);

/// A place and its value.
struct PlaceValue {
  std::array<double, 2> place{};
  double value = 0.0;
};
/// Places as squares in the colours of their values, with the largest values on top. If some would hide each
/// other, only the largest is drawn. Sets the line width.
std::vector<ColouredLines::Piece> squares(const std::vector<PlaceValue>& places, const ProgramView& view,
                                          double& line_width);

}  // namespace accdec
