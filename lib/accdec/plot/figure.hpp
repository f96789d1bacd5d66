#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace accdec {

/// Number of lines of a panel with different styles: more cannot be distinguished.
inline constexpr std::size_t most_lines = 24;

/// How a series is drawn. Styles count up from 0. They differ in dash or symbol as well as in colour, so that they can
/// be distinguished in grey. This holds for the first 8 plain lines, the first 15 symbols, and the first 16 (and many
/// more) marked lines. `steps` holds each value over the interval that ends at its x. `bars` stand on the axis, as wide
/// as the distance of the x. `marked_line` is a line with a few symbols evenly spaced across the panel, at different
/// places for each style; its x must not decrease.
enum class Mark { line, points, line_points, steps, impulses, bars, marked_line };

struct Series {
  std::string label;  ///< for the legend; empty: not in the legend
  std::vector<double> x, y;
  Mark mark = Mark::line;
  int style = 0;
  bool solid = false;  ///< a line without the dashes of its style, for lines that take turns along one curve
  int dash = 0;        ///< of a solid line: the style whose dashes it has, to tell lines of one colour apart
};
/// A horizontal limit, drawn dashed across the panel.
struct LimitLine {
  double y = 0.0;
  std::string label;
  std::string name = {};  ///< stands on the line's right end, where a panel has limits of several axes
};
/// A word above a point, or below it, in the colour of a limit that binds.
struct Note {
  double x = 0.0, y = 0.0;
  std::string text;
  bool below = false;
};
/// A vertical band, shaded.
struct Band {
  double from = 0.0, to = 0.0;
  std::string label;
};
struct Circle {
  double x = 0.0, y = 0.0, radius = 0.0;
  std::string label;
  bool disc = false;  ///< filled, behind everything, in place of a dashed line
};
/// A value at each (x[i], y[j]), values[j * x.size() + i]. x and y rise and have at least one value each; they are
/// positive if the panel's scale is logarithmic. On the scale, a cell reaches half-way to its neighbours. A value that
/// is not finite leaves the paper blank. Values of both signs are drawn in two colours that meet at 0.
struct HeatMap {
  std::vector<double> x, y, values;
  std::string label;
  bool with_sign = false;  ///< colours meet at 0 even where no value lies on its other side
};
/// Lines in the colours of a value, with later pieces over earlier ones. The colour bar replaces the legend.
struct ColouredLines {
  struct Piece {
    std::vector<double> x, y;
    double value = 0.0;
  };
  std::vector<Piece> pieces;
  double low = 0.0, high = 1.0;  ///< values at the ends of the colour bar
  double line_width = 1.8;       ///< px
  std::string label;
};
struct Scale {
  std::string label;  ///< with the unit: "time / ms"
  bool log = false;
  std::optional<double> min, max;
  std::vector<std::string> names = {};  ///< of the values 1, 2, ..., in place of numbers
  bool whole = false;                   ///< values are counts: ticks stand at whole numbers only
};
struct Panel {
  std::string title;
  Scale x, y;
  std::vector<Series> series;
  std::vector<LimitLine> limits;
  std::vector<Note> notes;
  std::vector<Band> bands;
  std::vector<Circle> circles;
  std::optional<HeatMap> heat_map;
  std::optional<ColouredLines> coloured;  ///< not beside a heat map
  bool equal_aspect = false;  ///< one unit of x is as long as one of y; needs ranges or series to take them from
  double stretch = 1.0;       ///< with equal_aspect: one unit of y is as long as this many of x; circles are ellipses
  double taller = 1.0;        ///< its row is this many times the figure's panel height; the largest of a row counts
};

/// A page of panels, filled row by row. Legends stand to the right of each panel, outside its data, in one column. If
/// few lines end at the right, each label stands at its line's end. A label that is alone in its panel is a title.
/// Panels grow beyond the given size where the legend needs it. Titles are wrapped. Labels too long for their place are
/// shortened in the middle.
struct Figure {
  std::string title;
  std::vector<Panel> panels;
  int columns = 1;
  bool one_legend = false;  ///< below the title, for all panels: a label means the same in each
  int panel_width = 620;    ///< px, legend included; at least
  int panel_height = 300;   ///< px, at least
};

/// Whether there is anything to draw: a series, heat map, coloured line or circle with a finite point, positive if the
/// scale is logarithmic. A panel without such a point is drawn with the words "no data".
bool has_data(const Panel& panel);

/// The figure as a gnuplot script for its SVG terminal. Titles are data: gnuplot draws any text in them and executes
/// nothing. In gnuplot_script.cpp.
/// @throws std::invalid_argument if a series' or piece's x and y differ in length, a heat map has wrong sizes x or y
/// that do not rise
///         or stands beside coloured lines, or there is no panel.
std::string gnuplot_script(const Figure& figure);

/// The figure as SVG, the same bytes for the same figure. @throws std::runtime_error if gnuplot is missing or fails.
std::string render_svg(const Figure& figure);

/// SVG to "png" or "pdf" by rsvg-convert, or to "html" (the drawing inline, nothing linked). "svg" returns it
/// unchanged.
/// @throws std::invalid_argument on another format, std::runtime_error if rsvg-convert is missing or fails.
std::string convert_svg(const std::string& svg, const std::string& format, const std::string& title = "");

/// Asks for the tools that draw a format before anything long is computed. @throws MissingProgram
void require_drawing(const std::string& format);

/// Format of a file by its extension: "svg", "png", "pdf" or "html". @throws std::invalid_argument naming these.
std::string figure_format(const std::string& path);

/// A title as one line of valid UTF-8: control characters become spaces, invalid bytes become '?'.
std::string clean_title(const std::string& text);

}  // namespace accdec
