#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <pybind11/stl.h>

#include <accdec/files/faults.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/formats/rotary_table.hpp>
#include <accdec/formats/si_names.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task.hpp>
#include <accdec/task/objective.hpp>

#include "bindings.hpp"

namespace accdec::python {
namespace {

/// Tasks of whole programs have no corners, and a lone axis stands for all that a program may move.
TaskOptions options_of(bool program, bool given) {
  return {.require_corners = !program, .require_choices = given, .axes = program ? 9 : 2, .response = Considered::all};
}

py::module_ fields_module() {
  return py::module_::import("accdec._fields");
}

bool flag(const char* name, const py::object& value) {
  return argument<bool>("flag", name, value);
}

/// What `make` returns. Its errors speak of Python's arguments: their names, units and types.
/// @param written  what the user wrote, as JSON
template <class Make>
Task in_words_of_python(const std::string& written, Make make) {
  try {
    return make();
  } catch (const InputError& error) {
    const auto* several = dynamic_cast<const InputErrors*>(&error);
    std::vector<InputError> said;
    for (const InputError& one : several ? several->all() : std::vector<InputError>{error}) {
      const std::string text = in_si_names(one.message(), written);
      said.emplace_back(one.file(), one.line(), one.column(),
                        fields_module().attr("in_python_words")(text, one.pointer(), written).cast<std::string>(),
                        one.pointer());
    }
    throw InputErrors(std::move(said), several ? several->unlisted() : 0, several && several->at_least());
  }
}

/// @param given  also program, True or the table [program]; _program: True even where that is a table
Task from_fields(const py::dict& given) {
  const py::tuple parts = fields_module().attr("parted")(given);
  const auto json = parts[0].cast<std::string>();
  const TaskOptions options = options_of(parts[1].cast<bool>(), false);
  return in_words_of_python(json, [&] { return parse_task_json(json, "task", options); });
}

Task read(const py::object& path, const py::object& program, const py::object& given) {
  return read_task(file_name(path), options_of(flag("program", program), flag("given", given)));
}

Task parse(const py::object& text, const py::object& name, const py::object& program) {
  return parse_task(argument<std::string>("text", "text", text), argument<std::string>("text", "name", name),
                    options_of(flag("program", program), false));
}

Task with_value(const Task& task, const py::object& key, const py::object& value) {
  const auto name = argument<std::string>("text", "key", key);
  const auto number = argument<double>("real", "value", value);
  const std::string written = nlohmann::json::object({{name.substr(name.rfind('.') + 1), number}}).dump();
  return in_words_of_python(written, [&] { return with_setting(task, name, number); });
}

py::object vector(const Eigen::VectorXd& v) {
  return py::array_t<double>(v.size(), v.data());
}

py::dict corner_dict(const TaskCorner& c) {
  py::dict d;
  d["name"] = c.name;
  d["angle"] = std::acos(c.geometry().cos_interior());
  d["direction_in"] = vector(c.geometry().direction_in);
  d["direction_out"] = vector(c.geometry().direction_out);
  d["feed_in"] = c.geometry().feed_in;
  d["feed_out"] = c.geometry().feed_out;
  d["error_max"] = c.error_max;
  d["speed_min"] = c.speed_min;
  d["contour_max"] = c.contour_max;
  d["delay"] = c.delay;
  d["weight"] = c.weight;
  return d;
}

/// None stands for a key that is not given, so that the constructor takes what is read here.
py::dict axis_dict(const Axis& axis) {
  py::dict d;
  d["name"] = axis.name;
  if (is_rotary(axis.name)) {
    for (const auto& [name, value] : rotary_in_si(axis)) d[py::str(name)] = value;
    d["power_max"] = axis.power_max, d["regeneration_max"] = axis.regeneration_max;
  } else {
    d["mass"] = axis.mass;
    d["damping"] = axis.damping;
    d["coulomb"] = axis.coulomb;
    for (const AxisLimit& limit : axis_limits) {
      if (limit.kind != LimitKind::force_speed)
        d[py::str(fmt::format("{}_max", limit_name(limit.kind).name))] = axis.*limit.bound;
    }
    d["force_rms"] = axis.force_rms_max;
  }
  d["servo_gain"] = axis.servo_gain;
  const bool servo = axis.servo_gain < unlimited, measured = !axis.response_taps.empty();
  d["velocity_feedforward"] = servo ? py::object(py::float_(axis.velocity_feedforward)) : py::none();
  d["response_taps"] = measured ? py::cast(axis.response_taps) : py::none();
  return d;
}

py::list axes_of(const Task& task) {
  const auto written = task_to_json(task).at("axis");
  py::list list;
  for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
    py::dict d = axis_dict(task.machine.axes[i]);
    const bool turns = is_rotary(task.machine.axes[i].name);
    const std::string_view key = turns ? rotary_key(force_speed_key) : force_speed_key;
    const auto curve = written[i].find(key);
    d[py::str(key)] =
        curve == written[i].end() ? py::none() : py::cast(curve->template get<std::vector<std::vector<double>>>());
    list.append(d);
  }
  return list;
}

std::string describe_task(const Task& task) {
  std::string axes, corners;
  for (const Axis& axis : task.machine.axes) axes += (axes.empty() ? "" : ", ") + axis.name;
  for (const TaskCorner& corner : task.corners) corners += (corners.empty() ? "" : ", ") + corner.name;
  return fmt::format("<accdec.Task \"{}\": T = {:.6g} ms, axes {}, corners {}, filter {}>", task.title,
                     1e3 * task.sample_period, axes.empty() ? "none" : axes, corners.empty() ? "none" : corners,
                     task.filter ? to_string(task.filter->kind) : "open");
}

constexpr const char* task_doc = R"(The corners to design, and the limits of the machine.

Task(sample_period=..., axes=..., corners=..., modes=..., filter=..., order_max=..., ...)

Fields are those of a task file. A name without a unit is in SI: angle in rad, feed_in in m/s, error_max in m,
velocity_max in m/s, force_max in N. A name that ends in a unit is in that unit (angle_deg, feed_in_mm_min). Fields that
are None, and limits that are infinite, count as not given. Tasks do not change: `replace` and `set` make new ones.

Parameters
----------
program : bool or dict
    True: a task for a whole program, without corners, and up to nine axes. So is a task without corners that has a
    dict here: error_max and contour_max, for moves that the program gives no tolerance.
title : str, optional
sample_period : float
    s.
axes : dict or list of dict, optional
    velocity_max, acceleration_max, jerk_max, mass, damping, coulomb (N, dry friction), force_max, power_max,
    regeneration_max, force_speed_N ([[mm/s, N], ..]), force_rms (N, over a whole program), name, servo_gain (1/s) with
    velocity_feedforward, or response_taps. One dict stands for every axis. Axes named a, b and c turn:
    velocity_max (rad/s), acceleration_max (rad/s^2), jerk_max (rad/s^3), inertia (kg m^2), damping (N m s), coulomb,
    torque_max and torque_rms (N m), torque_speed_N_m ([[deg/s, N m], ..]); or in degrees, as velocity_max_deg_s.
machine : dict, optional
    power_total_max, regeneration_total_max (W): limits of the supply that all axes share.
corners : dict or list of dict
    angle (or direction_in and direction_out), feed_in, feed_out, error_max, contour_max, speed_min, delay, weight,
    heading, turn, name.
modes : dict or list of dict, optional
    frequency (Hz, or a band [low, high]; or one with frequency_spread), damping_ratio (0 .. 0.9, or a range [low,
    high]) and residual_max (0 .. 1), or axis and residual_max_um.
filter : array_like or dict, optional
    Taps, or a shape as {"kind": "trapezoid", "order": 30, "ramp": 8}; left open it is designed.
order_min, order_max : int, optional
symmetric : bool, optional
objective : {"cycle", "corner"}, optional
runs : float, optional
coefficient_bits : int, optional
    Taps in whole numbers over 2^bits, 8 to 31; the result's `quantisation` has them.
family : str or list of str, optional
    "averages", "one-pole", "exponential", "gaussian", "windowed-sinc", "shaper": settings of a controller instead of
    free taps, with stages, shaper, and length_step, length_max, length_set (s). length_set_2 and length_set_3 are
    those of stages whose set differs. The real numbers of a family have steps, too: time_constant_step (s), alpha_step,
    cutoff_step (Hz). shaper_frequency_step (Hz): of a control that interpolates; without it impulses are at whole
    samples.
controller : dict, optional
    name or file: of a controller, see `accdec controllers`; assumed: facts without a source, which the answer names;
    delays: the kinds of delay that it has; delay_words: what
    a program says for each of them;
    in_position_of ("command" or "actual"), in_position_by ("path" or "axis") and in_position_latency (s): how it sees
    that it is in-position;
    corner_feed_step: corners are passed at multiples of this fraction of both feeds, which last until the motion has
    settled;
    prefilter_taps: its own smoothing of every axis; position_unit_um: positions are whole numbers of it.

Raises
------
InputError
    With what is wrong and what is allowed.

Examples
--------
>>> import accdec
>>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
>>> task.corners[0]["error_max"], task.set("corner.*.error_max", 20e-6).corners[0]["error_max"]
(5e-05, 2e-05)
>>> task == accdec.Task.parse(task.to_toml())
True
)";

}  // namespace

