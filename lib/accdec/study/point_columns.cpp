#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/baselines.hpp>
#include <accdec/motion/smallest_delay.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/slow_down.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec::study {
namespace {

constexpr std::string_view of_the_filter[] = {"delays", "given", "exact-stop", "slow-down"};

/// Twelve digits: what lies beyond is the rounding of unit conversions, and 59.00000000000001 ms reads badly.
Row number(double x) {
  if (!std::isfinite(x)) return nullptr;
  return std::stod(fmt::format("{:.12g}", x));
}

/// A filter whose name a study file gives must be in the task.
const FilterSpec& filter_of(const Task& task) {
  if (!task.filter) throw std::invalid_argument("the task has no [filter], which this computation needs");
  return *task.filter;
}

/// Delay of a lone corner as a number, several as "3 0 5".
Row delays_of(const DesignResult& result) {
  if (result.corners.empty()) return nullptr;
  if (result.corners.size() == 1) return result.corners.front().delay;
  std::string text;
  for (const CornerResult& corner : result.corners) text += fmt::format("{}{}", text.empty() ? "" : " ", corner.delay);
  return text;
}

class Writer {
 public:
  Writer(Row& row, std::string_view name) : row_(row), name_(name) {}
  void operator()(std::string_view column, Row value) { row_[fmt::format("{}.{}", name_, column)] = std::move(value); }

 private:
  Row& row_;
  std::string_view name_;
};

void write_result(Writer& write, const DesignResult& result) {
  write("status", std::string(to_string(result.status)));
  write("message", result.message);
  if (!result.filter) return;
  double error = 0.0, speed = unlimited;
  for (const CornerResult& corner : result.corners) {
    error = std::max(error, corner.corner_error);
    speed = std::min(speed, corner.speed_min);
  }
  write("cycle_time_ms", number(1e3 * result.cycle_time));
  write("corner_time_ms", number(1e3 * result.corner_time));
  write("order", result.filter->order());
  write("delay_samples", delays_of(result));
  write("error_um", number(1e6 * error));
  write("speed_min_mm_s", number(1e3 * speed));
  const auto worst =
      std::max_element(result.limits.begin(), result.limits.end(),
                       [](const LimitUse& a, const LimitUse& b) { return a.utilisation < b.utilisation; });
  if (worst != result.limits.end()) write("tightest", std::string(to_string(worst->kind)));
}

void write_bound(Writer& write, const DesignResult& result) {
  if (result.lower_bound) write("lower_bound_ms", number(1e3 * *result.lower_bound));
  if (result.gap) write("gap", number(*result.gap));
  write("stop", std::string(to_string(result.stop)));
}

/// Peaks that the task sets no limit for are of interest too, so they are measured against limits nobody reaches.
void write_peaks(Writer& write, const Task& task, const Filter& filter, const std::vector<int>& delays) {
  Machine machine = task.machine;
  for (Axis& axis : machine.axes) axis.acceleration_max = axis.jerk_max = 1e12;
  double acceleration = 0.0, jerk = 0.0;
  for (std::size_t j = 0; j < delays.size(); ++j) {
    for (const LimitUse& use :
         axis_utilisation(filter, task.corners[j].geometry(), delays[j], task.sample_period, machine)) {
      if (use.kind == LimitKind::acceleration) acceleration = std::max(acceleration, use.value);
      if (use.kind == LimitKind::jerk) jerk = std::max(jerk, use.value);
    }
  }
  write("peak_acceleration_mm_s2", number(1e3 * acceleration));
  write("peak_jerk_mm_s3", number(1e3 * jerk));
}

void write_slow_down(Writer& write, const Task& task) {
  const Filter filter = make_filter(filter_of(task));
  double lost = 0.0, least = 1.0;
  for (const TaskCorner& corner : task.corners) {
    const SlowDown s = slow_down(filter, corner.geometry(), task.sample_period, corner.error_max.value_or(unlimited));
    lost += corner.weight * s.lost_time;
    least = std::min(least, s.factor);
  }
  write("status", "feasible");
  const std::vector<int> none(task.corners.size(), 0);
  write("cycle_time_ms", number(1e3 * (cycle_time(task, filter.order(), none) + lost)));
  write("corner_time_ms", number(1e3 * (corner_time(task, filter.order(), none) + lost)));
  write("factor", number(least));
}

void compute(Writer& write, const Task& task, std::string_view name, const DesignOptions& options) {
  if (const Baseline* family = find_baseline(name)) {
    const BaselineResult best = best_baseline(task, *family);
    write_result(write, best.result);
    if (best.spec) write("parameters", describe_parameters(*best.spec));
  } else if (name == "optimum") {
    Task open = task;
    open.filter.reset();
    const DesignResult result = design_task(open, options);
    write_result(write, result);
    write_bound(write, result);
  } else if (name == "delays") {
    filter_of(task);
    const DesignResult result = design_delays(task, options);
    write_result(write, result);
    write_bound(write, result);
  } else if (name == "given" || name == "exact-stop") {
    const Filter filter = make_filter(filter_of(task));
    const int stop = DelayFinder(filter).exact_stop_delay();
    std::vector<int> delays;
    for (const TaskCorner& corner : task.corners) delays.push_back(name == "given" ? corner.delay.value_or(0) : stop);
    write_result(write, assess(task, filter, delays, name == "given"));
    if (name == "given") write_peaks(write, task, filter, delays);
  } else if (name == "slow-down") {
    write_slow_down(write, task);
  } else {
    throw std::invalid_argument(fmt::format("unknown computation `{}`", name));
  }
}

}  // namespace

