#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <accdec/plot/figure.hpp>

// Internal to this folder: where labels stand.

namespace accdec {

/// Place of a panel's labels: in its title, each at the end of its line, or in a column beside the plot. None
/// stand there if the page has one legend.
enum class LegendKind { none, title, ends, column };
LegendKind legend_kind(const Figure& figure, const Panel& panel);

/// A panel's title, with the label of its only curve if that is where it stands.
std::string panel_title(const Figure& figure, const Panel& panel);

/// Labels of a panel in the order they are drawn, as long as a legend shows them.
std::vector<std::string> legend_labels(const Panel& panel);

/// A label at the end of its line; px from the page's top.
struct EndPlace {
  std::size_t series = 0;
  double from = 0.0;               ///< where the line ends
  double to = 0.0;                 ///< the middle of the label
  std::vector<std::string> lines;  ///< `closest_end_lines` apart
};
inline constexpr double closest_end_lines = 14.0;                  ///< px
inline constexpr double leader = 22.0, longest_end_label = 220.0;  ///< px, from a line's end to its label

/// Labels as near to their lines' ends as they can stand without covering each other.
/// @param top, height  of the plot, px
std::vector<EndPlace> end_places(const Panel& panel, double top, double height);

/// A label of the page's one legend; px from the page's top left corner.
struct LegendPlace {
  std::string label;
  double x = 0.0, y = 0.0;  ///< where its sample begins, in the middle of the line
};
inline constexpr double legend_row = 18.0, legend_sample = 34.0;  ///< px

/// Names of the limits of a panel on their lines. x is the right end of a name, y its middle. A name whose line is near
/// the one below stands to the left of that one's.
/// @param right, top, height  of the plot, px
std::vector<LegendPlace> limit_name_places(const Panel& panel, double right, double top, double height);

/// Every label of a figure once, in rows that fill the columns of panels in turn. The first row is at y = 0.
std::vector<LegendPlace> page_legend(const Figure& figure, double width);

}  // namespace accdec
