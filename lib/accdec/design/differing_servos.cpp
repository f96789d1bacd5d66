#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/differing_servos.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/conflict.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The task with one servo for all axes, without its negative taps.
Task with_servo_of(const Task& task, std::size_t axis) {
  Task common = task;
  const Axis servo = averaging(task.machine.axes[axis]);
  for (Axis& other : common.machine.axes) {
    other.servo_gain = servo.servo_gain, other.velocity_feedforward = servo.velocity_feedforward;
    other.response_taps = servo.response_taps;
  }
  return common;
}

/// The best of several designs, each with the smallest delays that its filter has with the axes as they are.
class BestOf {
 public:
  explicit BestOf(const Task& task) { best_.task = task; }

  void offer(const DesignResult& found, double seconds, const std::atomic<bool>* cancel) {
    if (best_.solver.name.empty()) best_.solver = found.solver;
    if (found.stop != StopReason::finished && found.stop != StopReason::gap_reached) stop_ = found.stop;
    if (!found.has_design()) return;
    Task given = best_.task;
    const auto taps = found.filter->taps();
    given.filter = FilterSpec{.kind = Shape::taps, .taps = {taps.begin(), taps.end()}};
    DesignOptions rest;
    rest.time_limit = std::max(1e-3, seconds), rest.cancel = cancel;
    std::vector<int> delays;
    for (const CornerResult& corner : design_delays(given, rest).corners) delays.push_back(corner.delay);
    if (delays.size() != best_.task.corners.size()) return;
    DesignResult held = assess(best_.task, *found.filter, delays, false);
    if (!held.has_design() || (best_.has_design() && held.objective() >= best_.objective() * (1.0 - 1e-12))) return;
    held.solver = found.solver;
    best_ = std::move(held);
  }
  DesignResult best() const {
    DesignResult best = best_;
    best.stop = stop_;
    return best;
  }

 private:
  DesignResult best_;
  StopReason stop_ = StopReason::finished;  // of any search that ended early
};

DesignResult search(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  const auto left = [&] { return options.time_limit - seconds_since(began); };
  const auto stopped = [&] { return left() <= 0.0 || (options.cancel != nullptr && options.cancel->load()); };
  BestOf designs(task);
  // A gap this wide asks only whether there is a design.
  const auto enough = [&] { return stopped() || (options.exact.gap > 0.9 && designs.best().has_design()); };
  const std::size_t axes = task.machine.axes.size();
  for (std::size_t a = 0; a < axes && !enough(); ++a) {
    DesignOptions part = options;
    part.exact.certificate = false;
    part.time_limit = left() / (static_cast<double>(axes - a) + 2.0);
    designs.offer(design_task(with_servo_of(task, a), part), left(), options.cancel);
  }
  // Nonlinear solvers know every axis' own servo.
  if (!enough()) {
    DesignOptions local = options;
    local.method = Method::nlp, local.time_limit = 0.8 * left();
    try {
      designs.offer(design_nlp(task, local), left(), options.cancel);
    } catch (const std::invalid_argument&) {  // the solver refuses, or is unknown here
    } catch (const std::runtime_error&) {     // it is not installed
    }
  }
  // Designs for one servo may all fail behind the others. Two averages are tried with the servos as they are.
  if (!stopped() && !designs.best().has_design()) {
    const DesignResult averages = best_member(task, *find_family("trapezoid"), left()).result;
    designs.offer(averages, left(), options.cancel);
  }
  DesignResult best = designs.best();
  if (stopped()) best.stop = left() <= 0.0 ? StopReason::time_limit : StopReason::interrupted;
  return best;
}

/// Limits such that, without any one of them, a search finds a design. Limits that the time does not suffice for may be
/// among them.
/// @param seconds  for all searches
std::string conflict_text(const Task& task, const DesignOptions& options, double seconds) {
  const auto began = std::chrono::steady_clock::now();
  bool in_time = true;
  const auto has_design = [&](const Task& without) {
    DesignOptions quick = options;
    quick.progress = nullptr, quick.nlp.improved = nullptr;
    quick.exact.gap = 1.0;
    quick.time_limit = std::min(0.3 * seconds, seconds - seconds_since(began));
    const bool cancelled = options.cancel != nullptr && options.cancel->load();
    in_time = in_time && quick.time_limit > 0.0 && !cancelled;
    return !in_time || search(without, quick).has_design();
  };
  const std::vector<std::string> limits = limits_in_conflict(task, false, has_design);
  if (limits.empty()) return "";
  return fmt::format("; limits in conflict (by search, not proved): {}{}", in_time ? "" : "some of ",
                     fmt::join(limits, ", "));
}

}  // namespace

DesignResult design_differing(const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  DesignResult best = search(task, options);
  const bool differ = servos_differ(task.machine);
  if (best.has_design())
    best.message = differ ? "axes respond differently: verified, and not proved to be the fastest"
                          : "response_taps has negative taps: verified, and not proved to be the fastest";
  else
    best.message = differ ? "no design was found for axes with different servos; there may be one"
                          : "no design was found behind response_taps with negative taps; there may be one";
  if (!best.has_design() && options.exact.gap < 0.9)
    best.message += conflict_text(task, options, options.time_limit - seconds_since(began));
  return best;
}

}  // namespace accdec
