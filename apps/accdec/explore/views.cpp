#include "views.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/signed_value.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verified_contour.hpp>

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

/// To eight digits of the largest: enough for a picture, and less than half of the text.
std::vector<double> drawn(std::vector<double> values) {
  double peak = 0.0;
  for (const double v : values) peak = std::max(peak, std::abs(v));
  if (!(peak > 0.0) || !std::isfinite(peak)) return values;
  const double scale = std::pow(10.0, std::clamp(7.0 - std::floor(std::log10(peak)), 0.0, 22.0));
  for (double& v : values) v = std::round(v * scale) / scale;
  return values;
}

Json bound_json(const Axis& axis, const AxisLimit& limit) {
  const double bound = axis.*limit.bound;
  return bound < unlimited ? Json(bound * limit_name(limit.kind).per_si) : Json(nullptr);
}

bool shown(const AxisLimit& limit, const Machine& machine) {
  if (!limit.load) return true;
  return std::any_of(machine.axes.begin(), machine.axes.end(),
                     [&](const Axis& a) { return a.*limit.bound < unlimited; });
}

double still_speed(const TaskCorner& corner) {
  return still_part * std::max(corner.geometry().feed_in, corner.geometry().feed_out);
}

/// One quantity of every axis that moves.
Json quantity_json(const AxisLimit& limit, const SampledResponse& sampled, const TaskCorner& corner, const Task& task) {
  const LimitName& name = limit_name(limit.kind);
  Json axes = Json::array();
  for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
    const auto a = static_cast<Eigen::Index>(i);
    const Corner& legs = corner.geometry();
    if (std::max(std::abs(legs.direction_in[a]), std::abs(legs.direction_out[a])) < 1e-12) continue;
    const Axis& axis = task.machine.axes[i];
    if (limit.load && !(axis.*limit.bound < unlimited)) continue;
    std::vector<double> values;
    for (const AxisState& state : axis_states(sampled, axis, a, task.sample_period, still_speed(corner)))
      values.push_back(signed_value(state, limit.kind) * name.per_si);
    axes.push_back({{"name", axis.name}, {"bound", bound_json(axis, limit)}, {"values", drawn(std::move(values))}});
  }
  return {{"kind", name.name}, {"unit", name.unit}, {"axes", std::move(axes)}};
}

/// The power of all axes together, with one of the limits on it.
Json supply_json(const SupplyLimit& limit, const SampledResponse& sampled, const TaskCorner& corner, const Task& task) {
  std::vector<double> sum;
  for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
    const std::vector<AxisState> states = axis_states(sampled, task.machine.axes[i], static_cast<Eigen::Index>(i),
                                                      task.sample_period, still_speed(corner));
    sum.resize(states.size(), 0.0);
    for (std::size_t n = 0; n < states.size(); ++n) sum[n] += signed_value(states[n], LimitKind::power);
  }
  const LimitName& name = limit_name(limit.kind);
  const Json curve{{"name", "sum"}, {"bound", task.machine.*limit.bound}, {"values", drawn(std::move(sum))}};
  return {{"kind", name.name}, {"unit", name.unit}, {"axes", Json::array({curve})}};
}

/// Axes of the drawing: the machine's own if it has two, else the corner's plane, along the motion and halving the
/// angle.
void add_path(Json& view, const SampledMotion& motion, const TaskCorner& corner, const Task& task) {
  const Machine& machine = task.machine;
  const Corner& legs = corner.geometry();
  Eigen::VectorXd across = Eigen::VectorXd::Zero(legs.direction_in.size()), up = across;
  Json names{"along the motion", "towards the inside"};
  if (machine.axes.size() == 2) {
    across[0] = 1.0, up[1] = 1.0;
    names = {machine.axes[0].name, machine.axes[1].name};
  } else {
    const auto unit = [](const Eigen::VectorXd& v) {
      return v.norm() > 1e-9 ? Eigen::VectorXd(v / v.norm()) : Eigen::VectorXd(0.0 * v);
    };
    across = unit(legs.direction_in + legs.direction_out), up = unit(legs.direction_out - legs.direction_in);
  }
  constexpr double micrometres = 1e6;
  std::vector<double> x, y, off, speed;
  Json between = Json::array();
  const PathDistance path = path_distance(motion.position, legs);
  for (std::size_t i = 0; i < path.time.size(); ++i) {
    const double time = path.time[i], distance = micrometres * path.distance[i];
    if (time == std::floor(time))
      off.push_back(distance);
    else
      between.push_back({(time - static_cast<double>(motion.corner)) * task.sample_period * 1e3, distance});
  }
  for (Eigen::Index n = 0; n < motion.position.rows(); ++n) {
    const Eigen::VectorXd s = motion.position.row(n).transpose() * micrometres;
    x.push_back(s.dot(across)), y.push_back(s.dot(up));
    speed.push_back(motion.velocity.row(n).norm() * limit_name(LimitKind::velocity).per_si);
  }
  const auto flat = [&](const Eigen::VectorXd& u) { return Json{u.dot(across), u.dot(up)}; };
  view["path"] = {{"names", names},
                  {"x_um", drawn(std::move(x))},
                  {"y_um", drawn(std::move(y))},
                  {"in", flat(legs.direction_in)},
                  {"out", flat(legs.direction_out)},
                  {"off_um", drawn(std::move(off))},
                  {"between", std::move(between)}};  // ms, um: where the path is farther off than at both samples
  view["speed_mm_s"] = drawn(std::move(speed));
}

}  // namespace

Json view_json(const DesignResult& result, std::size_t index) {
  if (!result.filter || index >= result.corners.size()) throw std::invalid_argument("there is no such corner to draw");
  if (result.filter->order() >= longest_drawn)
    throw std::invalid_argument(fmt::format("a filter of more than {} taps is not drawn", longest_drawn));
  const Task& task = result.task;
  const TaskCorner& corner = task.corners[index];
  const SampledResponse sampled = simulate_response(*result.filter, corner.geometry(), result.corners[index].delay,
                                                    task.sample_period, task.machine, result.corners[index].feed_part);
  const SampledMotion& motion = sampled.motion();
  std::vector<double> time;
  for (Eigen::Index n = 0; n < motion.velocity.rows(); ++n)
    time.push_back(static_cast<double>(n - motion.corner) * task.sample_period * 1e3);
  Json view{{"name", corner.name},
            {"time_ms", drawn(std::move(time))},
            {"events", {{"start", motion.start}, {"blend", motion.corner}, {"stop", motion.stop}}}};
  add_path(view, motion, corner, task);
  view["quantities"] = Json::array();
  for (const AxisLimit& limit : axis_limits) {
    if (shown(limit, task.machine)) view["quantities"].push_back(quantity_json(limit, sampled, corner, task));
  }
  for (const SupplyLimit& limit : supply_limits) {
    if (task.machine.*limit.bound < unlimited) view["quantities"].push_back(supply_json(limit, sampled, corner, task));
  }
  return view;
}

}  // namespace accdec::explore
