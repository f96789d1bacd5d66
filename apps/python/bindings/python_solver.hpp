#pragma once

#include <memory>
#include <span>
#include <string>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/problem.hpp>
#include <accdec/solver.hpp>

#include "bindings.hpp"

namespace accdec::python {

/// A problem used by Python code. It is a problem of a case, which the handle keeps alive. Or it is the problem of a
/// solver during a run; then the evaluator counts every call and enforces the limits.
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
