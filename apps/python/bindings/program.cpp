#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_page.hpp>
#include <accdec/program/write/fastest_plan.hpp>
#include <accdec/program/write/program_file.hpp>
#include <accdec/program/write/samples.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

/// A plan, and what its page is drawn from.
template <class Result>
struct Planned : Result {
  Planned(Result result, Toolpath path, const Machine& limits)
      : Result(std::move(result)), programmed(std::move(path)), machine(limits) {}
  Toolpath programmed;
  Machine machine;
};
using Program = Planned<ProgramResult>;
using ProfileProgram = Planned<ProfileResult>;
using Pointer = std::shared_ptr<Program>;
using ProfilePointer = std::shared_ptr<ProfileProgram>;

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
        ProgramFile read = read_program_file(file, *task, options, teller(work));
        Toolpath programmed = read.path;
        *result = std::make_shared<Program>(run_program_file(file, read, *task, options, teller(work)),
                                            std::move(programmed), task->machine);
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
        ProgramFile read = read_program_file(file, *task, options, teller(work));
        auto found = run_fastest_plan(file, read, *task, options, teller(work));
        if (auto* profiles = std::get_if<ProfileResult>(&found)) {
          *result = std::make_shared<ProfileProgram>(std::move(*profiles), std::move(read.path), task->machine);
        } else {
          *result =
              std::make_shared<Program>(std::get<ProgramResult>(std::move(found)), std::move(read.path), task->machine);
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
  return [member](const py::object& self) { return view(self.cast<const Program&>().plan.*member, self); };
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
  const auto& result = self.cast<const Program&>();
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

constexpr const char* no_plan = "there is no plan: ";

template <class Result>
std::string page_of(const Result& r, bool planned) {
  if (!planned) throw std::runtime_error(no_plan + r.message);
  return program_page(r.programmed, r.machine, r);
}

std::string emitted(const ProgramResult& r) {
  std::ostringstream out;
  emit_program(r, out);
  return out.str();
}

/// The documentation of a class: both kinds of plan have the attributes in the middle.
std::string plan_doc(const char* what, const char* plan, const char* more) {
  return fmt::format(R"({}

Attributes
----------
success : bool
    Every corner holds its tolerance and every limit is held over the whole program.
message : str
plan : str
    {}.
candidates : list of dict
    With ``plan="profiles"`` the plans made beside it: plan, cycle_time (s), verified.
fun, cycle_time : float
    s.
lower_bound : float
    s; no continuous motion at the programmed feeds is shorter.
{})",
                     what, plan, more);
}

constexpr const char* profiles_doc =
    R"(A program planned with own filters and speeds at every corner, for controllers that take a position every cycle.
Made by `program` with ``plan="profiles"`` where that is the fastest plan; every sample is checked.)";

constexpr const char* profiles_attributes = R"(x, taps : ndarray
    The last filter, which all samples pass; a single tap: none.
errors, tolerances : ndarray
    m, at the end of every block; the tolerance is inf where there is none.
lines : ndarray of int
    Line of the program of every block.
)";

constexpr const char* program_attributes = R"(x, taps : ndarray or None
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

constexpr const char* json_doc = "to_json()\n\nThe text of a result file, as the command line's --json.";
constexpr const char* page_doc =
    "page()\n\nOne HTML page without network: the path in the colour of its speed, to zoom into, the limit that binds "
    "over time, "
    "and the time lost by classes of corners.";
constexpr const char* samples_doc =
    "samples()\n\nEvery sample of the motion: time (s), position and velocity (m, m/s; samples by axes), axes.";

