#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <accdec/formats/response_table.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

using toml_input::Table;

void require_considered(const Table& table, std::string_view key, Considered considered) {
  if (!table.has(key) || considered != Considered::none) return;
  table.fail_at(key, fmt::format("`{}` is not considered here; leave it out, or use `accdec evaluate`, `accdec "
                                 "design`, `accdec explain` or `accdec verify`, which consider it",
                                 key));
}

void require_end(const Table& table, const Axis& axis, double period) {
  const double length = response_length(axis.servo_gain, axis.velocity_feedforward, period);
  if (length <= response_taps_max) return;
  table.fail_at("servo_gain_1_s",
                fmt::format("`servo_gain_1_s` = {:g} settles in {:.0f} samples of {:g} ms; allowed are {}, with a "
                            "larger gain or a longer sample period",
                            axis.servo_gain, length, 1e3 * period, response_taps_max));
}

/// One response of all axes, without negative taps.
void require_common(const Table& table, const Axis& axis, const Axis& first) {
  const auto refuse = [&](std::string_view key) {
    table.fail_at(key, fmt::format("`{}` of axis {} is not that of axis {}; a design needs one response of all axes, "
                                   "`accdec evaluate` judges a given filter with any",
                                   key, axis.name, first.name));
  };
  if (axis.servo_gain != first.servo_gain) refuse("servo_gain_1_s");
  if (axis.velocity_feedforward != first.velocity_feedforward) refuse("velocity_feedforward");
  if (axis.response_taps != first.response_taps) refuse("response_taps");
  if (std::any_of(axis.response_taps.begin(), axis.response_taps.end(), [](double tap) { return tap < 0.0; })) {
    table.fail_at("response_taps",
                  "`response_taps` has a negative tap; a design needs taps >= 0, `accdec evaluate` judges a given "
                  "filter with any");
  }
}

}  // namespace

std::vector<double> read_response(const Table& table, std::string_view key) {
  std::vector<double> taps = table.numbers(key);
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  if (!taps.empty() && !(std::abs(sum - 1.0) < 1e-6))
    table.fail_at(key, fmt::format("`{}` has the sum {:.10g}; allowed is 1, so that the motion ends where the command "
                                   "does",
                                   key, sum));
  return taps;
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
  if (const auto controller = top.table("controller")) require_considered(*controller, "prefilter_taps", considered);
  const std::vector<Table> tables = top.tables("axis");
  for (std::size_t i = 0; i < tables.size() && i < task.machine.axes.size(); ++i) {
    const Axis& axis = task.machine.axes[i];
    if (axis.servo_gain < unlimited) require_end(tables[i], axis, task.sample_period);
    require_considered(tables[i], "servo_gain_1_s", considered);
    require_considered(tables[i], "response_taps", considered);
    if (considered == Considered::common) require_common(tables[i], axis, task.machine.axes.front());
  }
}

}  // namespace accdec
