#pragma once

#include <string>
#include <utility>
#include <vector>

#include <accdec/comparison/comparison_data.hpp>
#include <accdec/plot/figure.hpp>

namespace accdec {

struct ComparisonTable {
  std::string name;  ///< of its CSV file
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// Every problem at every size with its reference value and the kind of its proof.
ComparisonTable problems_table(const comparison::ComparisonData& data);
/// One row per solver: how often it reached the reference, the other outcomes of its runs, median and quartiles of time
/// and evaluations. In comparison_tables.cpp.
ComparisonTable summary_table(const comparison::ComparisonData& data);
/// Its most important columns as plain text for a terminal. In comparison_summary.cpp.
std::string summary_text(const comparison::ComparisonData& data);
/// Claims compared with verification, for each solver and for all together.
ComparisonTable confusion_table(const comparison::ComparisonData& data);
/// One row for each problem, start and solver.
ComparisonTable runs_table(const comparison::ComparisonData& data);
/// Every pair of solvers compared with each other alone, by the time to accuracy: profile values at ratios 1, 2 and 10.
ComparisonTable pairs_table(const comparison::ComparisonData& data);

/// One row for each solver: how often it reached the proved optimum, in all and by difficulty, how fast, and its wrong
/// claims.
ComparisonTable leaderboard_table(const comparison::ComparisonData& data);
/// The same as a page: sorted by a click, with how to join and what is fair in it. Both in leaderboard.cpp.
std::string leaderboard_html(const comparison::ComparisonData& data);
/// The solvers compared, with their settings beyond those that are the same for all.
std::string solvers_html(const comparison::ComparisonData& data);

/// Name and figure. There are joint performance profiles by the time to the judged accuracy, and by the time until the
/// solver ends ("performance-end"). There are pairwise profiles against the solver that solves most, by the time to
/// accuracy. There are also data profiles, and runtime distributions to the targets. All of them are made for the
/// nonlinear problems and, if there are any, for the designs ("design-..."). In comparison_figures.cpp.
std::vector<std::pair<std::string, Figure>> comparison_figures(const comparison::ComparisonData& data);

/// Everything made from raw data: tables as CSV, figures as SVG and PNG, report.html. It depends only on the lines.
/// @return file name and content
std::vector<std::pair<std::string, std::string>> comparison_documents(const std::vector<std::string>& lines);

}  // namespace accdec