/// What both kinds of plan have.
template <class Result>
py::class_<Result, std::shared_ptr<Result>> bind_plan(py::module_& module, const char* name, const std::string& doc) {
  return py::class_<Result, std::shared_ptr<Result>>(module, name, doc.c_str())
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
    const auto taps = self.cast<const ProfileProgram&>().plan.last.taps();
    return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
  };
  bind_plan<ProfileProgram>(module, "ProfileProgram", plan_doc(profiles_doc, "\"profiles\"", profiles_attributes))
      .def_property_readonly("success", [](const ProfileProgram& r) { return r.message.empty(); })
      .def_property_readonly("plan", [](const ProfileProgram&) { return "profiles"; })
      .def_property_readonly("x", last_filter)
      .def_property_readonly("taps", last_filter)
      .def_property_readonly(
          "errors", [](const py::object& self) { return view(self.cast<const ProfileProgram&>().plan.errors, self); })
      .def(
          "to_json", [](const ProfileProgram& r) { return profiles_to_json(r); }, json_doc)
      .def(
          "page", [](const ProfileProgram& r) { return page_of(r, r.message.empty()); }, page_doc)
      .def(
          "samples",
          [](const ProfileProgram& r) {
            if (!r.message.empty()) throw std::runtime_error(no_plan + r.message);
            return samples(r.path, r.sample_period, r.plan.check.samples,
                           [&](const SampleVisitor& visit) { visit_profile_samples(r, visit); });
          },
          samples_doc)
      .def("__str__", [](const ProfileProgram& r) { return profiles_summary(r); });
}

void bind_program_plan(py::module_& module) {
  bind_plan<Program>(module, "Program",
                     plan_doc("The plan of a whole program, every sample simulated. Made by `program`.",
                              "\"fixed\" or \"per-leg\"", program_attributes))
      .def_property_readonly("success", [](const Program& r) { return r.verification.feasible; })
      .def_property_readonly("plan", [](const Program& r) { return r.legs.single() ? "fixed" : "per-leg"; })
      .def_property_readonly("x", &taps)
      .def_property_readonly("taps", &taps)
      .def_property_readonly("delays", view_of(&ProgramPlan::delays))
      .def_property_readonly("errors", view_of(&ProgramPlan::errors))
      .def_property_readonly("durations", view_of<Program>(&Toolpath::duration))
      .def(
          "to_json", [](const Program& r) { return program_to_json(r); }, json_doc)
      .def(
          "page", [](const Program& r) { return page_of(r, r.path.blocks() > 0); }, page_doc)
      .def(
          "emit", [](const Program& r) { return emitted(r); },
          "emit()\n\nThe program written back, with the feeds and delays of the plan, as the command line's --emit.")
      .def(
          "samples",
          [](const Program& r) {
            if (r.path.blocks() == 0) throw std::runtime_error(no_plan + r.message);
            return samples(r.path, r.sample_period, r.plan.simulation.samples,
                           [&](const SampleVisitor& visit) { visit_samples(r, visit); });
          },
          samples_doc)
      .def("__str__", [](const Program& r) { return program_summary(r); });
}

}  // namespace

void bind_program(py::module_& module) {
  py::options options;
  options.disable_function_signatures();
  bind_program_plan(module);
  bind_profiles(module);
  module.def(
      "program",
      [](const std::string& file, const std::shared_ptr<Task>& task, const std::string& how, bool keep_feeds,
         std::optional<double> arc_tolerance, std::optional<double> time_limit, bool rapid_stops,
         bool dwells_before_filter, bool filter_bound, bool compensate_arcs, const std::string& tool_table,
         const py::object& progress) {
        ProgramFileOptions options;
        if (arc_tolerance) options.arc_tolerance = *arc_tolerance;
        options.tool_table = tool_table;
        options.rapid_stops = rapid_stops;
        options.dwells_before_filter = dwells_before_filter;
        options.feeds = keep_feeds ? Feeds::keep : Feeds::choose;
        options.per_leg = how == "per-leg";
        options.filter_bound = filter_bound;
        options.compensate_arcs = compensate_arcs;
        options.time_limit = time_limit;
        return how == "profiles" ? fastest(file, task, options, progress)
                                 : py::cast(plan(file, task, options, progress));
      },
      py::arg("file"), py::arg("task"), py::kw_only(), py::arg("plan"), py::arg("keep_feeds"), py::arg("arc_tolerance"),
      py::arg("time_limit"), py::arg("rapid_stops"), py::arg("dwells_before_filter"), py::arg("filter_bound"),
      py::arg("compensate_arcs"), py::arg("tool_table"), py::arg("progress"));
  module.def(
      "program_figure", [](const Program& result) { return figure_dict(plot_program(result)); }, py::arg("result"));
}

}  // namespace accdec::python
