#pragma once

#include <string>
#include <vector>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/figure_legend.hpp>

namespace accdec {

/// Width of text in the font of figures (DejaVu Sans, 12 px), px: from the widths of its letters, rounded up.
double text_width(const std::string& text);

/// Text that fits into `width` px: cut in the middle, with an ellipsis, if it must be. Valid UTF-8 in, valid UTF-8 out.
std::string shortened(const std::string& text, double width);

/// Text in lines of at most `width` px, broken at spaces, or inside a word that is longer than a line. At least one
/// line.
std::vector<std::string> wrapped(const std::string& text, double width);

/// A label as the legend shows it: clean, and shortened to 840 px.
std::string legend_label(const std::string& label);

/// A name of a value on the y axis as it is drawn: clean, and shortened to 200 px.
std::string axis_name(const std::string& name);

/// A legend's label in lines of at most `width` px. At least one line.
std::vector<std::string> legend_lines(const std::string& label, double width);

/// Whether any series is a line with symbols, whose legend samples are longer to show both.
bool has_marked_lines(const Panel& panel);

/// A tick of a logarithmic axis.
struct Tick {
  double value = 0.0;
  std::string label;  ///< empty: no label
};

/// Ticks of a logarithmic axis from `low` to `high` (0 < low < high). The axis is `pixels` long, and each label needs
/// at most `room` px along it (0: its own width). Empty if gnuplot's own ticks, at every decade, fit.
std::vector<Tick> log_ticks(double low, double high, double pixels, double room);

/// Edges of the cells around rising values: half-way between neighbours (in the logarithm if `log`; then all > 0), and
/// as far beyond the first and the last. There is one edge more than values, and at least one value.
std::vector<double> cell_edges(const std::vector<double>& values, bool log);

/// Places of a panel's parts, px from the page's top left corner.
struct PanelLayout {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  ///< panel with legend and labels
  double plot_left = 0.0, plot_top = 0.0, plot_width = 0.0, plot_height = 0.0;
  double key_spacing = 1.0;  ///< of legend lines, in units of 18 px
  double legend_line = 0.0;  ///< px to which the legend's labels are wrapped
  LegendKind legend = LegendKind::none;
  std::vector<EndPlace> ends;
  std::vector<std::string> title;
};
struct PageLayout {
  double width = 0.0, height = 0.0;
  std::vector<std::string> title;
  std::vector<LegendPlace> legend;  ///< for all panels
  std::vector<PanelLayout> panels;
};

/// `Panel::taller` of a panel of the usual size whose plot is `aspect` times as high as wide.
double taller_for(double aspect);

/// Room for everything. Long labels of legends are wrapped where the panel's height has room for the lines. Columns and
/// rows grow beyond the figure's panel size where legends still need it. So a legend of any size stands in one column
/// beside its panel's data and ends before the next panel. Panels of a column that share the quantity of x have plots
/// of one width below each other. @throws std::invalid_argument without panel or column
PageLayout layout(const Figure& figure);

}  // namespace accdec
