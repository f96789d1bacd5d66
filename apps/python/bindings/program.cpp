#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/plot/plot_program.hpp>
#include <accdec/program/simulate/simulate.hpp>
#include <accdec/program/write/program_file.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

using Pointer = std::shared_ptr<ProgramResult>;

Pointer plan(const std::string& file, const std::shared_ptr<Task>& task, const ProgramFileOptions& options,
             const py::object& progress) {
  const auto result = std::make_shared<Pointer>();
  // Planning has no flag for being cancelled but says, now and then, what it does.
  run_interruptibly(
      [=](const Work& work) {
        const auto tell = [&](const std::string& line) {
          if (work.cancelled) throw std::runtime_error("cancelled");
          work.tell(line);
        };
        *result = std::make_shared<ProgramResult>(run_program_file(file, *task, options, tell));
      },
      progress);
  return *result;
}

/// A view of the result's own numbers.
template <class Number>
py::array view(const std::vector<Number>& values, const py::object& owner) {
  return read_only(py::array_t<Number>(static_cast<py::ssize_t>(values.size()), values.data(), owner));
}

template <class Number>
auto view_of(std::vector<Number> ProgramPlan::*member) {
  return [member](const py::object& self) { return view(self.cast<const ProgramResult&>().plan.*member, self); };
}
template <class Number>
auto view_of(std::vector<Number> Toolpath::*member) {
  return [member](const py::object& self) { return view(self.cast<const ProgramResult&>().path.*member, self); };
}

py::object taps(const py::object& self) {
  const auto& result = self.cast<const ProgramResult&>();
  if (result.path.blocks() == 0) return py::none();
  const auto taps = result.filter.taps();
  return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
}

/// Every sample of the motion, samples by axes; the first is at rest where the program begins.
py::dict samples(const ProgramResult& r) {
  const auto rows = static_cast<py::ssize_t>(r.plan.simulation.samples + 1),
             n = static_cast<py::ssize_t>(r.path.axes.size());
  if (r.path.blocks() == 0) throw std::runtime_error("there is no plan: " + r.message);
  py::array_t<double> time(rows), position({rows, n}), velocity({rows, n});
  double *t = time.mutable_data(), *x = position.mutable_data(), *v = velocity.mutable_data();
  std::fill(v, v + n, 0.0);
  std::copy(r.path.point(0), r.path.point(0) + n, x);
  for (py::ssize_t k = 0; k < rows; ++k) t[k] = static_cast<double>(k) * r.sample_period;
  {
    const py::gil_scoped_release release;
    const CommandTiming timing(r.path, r.sample_period, r.plan.delays);
    std::vector<double> errors(r.path.blocks());
    SimulationOptions options;
    options.samples = [&](std::int64_t first, std::int64_t count, const double* const* at, const double* const* step) {
      count = std::min<std::int64_t>(count, rows - first);
      for (std::int64_t k = 0; k < count; ++k) {
        for (py::ssize_t a = 0; a < n; ++a) {
          x[(first + k) * n + a] = at[a][k];
          v[(first + k) * n + a] = step[a][k] / r.sample_period;
        }
      }
    };
    simulate_program(timing, r.legs, 0, r.path.blocks() - 1, errors, options);
  }
  py::list axes;
  for (std::size_t a = 0; a < r.path.axes.size(); ++a) axes.append(r.path.axis_name(a));
  return py::dict(py::arg("time") = time, py::arg("position") = position, py::arg("velocity") = velocity,
                  py::arg("axes") = axes);
}

std::string emitted(const ProgramResult& r) {
  std::ostringstream out;
  emit_program(r, out);
  return out.str();
}

constexpr const char* program_doc = R"(The plan of a whole program, every sample simulated. Made by `program`.

Attributes
----------
success : bool
    Every corner holds its tolerance and every limit is held over the whole program.
message : str
fun, cycle_time : float
    s.
lower_bound : float
    s; no continuous motion at the programmed feeds is shorter.
x, taps : ndarray or None
    The filter, b_0 .. b_N.
delays : ndarray of int
    Samples, one a commanded block: the delay at its end.
errors, tolerances : ndarray
    m, at the end of every commanded block; the tolerance is inf where there is none.
lines : ndarray of int
    Line of the program of every commanded block.
durations : ndarray
    s, way over feed of every commanded block.
)";

}  // namespace

void bind_program(py::module_& module) {
  py::class_<ProgramResult, Pointer>(module, "Program", program_doc)
      .def_property_readonly("success", [](const ProgramResult& r) { return r.verification.feasible; })
      .def_property_readonly("message", [](const ProgramResult& r) { return r.message; })
      .def_property_readonly("fun", [](const ProgramResult& r) { return r.cycle_time; })
      .def_property_readonly("cycle_time", [](const ProgramResult& r) { return r.cycle_time; })
      .def_property_readonly("lower_bound", [](const ProgramResult& r) { return r.lower_bound; })
      .def_property_readonly("x", &taps)
      .def_property_readonly("taps", &taps)
      .def_property_readonly("delays", view_of(&ProgramPlan::delays))
      .def_property_readonly("errors", view_of(&ProgramPlan::errors))
      .def_property_readonly("tolerances", view_of(&Toolpath::tolerance))
      .def_property_readonly("lines", view_of(&Toolpath::line))
      .def_property_readonly("durations", view_of(&Toolpath::duration))
      .def("to_json", &program_to_json)
      .def("emit", &emitted)
      .def("samples", &samples)
      .def("__str__", &program_summary);
  module.def(
      "program",
      [](const std::string& file, const std::shared_ptr<Task>& task, bool per_leg, bool keep_feeds,
         double arc_tolerance, std::optional<double> time_limit, bool rapid_stops, bool dwells_before_filter,
         bool filter_bound, const std::string& tool_table, const py::object& progress) {
        ProgramFileOptions options;
        options.arc_tolerance = arc_tolerance;
        options.tool_table = tool_table;
        options.rapid_stops = rapid_stops;
        options.dwells_before_filter = dwells_before_filter;
        options.feeds = keep_feeds ? Feeds::keep : Feeds::choose;
        options.per_leg = per_leg;
        options.filter_bound = filter_bound;
        options.time_limit = time_limit;
        return plan(file, task, options, progress);
      },
      py::arg("file"), py::arg("task"), py::kw_only(), py::arg("per_leg"), py::arg("keep_feeds"),
      py::arg("arc_tolerance"), py::arg("time_limit"), py::arg("rapid_stops"), py::arg("dwells_before_filter"),
      py::arg("filter_bound"), py::arg("tool_table"), py::arg("progress"));
  module.def(
      "program_figure", [](const ProgramResult& result) { return figure_dict(plot_program(result)); },
      py::arg("result"));
}

}  // namespace accdec::python