void bind_task(py::module_& module) {
  py::options options;
  options.disable_function_signatures();  // pybind11's own say no more than `object`
  py::class_<Task, std::shared_ptr<Task>>(module, "Task", task_doc)
      .def(py::init([](const py::object& program, const py::kwargs& fields) {
             py::dict all(fields);
             all["program"] = program;
             return from_fields(all);
           }),
           py::arg("program") = false)
      .def_static("read", &read, py::arg("path"), py::arg("program") = false, py::arg("given") = false,
                  "read(path, program=False, given=False)\n--\n\nA task file. `program`: of a whole program; `given`: "
                  "filter and "
                  "delays must stand in it.")
      .def_static(
          "parse", &parse, py::arg("text"), py::arg("name") = "task", py::arg("program") = false,
          "parse(text, name='task', program=False)\n--\n\nThe text of a task file; `name` is what errors call it.")
      .def(
          "replace",
          [](const py::object& self, const py::kwargs& fields) {
            return fields_module().attr("replaced")(self, fields);
          },
          "replace(self, **fields)\n--\n\nA task with other fields, as of the constructor; what is None is left out.")
      .def(
          "to_dict", [](const py::object& self) { return fields_module().attr("to_dict")(self); },
          "to_dict(self)\n--\n\nThe tables of a task file, units in their keys; ``Task(**task.to_dict())`` is the same "
          "task.")
      .def(
          "write", [](const Task& task, const py::object& path) { write_file(file_name(path), task_to_toml(task)); },
          py::arg("path"), "write(self, path)\n--\n\nAs a task file, whole or not at all.")
      .def("_json", [](const Task& task) { return task_to_json(task).dump(); })
      .def("to_toml", &task_to_toml, "to_toml(self)\n--\n\nThe text of a task file, every axis and choice written out.")
      .def("set", &with_value, py::arg("key"), py::arg("value"),
           "set(self, key, value)\n--\n\nA task with another number at a key as studies vary it, in the key's unit: "
           "``set('corner.*.error_max_um', 20)``.")
      .def_readonly("title", &Task::title)
      .def_readonly("sample_period", &Task::sample_period)
      .def_property_readonly("axes", &axes_of)
      .def_property_readonly("corners", [](const Task& task) { return list_of(task.corners, corner_dict); })
      .def_property_readonly("objective", [](const Task& task) { return to_string(task.design.objective); })
      .def_property_readonly("order_min", [](const Task& task) { return task.design.order_min; })
      .def_property_readonly("order_max", [](const Task& task) { return task.design.order_max; })
      .def_property_readonly("symmetric", [](const Task& task) { return task.design.symmetric; })
      .def_property_readonly("taps",
                             [](const Task& task) -> py::object {
                               if (!task.filter) return py::none();
                               const Filter filter = make_filter(*task.filter);
                               const auto taps = filter.taps();
                               return py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data());
                             })
      .def("__eq__",
           [](const Task& a, const py::object& other) {
             return py::isinstance<Task>(other) && task_to_json(a) == task_to_json(other.cast<const Task&>());
           })
      .def("__hash__", [](const Task& task) { return std::hash<std::string>()(task_to_json(task).dump()); })
      .def("__str__", &task_to_toml)
      .def("__repr__", &describe_task)
      .def(py::pickle([](const Task& task) { return task_to_json(task).dump(); },
                      [](const std::string& json) { return parse_task_json(json, "task", options_of(true, false)); }));
}

}  // namespace accdec::python
