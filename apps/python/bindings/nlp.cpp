#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <accdec/nlp/derivative_check.hpp>
#include <accdec/solver.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"
#include "python_solver.hpp"

namespace accdec::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Handle = std::shared_ptr<ProblemHandle>;

std::span<const double> point_of(const Numbers& x, int size, const char* what) {
  if (x.ndim() != 1 || x.size() != size)
    throw std::invalid_argument(fmt::format("{}: {} numbers are needed, not {}", what, size, x.size()));
  return {x.data(), static_cast<std::size_t>(x.size())};
}

/// An array of `size` that `fill` writes, of a function of x; through the evaluator within a run.
template <class Fill>
py::array_t<double> values(std::size_t size, Fill fill) {
  py::array_t<double> out(static_cast<py::ssize_t>(size));
  fill(std::span<double>(out.mutable_data(), size));
  return out;
}

double objective(const ProblemHandle& h, const Numbers& x) {
  const auto point = point_of(x, h.get().num_variables(), "x");
  return h.evaluator ? h.evaluator->objective(point) : h.get().objective(point);
}

py::array_t<double> gradient(const ProblemHandle& h, const Numbers& x) {
  const auto point = point_of(x, h.get().num_variables(), "x");
  return values(point.size(),
                [&](auto g) { h.evaluator ? h.evaluator->gradient(point, g) : h.get().gradient(point, g); });
}

py::array_t<double> rows(const ProblemHandle& h, const Numbers& x) {
  const auto point = point_of(x, h.get().num_variables(), "x");
  return values(static_cast<std::size_t>(h.get().num_rows()),
                [&](auto c) { h.evaluator ? h.evaluator->rows(point, c) : h.get().rows(point, c); });
}

py::array_t<double> jacobian(const ProblemHandle& h, const Numbers& x) {
  const auto point = point_of(x, h.get().num_variables(), "x");
  return values(h.get().jacobian_pattern().size(),
                [&](auto v) { h.evaluator ? h.evaluator->jacobian(point, v) : h.get().jacobian(point, v); });
}

py::array_t<double> hessian(const ProblemHandle& h, const Numbers& x, double factor, const Numbers& multipliers) {
  if (!h.get().has_hessian()) throw std::runtime_error("this form of the problem has no second derivatives");
  const auto point = point_of(x, h.get().num_variables(), "x");
  const auto y = point_of(multipliers, h.get().num_rows(), "multipliers");
  return values(h.get().hessian_pattern().size(), [&](auto v) {
    h.evaluator ? h.evaluator->hessian(point, factor, y, v) : h.get().hessian(point, factor, y, v);
  });
}

/// Rows and columns of the structural nonzeros.
py::tuple pattern(const std::vector<nlp::Entry>& entries) {
  py::array_t<int> row(static_cast<py::ssize_t>(entries.size())), column(static_cast<py::ssize_t>(entries.size()));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    row.mutable_data()[i] = entries[i].row;
    column.mutable_data()[i] = entries[i].column;
  }
  return py::make_tuple(row, column);
}

/// Lower and upper bounds of variables or rows.
template <class Bound>
py::tuple bounds(int count, Bound bound) {
  py::array_t<double> low(count), high(count);
  for (int i = 0; i < count; ++i) {
    const nlp::Bound b = bound(i);
    low.mutable_data()[i] = b.lower;
    high.mutable_data()[i] = b.upper;
  }
  return py::make_tuple(low, high);
}

template <class Name>
std::vector<std::string> names(int count, Name name) {
  std::vector<std::string> list;
  for (int i = 0; i < count; ++i) list.push_back(name(i));
  return list;
}

