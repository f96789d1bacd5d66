#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/design_settings.hpp>
#include <accdec/design/verify_today.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The delays that the control can give, samples, rising. @param longest  longer ones change nothing
std::vector<int> delays_to_try(const Task& task, const TaskCorner& corner, int order, int longest) {
  std::vector<int> delays;
  if (corner.delay) return {*corner.delay};
  const auto& control = task.settings;
  if (!control || control->any_delay()) {
    for (int d = 0; d <= longest; ++d) delays.push_back(d);
    return delays;
  }
  if (control->names(DelayKind::continuous)) delays.push_back(0);
  const int apart = order + std::max(0, static_cast<int>(task.machine.prefilter_taps.size()) - 1);
  if (control->names(DelayKind::exact_stop)) delays.insert(delays.end(), {apart, apart + 1});
  return delays;
}

/// s; none: no such delays hold.
std::optional<double> time_of_today(const Task& task) {
  const Filter filter = make_filter(*task.baseline);
  const int longest = filter.order() + Response(task.machine, task.sample_period).order() + 2;
  double samples = task.design.objective == Objective::cycle ? task.design.runs * (filter.order() + 1) : 0.0;
  std::vector<int> chosen;
  for (const TaskCorner& corner : task.corners) {
    const Task alone = corner_alone(task, corner);
    const std::vector<int> delays = delays_to_try(task, corner, filter.order(), longest);
    const auto holds = [&](int d) { return verify_by_simulation(alone, filter, {d}).feasible; };
    const auto first = std::find_if(delays.begin(), delays.end(), holds);
    if (first == delays.end()) return std::nullopt;
    chosen.push_back(*first);
    samples += corner.weight * (*first + (task.design.objective == Objective::cycle ? 0 : filter.order() + 1));
  }
  if (!verify_by_simulation(task, filter, chosen).feasible) return std::nullopt;
  return samples * task.sample_period;
}

}  // namespace

void check_savings_recorded(const DesignResult& result, std::vector<std::string>& reasons) {
  if (result.savings || !result.settings || !result.task.baseline) return;
  DesignResult again;
  again.task = result.task;
  compare_with_today(again);
  if (!again.savings) return;
  reasons.push_back(
      fmt::format("savings are not recorded; with today's filter the task takes {:.9g} s", again.savings->today));
}

bool knows_delays_of_today(const Task& task) {
  constexpr double most_steps = 1e7;
  const auto& control = task.settings;
  if (!task.baseline) return false;
  const double samples = task.baseline->full_order() + 1.0;
  // Each delay of each corner is a simulation of about so many samples.
  if (samples * samples * static_cast<double>(task.corners.size()) > most_steps) return false;
  return !control || !(control->names(DelayKind::in_position) || control->names(DelayKind::corner_feed));
}

void check_time_of_today(const Task& task, double recorded, std::vector<std::string>& reasons) {
  constexpr double tolerance = 1e-9;
  if (!knows_delays_of_today(task)) return;
  const auto own = time_of_today(task);
  if (!own)
    reasons.push_back("savings.today_s is recorded, but today's filter holds at no delay of the control");
  else if (std::abs(recorded - *own) > tolerance * *own)
    reasons.push_back(
        fmt::format("savings.today_s is recorded as {:.9g}, delay by delay it is {:.9g}", recorded, *own));
}

}  // namespace accdec
