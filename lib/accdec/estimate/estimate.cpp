#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/estimate/planners.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/program.hpp>

namespace accdec {
namespace {

/// A parameter as a control's own settings name it.
struct Parameter {
  std::string_view name, unit;
  double si = 1.0;     // value in SI = si * value
  double usual = 0.0;  // the control's default; unused where the task says it
  double low = 0.0, high = 0.0;
  bool of_task = false;
};

struct Control {
  std::string name;
  std::vector<Parameter> parameters;
  bool tolerances = false;  // it blends corners within G64 P and knows G61.1
};

const std::vector<Control>& controls() {
  static const std::vector<Control> all{
      {"klipper",
       {{"max_velocity", "mm/s", 1e-3, 0.0, 1e-3, 1e6, true},
        {"max_accel", "mm/s^2", 1e-3, 0.0, 1e-3, 1e9, true},
        {"max_z_velocity", "mm/s", 1e-3, 0.0, 1e-3, 1e6, true},
        {"max_z_accel", "mm/s^2", 1e-3, 0.0, 1e-3, 1e9, true},
        {"square_corner_velocity", "mm/s", 1e-3, 5.0, 0.0, 1e6},
        {"minimum_cruise_ratio", "", 1.0, 0.5, 0.0, 0.999},
        {"resolution", "mm", 1e-3, 1.0, 1e-3, 1e6}}},
      {"grbl",
       {{"junction_deviation", "mm", 1e-3, 0.01, 0.0, 1e3},
        {"arc_tolerance", "mm", 1e-3, 0.002, 1e-6, 1e3},
        {"steps_per_mm", "1/mm", 1e3, 250.0, 1e-3, 1e9},
        {"block_buffer_size", "", 1.0, 16.0, 3.0, 1e6}}},
      {"linuxcnc-2.9",
       {{"max_feed_override", "", 1.0, 1.0, 1e-3, 1e3},
        {"arc_blend_kink_ratio", "", 1.0, 0.1, 0.001, 0.7071},
        {"arc_blend_optimization_depth", "", 1.0, 50.0, 2.0, 1e6},
        {"arc_blend_gap_cycles", "", 1.0, 4.0, 0.0, 1e6},
        {"servo_period", "ms", 1e-3, 1.0, 1e-3, 1e3}},
       true},
  };
  return all;
}

const Control& control_named(std::string_view name) {
  const auto found =
      std::find_if(controls().begin(), controls().end(), [&](const Control& c) { return c.name == name; });
  if (found == controls().end())
    throw std::invalid_argument(unknown_name("control to estimate", name, estimated_controls()));
  return *found;
}

/// In SI, of Klipper's path: the smaller of X and Y, and Z's own.
double task_value(const Parameter& parameter, const ControlLimits& limits) {
  const bool z = parameter.name.starts_with("max_z");
  const Vector& values = parameter.name.ends_with("accel") ? limits.acceleration : limits.velocity;
  const double plane = std::min(values[0], values[1]);
  const double value = z || !(plane < unlimited) ? values[2] : plane;
  return value < unlimited ? value : plane;
}

std::vector<ControlParameter> parameters_for(const Control& control, const ControlLimits& limits,
                                             const std::map<std::string, double>& given) {
  std::vector<ControlParameter> result;
  for (const Parameter& parameter : control.parameters) {
    ControlParameter& one = result.emplace_back();
    one.name = parameter.name;
    one.unit = parameter.unit;
    if (const auto found = given.find(one.name); found != given.end()) {
      one.from = "given";
      one.value = found->second;
      if (!(one.value >= parameter.low && one.value <= parameter.high))
        throw std::invalid_argument(fmt::format("{} of {} is {:g}; allowed is {:g} to {:g}{}{}", one.name, control.name,
                                                one.value, parameter.low, parameter.high, one.unit.empty() ? "" : " ",
                                                one.unit));
    } else if (parameter.of_task) {
      one.from = "task";
      one.value = task_value(parameter, limits) / parameter.si;
      if (!std::isfinite(one.value))
        throw std::invalid_argument(
            fmt::format("the estimate for {} needs {}, or the limit of the axes in the task", control.name, one.name));
    } else {
      one.from = "default";
      one.value = parameter.usual;
    }
  }
  return result;
}

void check_names(const Control& control, const std::map<std::string, double>& given) {
  const std::vector<std::string> names = parameters_of_control(control.name);
  for (const auto& [name, value] : given) {
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw std::invalid_argument(unknown_name("parameter of " + control.name, name, names));
  }
}

/// Limits of the task that no control here knows.
std::vector<std::string> unknown_limits(const Machine& machine) {
  std::vector<std::string> unknown;
  const auto any = [&](double Axis::*limit) {
    return std::any_of(machine.axes.begin(), machine.axes.end(), [&](const Axis& a) { return a.*limit < unlimited; });
  };
  if (any(&Axis::jerk_max)) unknown.emplace_back("the jerk limit");
  if (any(&Axis::force_max)) unknown.emplace_back("the force limit");
  if (any(&Axis::power_max) || machine.power_total_max < unlimited) unknown.emplace_back("the power limit");
  if (any(&Axis::regeneration_max) || machine.regeneration_total_max < unlimited)
    unknown.emplace_back("the regeneration limit");
  if (!machine.modes.empty()) unknown.emplace_back("the bound on vibration");
  return unknown;
}

void add_unknown_words(const Control& control, const std::vector<ControlMove>& moves,
                       std::vector<std::string>& unknown) {
  const auto any = [&](auto is) { return std::any_of(moves.begin(), moves.end(), is); };
  if (!control.tolerances) {
    if (any([](const ControlMove& m) { return m.control == PathControl::blend && m.tolerance > 0.0; }))
      unknown.emplace_back("the tolerance of G64 P: corners are passed at their points, with a jump of the velocity");
    if (any([](const ControlMove& m) { return m.control == PathControl::exact_stop; }))
      unknown.emplace_back("G61.1: corners are passed without a stop");
  }
  if (control.name == "klipper" && any([](const ControlMove& m) { return m.rapid; }))
    unknown.emplace_back("rapid moves: G0 runs at max_velocity here, and at the F in force there");
}

}  // namespace

const std::vector<std::string>& estimated_controls() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Control& control : controls()) list.push_back(control.name);
    return list;
  }();
  return names;
}

