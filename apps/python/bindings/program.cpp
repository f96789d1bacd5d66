#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/plot/plot_program.hpp>
#include <accdec/program/write/fastest_plan.hpp>
#include <accdec/program/write/program_file.hpp>
#include <accdec/program/write/samples.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

using Pointer = std::shared_ptr<ProgramResult>;
using ProfilePointer = std::shared_ptr<ProfileResult>;

/// Planning has no flag for being cancelled but says, now and then, what it does.
std::function<void(const std::string&)> teller(const Work& work) {
  return [&work](const std::string& line) {
    if (work.cancelled) throw std::runtime_error("cancelled");
    work.tell(line);
  };
}

Pointer plan(const std::string& file, const std::shared_ptr<Task>& task, const ProgramFileOptions& options,
             const py::object& progress) {
  const auto result = std::make_shared<Pointer>();
  run_interruptibly(
      [=](const Work& work) {
        *result = std::make_shared<ProgramResult>(run_program_file(file, *task, options, teller(work)));
      },
      progress);
  return *result;
}

/// Whichever plan is the fastest that holds.
py::object fastest(const std::string& file, const std::shared_ptr<Task>& task, const ProgramFileOptions& options,
                   const py::object& progress) {
  const auto result = std::make_shared<std::variant<ProfilePointer, Pointer>>();
  run_interruptibly(
      [=](const Work& work) {
        auto found = run_fastest_plan_file(file, *task, options, teller(work));
        if (auto* profiles = std::get_if<ProfileResult>(&found)) {
          *result = std::make_shared<ProfileResult>(std::move(*profiles));
        } else {
          *result = std::make_shared<ProgramResult>(std::get<ProgramResult>(std::move(found)));
        }
      },
      progress);
  return std::visit([](const auto& answer) { return py::cast(answer); }, *result);
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
template <class Result, class Number>
auto view_of(std::vector<Number> Toolpath::*member) {
  return [member](const py::object& self) { return view(self.cast<const Result&>().path.*member, self); };
}

py::list candidates(const std::vector<PlanTime>& plans) {
  py::list list;
  for (const PlanTime& p : plans) {
    list.append(py::dict(py::arg("plan") = p.plan, py::arg("cycle_time") = p.time, py::arg("verified") = p.verified));
  }
  return list;
}

py::object taps(const py::object& self) {
  const auto& result = self.cast<const ProgramResult&>();
  if (result.path.blocks() == 0) return py::none();
  const auto taps = result.filter.taps();
  return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
}

/// Every sample of the motion, samples by axes; the first is at rest where the program begins.
py::dict samples(const Toolpath& path, double period, std::int64_t expected,
                 const std::function<void(const SampleVisitor&)>& visit) {
  const auto n = static_cast<std::ptrdiff_t>(path.axes.size());
  std::vector<double> time, position, velocity;
  {
    const py::gil_scoped_release release;
    for (std::vector<double>* values : {&time, &position, &velocity})
      values->reserve(static_cast<std::size_t>((expected + 2) * (values == &time ? 1 : n)));
    visit([&](std::int64_t k, const double* at, const double* speed) {
      time.push_back(static_cast<double>(k) * period);
      position.insert(position.end(), at, at + n);
      velocity.insert(velocity.end(), speed, speed + n);
    });
  }
  const auto rows = static_cast<py::ssize_t>(time.size());
  py::list axes;
  for (std::size_t a = 0; a < path.axes.size(); ++a) axes.append(path.axis_name(a));
  return py::dict(py::arg("time") = py::array_t<double>(rows, time.data()),
                  py::arg("position") = py::array_t<double>({rows, n}, position.data()),
                  py::arg("velocity") = py::array_t<double>({rows, n}, velocity.data()), py::arg("axes") = axes);
}

std::string emitted(const ProgramResult& r) {
  std::ostringstream out;
  emit_program(r, out);
  return out.str();
}

constexpr const char* profiles_doc =
    R"(A program planned with own filters and speeds at every corner, for controllers that take a position every cycle.
Made by `program` with ``plan="profiles"`` where that is the fastest plan; every sample is checked.

Attributes
----------
success : bool
    Every corner holds its tolerance and every limit is held over the whole program.
message : str
plan : str
    "profiles".
candidates : list of dict
    The plans made beside it: plan, cycle_time (s), verified.
fun, cycle_time : float
    s.
lower_bound : float
    s; no continuous motion at the programmed feeds is shorter.
x, taps : ndarray
    The last filter, which all samples pass; a single tap: none.
errors, tolerances : ndarray
    m, at the end of every block; the tolerance is inf where there is none.
lines : ndarray of int
    Line of the program of every block.
)";

constexpr const char* program_doc = R"(The plan of a whole program, every sample simulated. Made by `program`.

Attributes
----------
success : bool
    Every corner holds its tolerance and every limit is held over the whole program.
