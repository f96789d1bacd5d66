#pragma once

#include <string>
#include <vector>

#include <accdec/solver.hpp>

namespace accdec::comparison {

/// A solver that is a program of the user: [[external]] of a suite.
struct External {
  std::string name;
  std::string command;  ///< words; {nl} or {cbf}, {answer}, {seconds} and {suite} are replaced
  std::string reads;    ///< nl or cbf
  std::string answer;   ///< sol: AMPL's solution file; values: a word, then one number for each variable
  std::string folder;   ///< of the suite, for {suite}
};

/// Runs it for every problem in a folder of its own, with the limits of `run_limited`. The time limit is that of the
/// options. Its answer is judged like every other. It gets problems in sparse form only.
class ExternalSolver final : public solvers::Solver {
 public:
  explicit ExternalSolver(External external) : external_(std::move(external)) {}
  std::string name() const override { return external_.name; }
  std::string library_version() const override { return "command: " + external_.command; }
  solvers::Capabilities capabilities() const override;
  const External& external() const { return external_; }

 protected:
  solvers::Result do_solve(const nlp::Problem& problem, std::span<const double> start,
                           const solvers::Options& options) const override;

 private:
  External external_;
};

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

}  // namespace accdec::comparison
