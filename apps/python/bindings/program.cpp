#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_page.hpp>
#include <accdec/program.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

/// A plan, and what its page is drawn from.
struct Program : ProgramResult {
  Program(ProgramResult result, Toolpath path, const Machine& limits)
      : ProgramResult(std::move(result)), programmed(std::move(path)), machine(limits) {}
  Toolpath programmed;
  Machine machine;
};
using Pointer = std::shared_ptr<Program>;

/// Other controls to estimate, and their parameters.
struct Asked {
  std::vector<std::string> controls;
  std::map<std::string, double> given;
};

/// Takes the lines that planning says now and then. They end a cancelled planning where no deadline does.
std::function<void(const std::string&)> teller(const Work& work) {
  return [&work](const std::string& line) {
    if (work.cancelled) throw std::runtime_error("cancelled");
    work.tell(line);
  };
}

/// @param how  "fixed"; "profiles": that or fixed, whichever is the faster; "free"
Pointer plan(const std::string& file, const std::shared_ptr<Task>& task, const ProgramFileOptions& options,
             const std::string& how, const Asked& estimates, const py::object& progress) {
  const auto result = std::make_shared<Pointer>();
  run_interruptibly(
      [=](const Work& work) {
        ProgramFileOptions asked = options;
        asked.deadline.end_when(work.cancelled);
        asked.plan = plan_kind(how);
        asked.free.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
        asked.free.progress = [&work](const FreeProgress& at) {
          work.tell(fmt::format("{}, {:.3f} s gained", at.stage, at.gained));
        };
        ProgramFile read = read_program_file(file, *task, asked, teller(work));
        Toolpath programmed = read.path;
        std::vector<ControlEstimate> estimated =
            estimate_times(programmed, task->machine, estimates.controls, estimates.given);
        ProgramResult found = run_program_file(std::move(read), *task, asked, teller(work));
        found.estimates = std::move(estimated);
        *result = std::make_shared<Program>(std::move(found), std::move(programmed), task->machine);
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
auto view_of(std::vector<Number> Toolpath::*member) {
  return [member](const py::object& self) { return view(self.cast<const Program&>().plan.path.*member, self); };
}

py::list candidates(const std::vector<PlanTime>& plans) {
  py::list list;
  for (const PlanTime& p : plans) {
    if (p.time == 0.0) continue;  // not checked
    list.append(py::dict(py::arg("plan") = p.plan, py::arg("cycle_time") = p.time, py::arg("verified") = p.verified));
  }
  return list;
}

py::list estimate_list(const Program& r) {
  py::list list;
  for (const ControlEstimate& e : r.estimates) {
    py::dict parameters;
    for (const ControlParameter& p : e.parameters) parameters[py::str(p.name)] = p.value;
    list.append(py::dict(py::arg("control") = e.control, py::arg("time") = e.time, py::arg("parameters") = parameters,
                         py::arg("not_known") = e.unknown));
  }
  return list;
}

py::list load_list(const Program& r) {
  py::list list;
  for (const AxisLoad& load : r.loads) {
    py::dict d(py::arg("axis") = load.axis, py::arg("peak") = load.peak, py::arg("rms") = load.rms);
    if (load.rms_max < unlimited) d["rms_max"] = load.rms_max;
    list.append(d);
  }
  return list;
}

py::list bound_list(const Program& r) {
  py::list list;
  for (const NamedBound& b : bounds_of(r))
    list.append(py::dict(py::arg("name") = b.name, py::arg("time") = b.time, py::arg("motions") = b.motions,
                         py::arg("complete") = b.complete));
  return list;
}

std::string describe_program(const Program& r) {
  std::string text =
      fmt::format("<accdec.Program {}: {}, {:.6g} s", r.program,
                  r.plan.empty() ? std::string("no plan") : fmt::format("plan {}", r.plan.name()), r.cycle_time);
  if (!r.verification.feasible) text += ", not verified";
  for (const NamedBound& b : bounds_of(r))
    text += fmt::format("; at least {:.6g} s ({}{})", b.time, b.name, b.complete ? "" : ", not finished");
  return text + ">";
}

py::object taps(const py::object& self) {
  const auto& result = self.cast<const Program&>();
  if (result.plan.empty()) return py::none();
  const auto taps = result.plan.set().taps();
  return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
}

/// None where the plan has no delays.
py::object delays(const py::object& self) {
  const FilteredCommand* command = self.cast<const Program&>().plan.command();
  return command != nullptr ? view(command->delays, self) : py::object(py::none());
}

/// None for a task without families.
py::object settings(const Program& r) {
  if (!r.settings) return py::none();
  return settings_dict(r.settings->chosen, program_settings_answer(r));
}

/// None without a servo.
py::object servo(const Program& r) {
  if (!r.servo) return py::none();
  py::dict d(py::arg("settling") = r.servo->settling, py::arg("within") = r.servo->within,
             py::arg("stop_error") = r.servo->stop_error, py::arg("axes_differ") = r.plan.command()->moved.size() > 1);
  if (r.servo->legs) d["leg_error"] = r.servo->legs->error, d["leg_line"] = r.servo->legs->line;
  return d;
}

constexpr const char* no_plan = "there is no plan: ";

/// A trajectory that breaks a limit is not given to anyone.
void require_motion(const Program& r) {
  if (r.plan.empty() || (r.plan.trajectory() != nullptr && !r.verification.feasible))
    throw std::runtime_error(no_plan + r.message);
}

/// Positions behind the servo at the samples of the command, m, samples by axes.
py::array_t<double> motion_behind(const Program& r, py::ssize_t rows) {
  const auto n = static_cast<std::ptrdiff_t>(r.plan.path.axes.size());
  std::vector<double> position;
  Motion motion(r.plan, r.sample_period, true);
  for (Sample sample; motion.next(sample) && sample.number < rows;)
    position.insert(position.end(), sample.position.begin(), sample.position.begin() + n);
  return py::array_t<double>({rows, n}, position.data());
}

/// Every sample of the motion, samples by axes; the first is at rest where the program begins.
py::dict samples(const Program& r) {
  require_motion(r);
  const Toolpath& path = r.plan.path;
  const auto n = static_cast<std::ptrdiff_t>(path.axes.size());
  std::vector<double> time, position, velocity;
  {
    const py::gil_scoped_release release;
    for (std::vector<double>* values : {&time, &position, &velocity})
      values->reserve(static_cast<std::size_t>((r.check.samples + 2) * (values == &time ? 1 : n)));
    visit_samples(r, [&](std::int64_t k, const double* at, const double* speed) {
      time.push_back(static_cast<double>(k) * r.sample_period);
      position.insert(position.end(), at, at + n);
      velocity.insert(velocity.end(), speed, speed + n);
    });
  }
  const auto rows = static_cast<py::ssize_t>(time.size());
  py::list axes;
  for (std::size_t a = 0; a < path.axes.size(); ++a) axes.append(path.axis_name(a));
  py::dict all(py::arg("time") = py::array_t<double>(rows, time.data()),
               py::arg("position") = py::array_t<double>({rows, n}, position.data()),
               py::arg("velocity") = py::array_t<double>({rows, n}, velocity.data()), py::arg("axes") = axes);
  if (r.servo) all["motion"] = motion_behind(r, rows);
  return all;
}

std::string page_of(const Program& r) {
  require_motion(r);
  return program_page(r.programmed, r.machine, r);
}

std::string emitted(const ProgramResult& r) {
  if (r.plan.command() == nullptr)
    throw std::runtime_error("only plan fixed has commands to write; this one is a motion, see samples()");
  std::ostringstream out;
  emit_program(r, out);
  return out.str();
}

constexpr const char* program_doc = R"(The plan of a whole program, every sample checked. Made by `program`.

Attributes
----------
success : bool
    Every corner holds its tolerance and every limit is held over the whole program.
message : str
plan : str
    "fixed": commands with one filter. "profiles": a motion with a filter and a speed at every corner, for controllers
    that take a position every cycle. "free": a motion whose every sample is chosen, for the same controllers.
candidates : list of dict
    With ``plan="profiles"`` or ``"free"`` the plan made beside it: plan, cycle_time (s), verified.
fun, cycle_time : float
    s.
lower_bound : float
    s, way over feed; no motion that passes every corner within its tolerance is shorter, wherever it is between them.
axis_loads : list of dict
    The force of every axis with a load over the whole program, in N, or N m for axes a, b and c: axis, peak, rms (root
    mean square), and rms_max if the axis has a rating.
bounds : list of dict
    Times that no motion of a class undercuts, the widest class first: name, time (s), motions (the class in words),
    complete (False: cut short by the time; a finished bound may be larger).
estimates : list of dict
    One for each control asked for: control, time (s), parameters (by their names, in the control's own units),
    not_known (what the control does not know, in words).
x, taps : ndarray or None
    The filter, b_0 .. b_N; of plan "profiles" the last, which all samples pass (a single tap: none).
delays : ndarray of int or None
    Samples, one a commanded move: the delay at its end. None of the other plans.
errors, tolerances : ndarray
    m, at the end of every commanded move; the tolerance is inf where there is none.
lines : ndarray of int
    Line of the program of every commanded move.
durations : ndarray
    s, way over feed of every commanded move.
settings : dict or None
    If the task names families, or taps of a controller that has only some delays, the values to enter: family, values,
    answer (in words), and delays: the kind at the end of every commanded move. width, width_low and width_high (m) are
    None if no corner is in-position.
answer : str
    What to set, for a task that names families, or a control that takes the taps. Empty for others.
today : float or None
    s, of the program with today's setting of the controller, where it was planned; inf if no plan with it holds all
    limits.
servo : dict or None
    None without a servo. settling (s, from the end of the command until the motion is within `within` of its end),
    within (m), stop_error (m, the largest at stops, where the control waits for the command). Errors are the motion's.
    axes_differ: whether axes have different servos, behind which straight legs bend. Then also leg_error (m, the
    largest distance of the motion from the line of a leg) and leg_line (of the program).
)";

constexpr const char* json_doc = "to_json(self)\n--\n\nThe text of a result file, as the command line's --json.";
constexpr const char* page_doc =
    "page(self)\n--\n\nOne HTML page that needs no network. It shows the path in the colour of its speed, with zoom, "
    "the "
    "limit "
    "that "
    "binds over time, and the time lost by classes of corners.";
constexpr const char* samples_doc =
    "samples(self)\n--\n\nEvery sample of the motion: time (s), position and velocity (m, m/s; samples by axes), axes. "
    "Behind a servo that is the command, and motion (m) is what the axes do.";

void bind_plan(py::module_& module) {
  py::class_<Program, std::shared_ptr<Program>>(module, "Program", program_doc)
      .def_property_readonly("success", [](const Program& r) { return r.verification.feasible; })
      .def_property_readonly("message", [](const Program& r) { return r.message; })
      .def_property_readonly("plan", [](const Program& r) { return r.plan.name(); })
      .def_property_readonly("candidates", [](const Program& r) { return candidates(r.candidates); })
      .def_property_readonly("fun", [](const Program& r) { return r.cycle_time; })
      .def_property_readonly("cycle_time", [](const Program& r) { return r.cycle_time; })
      .def_property_readonly("lower_bound", [](const Program& r) { return r.lower_bound; })
      .def_property_readonly("axis_loads", &load_list)
      .def_property_readonly("bounds", &bound_list)
      .def_property_readonly("estimates", &estimate_list)
      .def_property_readonly("x", &taps)
      .def_property_readonly("taps", &taps)
      .def_property_readonly("delays", &delays)
      .def_property_readonly("errors",
                             [](const py::object& self) { return view(self.cast<const Program&>().errors, self); })
      .def_property_readonly("tolerances", view_of(&Toolpath::tolerance))
      .def_property_readonly("lines", view_of(&Toolpath::line))
      .def_property_readonly("durations", view_of(&Toolpath::duration))
      .def_property_readonly("settings", &settings)
      .def_property_readonly("answer", &program_answer)
      .def_property_readonly("today", [](const Program& r) { return r.today; })
      .def_property_readonly("servo", &servo)
      .def(
          "to_json", [](const Program& r) { return program_to_json(r); }, json_doc)
      .def("page", &page_of, page_doc)
      .def(
          "emit", [](const Program& r) { return emitted(r); },
          "emit(self)\n--\n\nThe program written back, with the feeds and delays of the plan, as the command line's "
          "--emit. "
          "Plan "
          "\"profiles\" cannot be written so.")
      .def("samples", &samples, samples_doc)
      .def("__repr__", &describe_program)
      .def("__str__", [](const Program& r) { return program_summary(r); });
}

}  // namespace

void bind_program(py::module_& module) {
  py::options options;
  options.disable_function_signatures();
  bind_plan(module);
  module.def(
      "program",
      [](const std::string& file, const std::shared_ptr<Task>& task, const std::string& how, bool keep_feeds,
         std::optional<double> arc_tolerance, std::optional<double> time_limit, bool rapid_stops,
         bool dwells_before_filter, bool filter_bound, bool compensate_arcs, const std::string& tool_table,
         std::optional<double> tool_length, const std::vector<std::string>& estimate,
         const std::map<std::string, double>& estimate_options, const py::object& progress) {
        ProgramFileOptions options;
        if (arc_tolerance) options.arc_tolerance = *arc_tolerance;
        options.tools.table = tool_table;
        options.tools.length = tool_length;
        options.rapid_stops = rapid_stops;
        options.fixed.dwells_before_filter = dwells_before_filter;
        options.fixed.feeds = keep_feeds ? Feeds::keep : Feeds::choose;
        options.fixed.filter_bound = filter_bound;
        options.fixed.compensate_arcs = compensate_arcs;
        options.time_limit = time_limit;
        if (time_limit) options.deadline = Deadline(*time_limit);
        return plan(file, task, options, how, {estimate, estimate_options}, progress);
      },
      py::arg("file"), py::arg("task"), py::kw_only(), py::arg("plan"), py::arg("keep_feeds"), py::arg("arc_tolerance"),
      py::arg("time_limit"), py::arg("rapid_stops"), py::arg("dwells_before_filter"), py::arg("filter_bound"),
      py::arg("compensate_arcs"), py::arg("tool_table"), py::arg("tool_length"), py::arg("estimate"),
      py::arg("estimate_options"), py::arg("progress"));
  module.def("plan_names", &plan_names);
  module.def("estimated_controls", &estimated_controls);
  module.def(
      "program_drawing",
      [](const Pointer& result, const std::string& format) {
        return drawn([&] {
          if (format == "html") return page_of(*result);
          require_motion(*result);
          const Figure figure = plot_program(*result, result->programmed, result->machine);
          return convert_svg(render_svg(figure), format, figure.title);
        });
      },
      py::arg("result"), py::arg("format"));
}

}  // namespace accdec::python
