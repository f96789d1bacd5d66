#include <algorithm>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <accdec/files/refused_key.hpp>
#include <accdec/machine/considered_by.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/run/refused_keys.hpp>

namespace accdec {
namespace {

[[noreturn]] void refuse(const std::string& what, const char* key) {
  throw RefusedKey("plan free " + what, {key});
}

}  // namespace

void require_fixed(const Task& task, const Machine& machine, bool filter_bound) {
  if (!has_servo(machine)) return;
  if (task.settings && task.settings->in_position_actual)
    throw RefusedKey(
        "a program does not consider [controller] `in_position_of` = \"actual\" behind a servo; write \"command\"",
        {"in_position_of", "name", "file"});
  if (filter_bound)
    throw std::invalid_argument("--filter-bound is for motions without a servo (servo_gain_1_s, response_taps)");
}

void require_positions(const Task& task, const char* plan) {
  require_no_response(task.machine, plan, considered_by_fixed);
  require_no_shared_loads(task.machine, plan, considered_by_fixed);
  if (!task.settings || (!task.settings->names_family() && !limits_taps(*task.settings))) return;
  throw RefusedKey(
      fmt::format("{} gives every sample a position, and the task's control has one filter for the whole program "
                  "([design] family, [controller] delays, or the controller's); use --plan fixed, or leave it out",
                  plan),
      {"family", "delays", "controller"});
}

void require_free(const Task& task, const Toolpath& path) {
  constexpr const char* others = "use --plan profiles or fixed, or leave it out";
  for (const Mode& mode : task.machine.modes) {
    if (mode.residual_max < 1.0)
      refuse(fmt::format("keeps no vibration bound: `residual_max` of [[mode]]; {}", others), "residual_max");
  }
  const Machine machine = program_machine(task.machine, path);
  if (machine.axes.empty())
    refuse("needs limits of the axes: [[axis]] with an acceleration; or use --plan profiles or fixed", "axis");
  for (const Axis& axis : machine.axes) {
    if (axis.power_max < unlimited)
      refuse(fmt::format("keeps no limit of power: `power_max_W` (axis {}); {}", axis.name, others), "power_max_W");
    if (axis.regeneration_max < unlimited) {
      refuse(fmt::format("keeps no limit of regeneration: `regeneration_max_W` (axis {}); {}", axis.name, others),
             "regeneration_max_W");
    }
    if (!(axis.acceleration_max < unlimited) && !(axis.force_max < unlimited && axis.mass > 0.0)) {
      refuse(fmt::format("needs a limit of acceleration, or of force with a mass (axis {}); give one, or use --plan "
                         "profiles or fixed",
                         axis.name),
             "axis");
    }
  }
}

}  // namespace accdec
