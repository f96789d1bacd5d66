#include "python_solver.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/solvers/run.hpp>

namespace accdec::python {

const nlp::Problem& ProblemHandle::get() const {
  if (problem == nullptr) throw std::runtime_error("this problem belongs to a run that is over");
  return *problem;
}

PythonSolver::PythonSolver(std::string name, const py::object& function, bool equality_rows)
    : name_(std::move(name)), function_(function.ptr()), equality_rows_(equality_rows) {
  function_.inc_ref();
}

solvers::Capabilities PythonSolver::capabilities() const {
  solvers::Capabilities can;
  can.equality_rows = equality_rows_;
  can.uses_hessian = true;
  return can;
}

solvers::Result PythonSolver::do_solve(const nlp::Problem& problem, std::span<const double> start,
                                       const solvers::Options& options) const {
  nlp::Evaluator evaluator(problem, solvers::limits_of(options));
  solvers::Result result;
  result.x.assign(start.begin(), start.end());
  {
    const py::gil_scoped_acquire gil;
    const auto handle = std::make_shared<ProblemHandle>();
    handle->problem = &problem;
    handle->evaluator = &evaluator;
    const py::dict settings(py::arg("tolerance") = options.tolerance, py::arg("time_limit") = options.time_limit,
                            py::arg("seed") = options.seed);
    for (const auto& [key, value] : options.native) settings[py::str(key)] = value;
    try {
      const py::tuple answer =
          function_(handle, py::array_t<double>(static_cast<py::ssize_t>(start.size()), start.data()), settings);
      const auto x = answer[0].cast<py::array_t<double, py::array::c_style | py::array::forcecast>>();
      if (x.ndim() != 1 || x.size() != static_cast<py::ssize_t>(start.size())) {
        throw std::invalid_argument(
            fmt::format("solver \"{}\" gave {} numbers for {} variables", name_, x.size(), start.size()));
      }
      result.x.assign(x.data(), x.data() + x.size());
      result.claim = answer[1].cast<bool>() ? solvers::Claim::solved : solvers::Claim::failed;
      result.message = answer[2].cast<std::string>();
    } catch (const py::error_already_set&) {
      handle->problem = nullptr;
      // The evaluator's own StopRun, on its way through Python, or what the problem's functions threw.
      if (evaluator.stop() == nlp::Stop::none) throw;
    }
    handle->problem = nullptr;
    handle->evaluator = nullptr;
  }
  solvers::conclude(evaluator, result);
  return result;
}

}  // namespace accdec::python
