#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <accdec/solver.hpp>

namespace accdec::comparison {

/// The content of a solution file.
struct ExternalAnswer {
  solvers::Claim claim = solvers::Claim::failed;
  std::vector<double> x;  ///< in the order of the file; empty if there is none
  std::string message;
};

/// AMPL's text solution file: message, options, duals, values, `objno 0 CODE`. @param columns  of the instance
/// @throws std::invalid_argument if it is malformed or has another number of values
ExternalAnswer read_sol(const std::string& text, std::size_t columns);

/// A claim in words (solved, acceptable, infeasible, unbounded, failed, time limit), then a number for each variable.
/// Without a point there are no numbers. @throws as read_sol
ExternalAnswer read_values(const std::string& text, std::size_t columns);

/// Lines with a name X1, X2, .. and, after it, a number; variables not named are 0. The claim is that of the last line
/// before them that says infeasible, unbounded, a limit of time, or optimal; without one it is acceptable if there are
/// values. Words that leave open whether there is an answer are a failure, and the state of a point is no claim.
/// Solution files of cbc, HiGHS, SCIP, glpsol, Gurobi, and the output of lp_solve and SYMPHONY, are such texts.
/// @throws std::invalid_argument for a name beyond the columns, or a text without names and words
ExternalAnswer read_names(const std::string& text, std::size_t columns);

/// One of these, by its name in suites.
ExternalAnswer read_answer(const std::string& kind, const std::string& text, std::size_t columns);

}  // namespace accdec::comparison
