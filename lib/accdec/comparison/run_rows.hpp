#pragma once

#include <span>
#include <string>
#include <vector>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/competitor.hpp>
#include <accdec/problem.hpp>
#include <accdec/solver.hpp>

namespace accdec::comparison {

/// Keeps the improvements that matter: the first, the last, and those that leave at most 0.9 of the previous distance
/// to the last one. So the time at which a target is met is at most that of a target a tenth nearer to the last
/// improvement.
batch::Row thinned(const std::vector<nlp::Improvement>& history);
/// Numbers of evaluations by kind.
batch::Row counts_row(const nlp::Counts& counts);
/// Lets a solver answer, and records its claim. For a program it also records whether it was killed or crashed
/// (`ended`), and the claim of an answer after the time limit (`late_claim`). These three in comparison_solve.cpp.
solvers::Result answer_into(batch::Row& row, const Competitor& competitor, const nlp::Problem& problem,
                            std::span<const double> start, const solvers::Options& options);
/// Records that a solver does not take a problem. Empty: it does, and the answer is false. In comparison_design.cpp.
bool refused_into(batch::Row& row, const std::string& reason);

}  // namespace accdec::comparison