message : str
plan : str
    "fixed" or "per-leg".
candidates : list of dict
    With ``plan="profiles"`` the plans made beside it: plan, cycle_time (s), verified.
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

/// What both kinds of plan have.
template <class Result>
py::class_<Result, std::shared_ptr<Result>> bind_plan(py::module_& module, const char* name, const char* doc) {
  return py::class_<Result, std::shared_ptr<Result>>(module, name, doc)
      .def_property_readonly("message", [](const Result& r) { return r.message; })
      .def_property_readonly("candidates", [](const Result& r) { return candidates(r.candidates); })
      .def_property_readonly("fun", [](const Result& r) { return r.cycle_time; })
      .def_property_readonly("cycle_time", [](const Result& r) { return r.cycle_time; })
      .def_property_readonly("lower_bound", [](const Result& r) { return r.lower_bound; })
      .def_property_readonly("tolerances", view_of<Result>(&Toolpath::tolerance))
      .def_property_readonly("lines", view_of<Result>(&Toolpath::line));
}

void bind_profiles(py::module_& module) {
  const auto last_filter = [](const py::object& self) {
    const auto taps = self.cast<const ProfileResult&>().plan.last.taps();
    return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
  };
  bind_plan<ProfileResult>(module, "ProfileProgram", profiles_doc)
      .def_property_readonly("success", [](const ProfileResult& r) { return r.message.empty(); })
      .def_property_readonly("plan", [](const ProfileResult&) { return "profiles"; })
      .def_property_readonly("x", last_filter)
      .def_property_readonly("taps", last_filter)
      .def_property_readonly(
          "errors", [](const py::object& self) { return view(self.cast<const ProfileResult&>().plan.errors, self); })
      .def("to_json", &profiles_to_json)
      .def("samples",
           [](const ProfileResult& r) {
             if (!r.message.empty()) throw std::runtime_error("there is no plan: " + r.message);
             return samples(r.path, r.sample_period, r.plan.check.samples,
                            [&](const SampleVisitor& visit) { visit_profile_samples(r, visit); });
           })
      .def("__str__", &profiles_summary);
}

void bind_program_plan(py::module_& module) {
  bind_plan<ProgramResult>(module, "Program", program_doc)
      .def_property_readonly("success", [](const ProgramResult& r) { return r.verification.feasible; })
      .def_property_readonly("plan", [](const ProgramResult& r) { return r.legs.single() ? "fixed" : "per-leg"; })
      .def_property_readonly("x", &taps)
      .def_property_readonly("taps", &taps)
      .def_property_readonly("delays", view_of(&ProgramPlan::delays))
      .def_property_readonly("errors", view_of(&ProgramPlan::errors))
      .def_property_readonly("durations", view_of<ProgramResult>(&Toolpath::duration))
      .def("to_json", py::overload_cast<const ProgramResult&>(&program_to_json))
      .def("emit", &emitted)
      .def("samples",
           [](const ProgramResult& r) {
             if (r.path.blocks() == 0) throw std::runtime_error("there is no plan: " + r.message);
             return samples(r.path, r.sample_period, r.plan.simulation.samples,
                            [&](const SampleVisitor& visit) { visit_samples(r, visit); });
           })
      .def("__str__", &program_summary);
}

}  // namespace

void bind_program(py::module_& module) {
  bind_program_plan(module);
  bind_profiles(module);
  module.def(
      "program",
      [](const std::string& file, const std::shared_ptr<Task>& task, const std::string& how, bool keep_feeds,
         std::optional<double> arc_tolerance, std::optional<double> time_limit, bool rapid_stops,
         bool dwells_before_filter, bool filter_bound, const std::string& tool_table, const py::object& progress) {
        ProgramFileOptions options;
        if (arc_tolerance) options.arc_tolerance = *arc_tolerance;
        options.tool_table = tool_table;
        options.rapid_stops = rapid_stops;
        options.dwells_before_filter = dwells_before_filter;
        options.feeds = keep_feeds ? Feeds::keep : Feeds::choose;
        options.per_leg = how == "per-leg";
        options.filter_bound = filter_bound;
        options.time_limit = time_limit;
        return how == "profiles" ? fastest(file, task, options, progress)
                                 : py::cast(plan(file, task, options, progress));
      },
      py::arg("file"), py::arg("task"), py::kw_only(), py::arg("plan"), py::arg("keep_feeds"), py::arg("arc_tolerance"),
      py::arg("time_limit"), py::arg("rapid_stops"), py::arg("dwells_before_filter"), py::arg("filter_bound"),
      py::arg("tool_table"), py::arg("progress"));
  module.def(
      "program_figure", [](const ProgramResult& result) { return figure_dict(plot_program(result)); },
      py::arg("result"));
}

}  // namespace accdec::python
