#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/differing_servos.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The task with one servo for all axes, without its negative taps.
Task with_servo_of(const Task& task, std::size_t axis) {
  Task common = task;
  Axis servo = task.machine.axes[axis];
  for (double& tap : servo.response_taps) tap = std::max(0.0, tap);
  const double sum = std::accumulate(servo.response_taps.begin(), servo.response_taps.end(), 0.0);
  for (double& tap : servo.response_taps) tap /= sum;
  for (Axis& other : common.machine.axes) {
    other.servo_gain = servo.servo_gain, other.velocity_feedforward = servo.velocity_feedforward;
    other.response_taps = servo.response_taps;
  }
  return common;
}

/// Finds delays with which a filter holds the task: those given, longer together until it does, then each as short as
/// it can be while the others stay.
class HeldDelays {
 public:
  HeldDelays(const Task& task, const Filter& filter, const std::function<bool()>& stopped)
      : task_(task), filter_(filter), stopped_(stopped) {}

  std::optional<DesignResult> from(std::vector<int> delays) {
    const int most = filter_.order() + Response(task_.machine, task_.sample_period).order() + 3;
    int more = 0, step = 1;
    for (; !holds(longer(delays, more)); more += step, step = std::min(2 * step, 8)) {
      if (more > most || stopped_()) return {};
    }
    delays = longer(delays, more);
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (task_.corners[j].delay) continue;
      for (int less = std::max(1, more); less > 0 && !stopped_(); less /= 2) {
        for (std::vector<int> next = delays; next[j] >= less && !stopped_(); delays = next) {
          next[j] -= less;
          if (!holds(next)) break;
        }
      }
    }
    return assess(task_, filter_, delays, false);
  }

 private:
  std::vector<int> longer(std::vector<int> delays, int more) const {
    for (std::size_t j = 0; j < delays.size(); ++j) delays[j] = task_.corners[j].delay.value_or(delays[j] + more);
    return delays;
  }
  bool holds(const std::vector<int>& delays) const {
    return assess(task_, filter_, delays, false).status == Status::feasible;
  }

  const Task& task_;
  const Filter& filter_;
  const std::function<bool()>& stopped_;
};

}  // namespace

DesignResult design_differing(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const std::size_t axes = task.machine.axes.size();
  const std::function<bool()> stopped = [&] {
    return seconds_since(began) > options.time_limit || (options.cancel != nullptr && options.cancel->load());
  };
  DesignResult best;
  best.task = task;
  best.message = "no design was found for axes with different servos";
  for (std::size_t a = 0; a < axes && !stopped(); ++a) {
    DesignOptions part = options;
    part.exact.certificate = false;
    part.time_limit = (options.time_limit - seconds_since(began)) / (static_cast<double>(axes - a) + 1.0);
    const DesignResult common = design_task(with_servo_of(task, a), part);
    best.solver = common.solver;
    if (!common.has_design()) continue;
    std::vector<int> delays;
    for (const CornerResult& corner : common.corners) delays.push_back(corner.delay);
    std::optional<DesignResult> held = HeldDelays(task, *common.filter, stopped).from(delays);
    if (!held || !held->has_design() || (best.has_design() && held->objective() >= best.objective())) continue;
    best = std::move(*held);
    best.solver = common.solver;
    best.message = "axes respond differently: verified, and not proved to be the fastest";
  }
  if (stopped())
    best.stop = seconds_since(began) > options.time_limit ? StopReason::time_limit : StopReason::interrupted;
  return best;
}

}  // namespace accdec
