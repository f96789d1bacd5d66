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

/// Fig. 5 to 12, in order.
std::vector<Drawing> drawings();

/// Comma-separated, a header line, six decimals, no negative zeros: enough for any drawing, and the same bytes on every
/// machine.
std::string to_csv(const FigureData& data);

}  // namespace accdec::paper
