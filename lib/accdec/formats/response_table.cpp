#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <accdec/formats/response_table.hpp>
#include <accdec/machine/considered_by.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

using toml_input::Table;

/// @param least  what a caller has to consider for this key
void require_considered(const Table& table, std::string_view key, Considered considered,
                        Considered least = Considered::loads) {
  if (!table.has(key) || considered >= least) return;
  table.fail_at(key, fmt::format("`{}` is not considered here; {}", key, considered_by));
}

void require_end(const Table& table, const Axis& axis, double period) {
  const double length = response_length(axis.servo_gain, axis.velocity_feedforward, period);
  if (length <= response_taps_max) return;
  table.fail_at("servo_gain_1_s",
                fmt::format("`servo_gain_1_s` = {:g} settles in {:.0f} samples of {:g} ms; allowed are {}, with a "
                            "larger gain or a longer sample period",
                            axis.servo_gain, length, 1e3 * period, response_taps_max));
}

/// Behind no servo, the measured position would be the commanded one: its width then holds on no machine.
void require_measured(const Table& controller, const Task& task) {
  if (!task.settings || !task.settings->in_position_actual || !task.settings->names(DelayKind::in_position)) return;
  if (has_servo(task.machine)) return;
  std::string key = "in_position_of";
  if (!controller.has(key)) key = controller.has("name") ? "name" : "file";
  controller.fail_at(key,
                     "`in_position_of` = \"actual\", but no axis says how its measured position lags; give "
                     "servo_gain_1_s or response_taps in [[axis]], or in_position_of = \"command\" here");
}

}  // namespace

std::vector<Key> servo_keys() {
  std::vector<Key> keys;
  keys.push_back({.name = "servo_gain_1_s",
                  .meaning = "gain Kv of the position control, for the following error v (1 - feedforward) / Kv",
                  .unit = "1/s",
                  .range = {1.0, 1e4},
                  .fallback = "no following error",
                  .example = "200",
                  .allowed = "allowed is 1 <= servo_gain_1_s <= 10000; 1 (m/min)/mm is 16.67 1/s, 1 1/ms is 1000 1/s"});
  keys.push_back({.name = "velocity_feedforward",
                  .meaning = "with `servo_gain_1_s`: part of the velocity that is fed forward",
                  .range = {0.0, 1.0},
                  .fallback = "0",
                  .example = "0.9",
                  .allowed = "allowed is 0 <= velocity_feedforward <= 1; 95 % is 0.95"});
  keys.push_back({.name = "response_taps",
                  .type = KeyType::numbers,
                  .meaning = "instead of `servo_gain_1_s`: measured response to a velocity of one sample, of sum 1",
                  .range = {-10.0, 10.0},
                  .most = response_taps_max,
                  .fallback = "none",
                  .example = "[0.1, 0.5, 0.3, 0.1]"});
  return keys;
}

std::vector<double> read_response(const Table& table, std::string_view key) {
  std::vector<double> taps = table.numbers(key);
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  if (!taps.empty() && !(std::abs(sum - 1.0) < 1e-6))
    table.fail_at(key, fmt::format("`{}` has the sum {:.10g}; allowed is 1, so that the motion ends where the command "
                                   "does",
                                   key, sum));
  // A servo that overshoots threefold, or first goes the other way by a whole step, is none.
  constexpr double least = -1.0, most = 3.0;
  double step = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    step += taps[i];
    if (step >= least && step <= most) continue;
    table.fail_at(key, fmt::format("`{}` give a motion of {:.4g} times the velocity {} samples after it is commanded; "
                                   "allowed are {:g} to {:g} times",
                                   key, step, i + 1, least, most));
  }
  return taps;
}

void read_control(const Table& table, Machine& machine) {
  machine.prefilter_taps = read_response(table, "prefilter_taps");
  machine.position_unit = table.number("position_unit_um").value_or(0.0);
}

void read_servo(const Table& table, Axis& axis) {
  axis.servo_gain = table.number("servo_gain_1_s").value_or(unlimited);
  axis.velocity_feedforward = table.number("velocity_feedforward").value_or(0.0);
  axis.response_taps = read_response(table, "response_taps");
  if (table.has("response_taps")) {
    for (const std::string_view key : {"servo_gain_1_s", "velocity_feedforward"}) {
      if (table.has(key))
        table.fail_at(key, fmt::format("`{}` and `response_taps` are both given; allowed is either the gain or the "
                                       "measured response",
                                       key));
    }
  }
  if (table.has("velocity_feedforward") && !table.has("servo_gain_1_s"))
    table.fail_at("velocity_feedforward", "`velocity_feedforward` goes with `servo_gain_1_s`; give the gain as well");
}

void check_response(const Table& top, const Task& task, Considered considered) {
  if (const auto controller = top.table("controller")) {
    require_considered(*controller, "prefilter_taps", considered, Considered::smoothing);
    require_considered(*controller, "in_position_latency_ms", considered, Considered::all);
    if (considered < Considered::all && task.settings && task.settings->in_position_latency > 0.0)
      controller->fail_at(controller->has("name") ? "name" : "file",
                          "its `in_position_latency_ms` is not considered here; add `in_position_latency_ms = 0`");
    require_measured(*controller, task);
  }
  if (const auto machine = top.table("machine")) {
    for (const SupplyLimit& limit : supply_limits) require_considered(*machine, limit.key, considered);
  }
  for (const Table& mode : top.tables("mode")) require_considered(mode, "residual_max_um", considered);
  const std::vector<Table> tables = top.tables("axis");
  for (std::size_t i = 0; i < tables.size() && i < task.machine.axes.size(); ++i) {
    const Axis& axis = task.machine.axes[i];
    if (axis.servo_gain < unlimited) require_end(tables[i], axis, task.sample_period);
    require_considered(tables[i], "coulomb_N", considered);
    for (const std::string_view curve : {force_speed_key, torque_speed_key})
      require_considered(tables[i], curve, considered);
    require_considered(tables[i], "servo_gain_1_s", considered);
    require_considered(tables[i], "response_taps", considered);
  }
}

}  // namespace accdec