std::vector<std::string> parameters_of_control(std::string_view control) {
  std::vector<std::string> names;
  for (const Parameter& parameter : control_named(control).parameters) names.emplace_back(parameter.name);
  return names;
}

ControlEstimate estimate_time(const Toolpath& path, const Machine& machine, std::string_view name,
                              const std::map<std::string, double>& given) {
  const Control& control = control_named(name);
  check_names(control, given);
  const std::vector<ControlMove> moves = control_moves(path, name);
  const ControlLimits limits = control_limits(path, machine, name);
  ControlEstimate estimate;
  estimate.control = control.name;
  estimate.parameters = parameters_for(control, limits, given);
  ControlSettings settings;
  for (std::size_t i = 0; i < control.parameters.size(); ++i)
    settings[std::string(control.parameters[i].name)] = control.parameters[i].si * estimate.parameters[i].value;
  estimate.time = path.dwell_first + (name == "klipper" ? klipper_time(moves, settings)
                                      : name == "grbl"  ? grbl_time(moves, limits, settings)
                                                        : linuxcnc_time(moves, limits, settings));
  estimate.unknown = unknown_limits(machine);
  add_unknown_words(control, moves, estimate.unknown);
  return estimate;
}

std::vector<ControlEstimate> estimate_times(const Toolpath& path, const Machine& machine,
                                            const std::vector<std::string>& controls,
                                            const std::map<std::string, double>& given) {
  std::map<std::string, double> unused = given;
  std::vector<std::string> known;
  std::vector<ControlEstimate> estimates;
  for (const std::string& control : controls) {
    std::map<std::string, double> own;
    for (std::string& name : parameters_of_control(control)) {
      if (const auto found = given.find(name); found != given.end()) own.insert(*found);
      unused.erase(name);
      known.push_back(std::move(name));
    }
    estimates.push_back(estimate_time(path, machine, control, own));
  }
  if (!unused.empty())
    throw std::invalid_argument(
        unknown_name(fmt::format("parameter of {}", fmt::join(controls, ", ")), unused.begin()->first, known));
  return estimates;
}

std::string estimate_text(const ControlEstimate& estimate, double plan_time) {
  std::vector<std::string> parameters;
  for (const ControlParameter& one : estimate.parameters)
    parameters.push_back(fmt::format("{} {:g}{}{}", one.name, one.value, one.unit.empty() ? "" : " ", one.unit));
  std::string text = fmt::format("{} would take {:.4f} s: an estimate with {}", estimate.control, estimate.time,
                                 fmt::join(parameters, ", "));
  if (plan_time > 0.0) text += fmt::format("; accdec's plan takes {:.4f} s", plan_time);
  text += "\n";
  for (const std::string& unknown : estimate.unknown)
    text += fmt::format("  {} does not know {}\n", estimate.control, unknown);
  return text;
}

}  // namespace accdec
