#pragma once

#include <string>

#include <accdec/comparison/comparison_report.hpp>

// Internal to the room: what a comparison's page begins with.

namespace accdec {

/// One row a solver, the most reliable first: the share of feasible problems on which it reached the reference (a
/// refusal counts as a failure), its median time to accuracy over the least of the plain solvers where it got there,
/// and how often it claimed a solution that was none.
ComparisonTable answer_table(const comparison::ComparisonData& data);

/// Three sentences: who reaches the reference most often, who is fastest among the reliable, whose claims are wrong.
std::string answer_text(const comparison::ComparisonData& data);

}  // namespace accdec
