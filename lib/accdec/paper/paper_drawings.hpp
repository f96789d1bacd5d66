#pragma once

#include <string>
#include <vector>

#include <accdec/paper/paper_figures.hpp>
#include <accdec/plot/figure.hpp>

namespace accdec::paper {

/// One figure of the paper as files: the numbers by name, and how they are drawn.
struct Drawing {
  std::string name;              ///< "fig05"
  std::vector<FigureData> data;  ///< the first is NAME.csv, a second NAME-errors.csv
  Figure figure;
};

/// Curves of one column of numbers over another.
struct Curve {
  std::string column, label;
};
/// A panel of `curves` over `x_column`, in styles 0, 1, ..; the x-axis ends where the numbers do.
Panel panel_of(const FigureData& data, const std::string& title, const std::string& x_column,
               const std::string& x_label, const std::string& y_label, const std::vector<Curve>& curves);
Drawing make_drawing(const std::string& name, FigureData data, const std::string& title, std::vector<Panel> panels,
                     int columns);

/// Fig. 1 to 4.
std::vector<Drawing> opening_drawings();
/// All figures, 1 to 12, in order.
std::vector<Drawing> drawings();

/// Comma-separated, a header line, six decimals, no negative zeros: enough for any drawing, and the same bytes on every
/// machine.
std::string to_csv(const FigureData& data);

}  // namespace accdec::paper
