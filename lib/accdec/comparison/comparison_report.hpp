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

/// Every problem at every size with its reference value and what proves it.
ComparisonTable problems_table(const comparison::ComparisonData& data);
/// One row a solver: how often it reached the reference, what else came of its runs, median and quartiles of time and
/// evaluations.
ComparisonTable summary_table(const comparison::ComparisonData& data);
/// The columns of it that matter most, as plain text for a terminal.
std::string summary_text(const comparison::ComparisonData& data);
/// Claimed against verified, for each solver and for all together.
ComparisonTable confusion_table(const comparison::ComparisonData& data);
/// One row for each problem, start and solver.
ComparisonTable runs_table(const comparison::ComparisonData& data);
/// Every pair of solvers compared with each other alone, by the time to accuracy: profile values at ratios 1, 2 and 10.
ComparisonTable pairs_table(const comparison::ComparisonData& data);

/// Name and figure: joint performance profiles by the time to the accuracy that is judged and, beside them, by the time
/// until the solver ends ("performance-end"); pairwise profiles against the solver that solves most, by the time to
/// accuracy; data profiles, and runtime distributions to the targets. For the nonlinear problems and, where there are
/// any, for the designs ("design-...").
std::vector<std::pair<std::string, Figure>> comparison_figures(const comparison::ComparisonData& data);

/// Everything that is made from raw data: tables as CSV, figures as SVG and PNG, report.html. A function of the lines
/// alone.
/// @return file name and content
std::vector<std::pair<std::string, std::string>> comparison_documents(const std::vector<std::string>& lines);

}  // namespace accdec
