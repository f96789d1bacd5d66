#pragma once

#include <memory>
#include <span>
#include <string>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/nlp/evaluator.hpp>
#include <accdec/nlp/problem.hpp>
#include <accdec/solvers/solver.hpp>

#include "bindings.hpp"

namespace accdec::python {

/// A problem in the hands of Python code: a case's, which the handle keeps, or for the time of a run a solver's, whose
/// evaluator counts every call and ends the run in time.
struct ProblemHandle {
  std::shared_ptr<const comparison::ComparisonCase> subject;  ///< null within a run
  const nlp::Problem* problem = nullptr;                      ///< null when the run is over
  nlp::Evaluator* evaluator = nullptr;                        ///< within a run
  bool reduced = false;

  /// @throws std::runtime_error when the run is over
  const nlp::Problem& get() const;
};

/// A solver written in Python, in the place of one of the library's: guarded, counted and verified like these.
class PythonSolver final : public solvers::Solver {
 public:
  /// @param function  of a ProblemHandle, the start and the options; gives (x, success, message)
  PythonSolver(std::string name, const py::object& function, bool equality_rows);

  std::string name() const override { return name_; }
  std::string library_version() const override { return "Python"; }
  solvers::Capabilities capabilities() const override;

 protected:
  /// To be called without the GIL, as solvers are.
  solvers::Result do_solve(const nlp::Problem& problem, std::span<const double> start,
                           const solvers::Options& options) const override;

 private:
  std::string name_;
  py::handle function_;  // never released: registered solvers outlive the interpreter
  bool equality_rows_;
};

}  // namespace accdec::python
