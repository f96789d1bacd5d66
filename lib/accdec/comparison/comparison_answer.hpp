#pragma once

#include <string>

#include <accdec/comparison/comparison_report.hpp>

// Internal to this folder: the beginning of a comparison's page.

namespace accdec {

/// One row per solver, the most reliable first. It has the share of feasible problems on which the solver reached the
/// reference (a refusal counts as a failure). It has the median of its time to accuracy over the least time of the
/// plain solvers, where it got there. It also counts how often it wrongly claimed a solution.
ComparisonTable answer_table(const comparison::ComparisonData& data);

/// Three sentences: who reaches the reference most often, who is fastest among the reliable, whose claims are wrong.
std::string answer_text(const comparison::ComparisonData& data);

}  // namespace accdec