Handle make_problem(const Task& task, const std::string& question, int order, const std::vector<int>& delays,
                    bool reduced) {
  const auto asked = comparison::question_from_string(question);
  if (!asked || *asked == comparison::Question::design)
    throw std::invalid_argument(fmt::format("question: allowed are \"margin\" and \"delay\", got \"{}\"", question));
  if (order < 1 || order > 100'000)
    throw std::invalid_argument(fmt::format("order: allowed is 1 to 100000, got {}", order));
  if (task.corners.empty()) throw std::invalid_argument("the task has no corner");
  if (!delays.empty() && delays.size() != task.corners.size())
    throw std::invalid_argument(fmt::format("delays: {} for {} corners", delays.size(), task.corners.size()));
  for (const int delay : delays) {
    if (delay < 0) throw std::invalid_argument(fmt::format("delays: allowed is >= 0, got {}", delay));
  }
  comparison::CaseSpec spec;
  spec.name = question;
  spec.task = task;
  spec.question = *asked;
  spec.order = order;
  spec.delays = delays;
  const auto handle = std::make_shared<ProblemHandle>();
  handle->subject = std::make_shared<comparison::ComparisonCase>(std::move(spec));
  handle->problem = handle->subject->problem(reduced);
  handle->reduced = reduced;
  return handle;
}

py::dict answer_of(const solvers::Result& r) {
  const solvers::Verification& v = r.verification;
  py::list history;
  for (const nlp::Improvement& step : r.history)
    history.append(py::make_tuple(step.evaluations, step.time, step.objective));
  return py::dict(
      py::arg("x") = py::array_t<double>(static_cast<py::ssize_t>(r.x.size()), r.x.data()),
      py::arg("claim") = to_string(r.claim), py::arg("verdict") = to_string(v.verdict), py::arg("fun") = v.objective,
      py::arg("maxcv") = std::max(v.row_violation, v.bound_violation), py::arg("worst") = v.worst,
      py::arg("stationarity") = v.stationarity, py::arg("complementarity") = v.complementarity,
      py::arg("multipliers") =
          py::array_t<double>(static_cast<py::ssize_t>(r.row_multipliers.size()), r.row_multipliers.data()),
      py::arg("nfev") = r.counts.objective, py::arg("njev") = r.counts.gradient, py::arg("ncev") = r.counts.rows,
      py::arg("ncjev") = r.counts.jacobian, py::arg("nhev") = r.counts.hessian, py::arg("wall_time") = r.wall_time,
      py::arg("evaluation_time") = r.counts.evaluation_time, py::arg("history") = history,
      py::arg("message") = r.message);
}

/// @param solver  a name of the registry, or a function as PythonSolver takes
py::dict solve(const Handle& handle, const py::object& solver, const std::vector<double>& start, double tolerance,
               double time_limit, std::int64_t evaluation_limit, std::uint64_t seed,
               const std::map<std::string, std::string>& native) {
  std::shared_ptr<PythonSolver> own;
  if (!py::isinstance<py::str>(solver)) own = std::make_shared<PythonSolver>("function", solver, true);
  const solvers::Solver* const chosen = own ? own.get() : &solvers::find_solver(solver.cast<std::string>());
  solvers::Options options;
  options.tolerance = tolerance;
  options.time_limit = time_limit;
  options.evaluation_limit = evaluation_limit;
  options.seed = seed;
  options.native = native;
  const auto result = std::make_shared<solvers::Result>();
  run_interruptibly(
      [=](const Work& work) {
        solvers::Options with_cancel = options;
        with_cancel.cancel = &work.cancelled;
        *result = (own ? *own : *chosen).solve(handle->get(), start, with_cancel);
      },
      py::none());
  return answer_of(*result);
}

py::list solver_list() {
  py::list list;
  for (const auto& solver : solvers::registry()) {
    const solvers::Capabilities can = solver->capabilities();
    list.append(py::dict(py::arg("name") = solver->name(), py::arg("version") = solver->library_version(),
                         py::arg("linear_only") = can.linear_only, py::arg("inequality_rows") = can.inequality_rows,
                         py::arg("equality_rows") = can.equality_rows,
                         py::arg("needs_finite_bounds") = can.needs_finite_bounds,
                         py::arg("needs_residuals") = can.needs_residuals, py::arg("uses_gradient") = can.uses_gradient,
                         py::arg("uses_jacobian") = can.uses_jacobian, py::arg("uses_hessian") = can.uses_hessian,
                         py::arg("is_global") = can.global, py::arg("seeded") = can.seeded,
                         py::arg("integers") = can.integers, py::arg("settings") = solver->settings()));
  }
  return list;
}

std::vector<std::string> derivative_errors(const Handle& h, const Numbers& x, double tolerance) {
  const auto point = point_of(x, h->get().num_variables(), "x");
  const auto found = std::make_shared<std::vector<std::string>>();
  const auto work = [=, own = std::vector<double>(point.begin(), point.end())](const Work&) {
    for (const auto& wrong : nlp::check_derivatives(h->get(), own, tolerance)) found->push_back(wrong.text);
  };
  // Within a run the problem lasts only as long as the run.
  h->subject ? run_interruptibly(work, py::none()) : work({std::atomic<bool>(false), {}});
  return *found;
}

void bind_problem(py::module_& module) {
  py::class_<ProblemHandle, Handle>(module, "ProblemHandle")
      .def_property_readonly("name", [](const ProblemHandle& h) { return h.get().name(); })
      .def_property_readonly("n", [](const ProblemHandle& h) { return h.get().num_variables(); })
      .def_property_readonly("m", [](const ProblemHandle& h) { return h.get().num_rows(); })
      .def_property_readonly(
          "linear", [](const ProblemHandle& h) { return h.get().problem_class() == nlp::ProblemClass::linear; })
      .def_property_readonly("has_hessian", [](const ProblemHandle& h) { return h.get().has_hessian(); })
      .def("variable_bounds",
           [](const ProblemHandle& h) {
             return bounds(h.get().num_variables(), [&](int i) { return h.get().variable_bound(i); });
           })
      .def("row_bounds",
           [](const ProblemHandle& h) {
             return bounds(h.get().num_rows(), [&](int i) { return h.get().row_bound(i); });
           })
      .def("variable_names",
           [](const ProblemHandle& h) {
             return names(h.get().num_variables(), [&](int i) { return h.get().variable_name(i); });
           })
      .def("row_names",
           [](const ProblemHandle& h) { return names(h.get().num_rows(), [&](int i) { return h.get().row_name(i); }); })
      .def_property_readonly(
          "samples", [](const ProblemHandle& h) { return h.subject ? h.subject->samples() : std::vector<int>(); })
      .def("objective", &objective, py::arg("x"))
      .def("gradient", &gradient, py::arg("x"))
      .def("rows", &rows, py::arg("x"))
      .def("jacobian", &jacobian, py::arg("x"))
      .def("jacobian_pattern", [](const ProblemHandle& h) { return pattern(h.get().jacobian_pattern()); })
      .def("hessian", &hessian, py::arg("x"), py::arg("factor"), py::arg("multipliers"))
      .def("hessian_pattern", [](const ProblemHandle& h) { return pattern(h.get().hessian_pattern()); })
      .def(
          "start",
          [](const ProblemHandle& h, int index, std::uint64_t seed) {
            if (!h.subject) throw std::runtime_error("within a run the start is handed over");
            const std::vector<double> x = h.subject->start(h.reduced, index, seed);
            return py::array_t<double>(static_cast<py::ssize_t>(x.size()), x.data());
          },
          py::arg("index"), py::arg("seed"))
      .def(
          "taps",
          [](const ProblemHandle& h, const Numbers& x) {
            if (!h.subject) throw std::runtime_error("within a run points are only numbers");
            const Filter filter = filter_from(point_of(x, h.get().num_variables(), "x"), h.subject->spec().order);
            return py::array_t<double>(static_cast<py::ssize_t>(filter.taps().size()), filter.taps().data());
          },
          py::arg("x"))
      .def("check_derivatives", &derivative_errors, py::arg("x"), py::arg("tolerance"));
}

}  // namespace

void bind_nlp(py::module_& module) {
  bind_problem(module);
  module.def("make_problem", &make_problem, py::arg("task"), py::arg("question"), py::arg("order"), py::arg("delays"),
             py::arg("reduced"));
  module.def("solve", &solve, py::arg("problem"), py::arg("solver"), py::arg("start"), py::arg("tolerance"),
             py::arg("time_limit"), py::arg("evaluation_limit"), py::arg("seed"), py::arg("native"));
  module.def("solvers", &solver_list);
  module.def(
      "register_solver",
      [](const std::string& name, const py::object& function, bool equality_rows) {
        solvers::register_solver(std::make_unique<PythonSolver>(name, function, equality_rows));
      },
      py::arg("name"), py::arg("function"), py::arg("equality_rows"));
}

}  // namespace accdec::python