std::vector<std::string_view> computations() {
  std::vector<std::string_view> names{"optimum"};
  for (const Baseline& family : baselines()) names.push_back(family.name);
  names.insert(names.end(), std::begin(of_the_filter), std::end(of_the_filter));
  return names;
}

bool needs_filter(std::string_view computation) {
  return std::find(std::begin(of_the_filter), std::end(of_the_filter), computation) != std::end(of_the_filter);
}

std::vector<std::string> columns_of(std::string_view computation) {
  std::vector<std::string_view> columns{"status",        "cycle_time_ms", "corner_time_ms", "order",
                                        "delay_samples", "error_um",      "speed_min_mm_s", "tightest"};
  if (computation == "slow-down") columns = {"status", "cycle_time_ms", "corner_time_ms", "factor"};
  if (find_baseline(computation)) columns.push_back("parameters");
  if (computation == "given") columns.insert(columns.end(), {"peak_acceleration_mm_s2", "peak_jerk_mm_s3"});
  if (computation == "optimum" || computation == "delays")
    columns.insert(columns.end(), {"lower_bound_ms", "gap", "stop"});
  columns.push_back("message");
  std::vector<std::string> names;
  for (const std::string_view column : columns) names.push_back(fmt::format("{}.{}", computation, column));
  return names;
}

void compute_into(Row& row, const Task& task, std::string_view computation, const DesignOptions& options) {
  for (const std::string& column : columns_of(computation)) row[column] = nullptr;
  Writer write(row, computation);
  try {
    compute(write, task, computation, options);
  } catch (const std::exception& error) {
    write("status", "error");
    write("message", std::string(error.what()));
  }
}

Row error_of(const Row& row, const std::vector<std::string>& computations) {
  const auto failed = [&](const std::string& name) { return row.at(name + ".status") == "error"; };
  if (!std::all_of(computations.begin(), computations.end(), failed)) return nullptr;
  return row.at(computations.front() + ".message");
}

Row best_shape_of(const Row& row) {
  double best = unlimited;
  std::string names;
  for (const Baseline& family : baselines()) {
    const auto time = row.find(fmt::format("{}.cycle_time_ms", family.name));
    if (time == row.end() || !time->is_number()) continue;
    const double t = time->get<double>();
    const bool ties = std::abs(t - best) <= 1e-9 * t;
    if (!ties && t > best) continue;
    names = ties ? fmt::format("{}={}", names, family.name) : std::string(family.name);
    best = std::min(best, t);
  }
  return names.empty() ? Row(nullptr) : Row(names);
}

}  // namespace accdec::study
