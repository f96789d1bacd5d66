#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/corner.hpp>
#include <accdec/family.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/slow_down.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec::study {

using batch::number;
namespace {

constexpr std::string_view of_the_filter[] = {"delays", "given", "exact-stop", "slow-down"};

/// A computation that uses the task's filter needs one in the task.
const FilterSpec& filter_of(const Task& task) {
  if (!task.filter) throw std::invalid_argument("the task has no [filter], which this computation needs");
  return *task.filter;
}

/// Delay of a single corner as a number, several delays as "3 0 5".
Row delays_of(const DesignResult& result) {
  if (result.corners.empty()) return nullptr;
  if (result.corners.size() == 1) return result.corners.front().delay;
  std::string text;
  for (const CornerResult& corner : result.corners) text += fmt::format("{}{}", text.empty() ? "" : " ", corner.delay);
  return text;
}

/// Result of a computation at one point.
struct PointOutcome {
  DesignResult result;
  std::optional<FilterSpec> family_member;  ///< for a family of filters
  double slowed_to = 1.0;                   ///< part of the feed, if corners are slowed down
  double peak_acceleration = 0.0;           ///< m/s^2, of a given filter
  double peak_jerk = 0.0;                   ///< m/s^3
};

bool has_all(std::string_view computation) {
  return computation != "slow-down";
}
bool has_proof(std::string_view computation) {
  return computation == "optimum" || computation == "delays";
}

Row optional_number(const std::optional<double>& x, double unit) {
  return x ? number(unit * *x) : Row(nullptr);
}

Row error_um(const PointOutcome& o) {
  double error = 0.0;
  for (const CornerResult& corner : o.result.corners) error = std::max(error, corner.corner_error);
  return number(1e6 * error);
}

Row speed_min_mm_s(const PointOutcome& o) {
  double speed = unlimited;
  for (const CornerResult& corner : o.result.corners) speed = std::min(speed, corner.speed_min);
  return number(1e3 * speed);
}

Row tightest(const PointOutcome& o) {
  const std::vector<LimitUse>& limits = o.result.limits;
  const auto worst = std::max_element(
      limits.begin(), limits.end(), [](const LimitUse& a, const LimitUse& b) { return a.utilisation < b.utilisation; });
  return worst == limits.end() ? Row(nullptr) : Row(std::string(to_string(worst->kind)));
}

struct ColumnDefinition {
  PointColumn column;
  bool needs_design;  ///< null if no filter was found
  bool (*has)(std::string_view computation);
  Row (*value)(const PointOutcome& o);
};

const ColumnDefinition definitions[] = {
    {{"status", "", true},
     false,
     [](std::string_view) { return true; },
     [](const PointOutcome& o) { return Row(std::string(to_string(o.result.status))); }},
    {{"cycle_time_ms", "ms"},
     true,
     [](std::string_view) { return true; },
     [](const PointOutcome& o) { return number(1e3 * o.result.cycle_time); }},
    {{"corner_time_ms", "ms"},
     true,
     [](std::string_view) { return true; },
     [](const PointOutcome& o) { return number(1e3 * o.result.corner_time); }},
    {{"order", ""}, true, has_all, [](const PointOutcome& o) { return Row(o.result.filter->order()); }},
    {{"delay_samples", "samples"}, true, has_all, [](const PointOutcome& o) { return delays_of(o.result); }},
    {{"error_um", "um"}, true, has_all, error_um},
    {{"speed_min_mm_s", "mm/s"}, true, has_all, speed_min_mm_s},
    {{"tightest", "", true}, true, has_all, tightest},
    {{"factor", ""},
     true,
     [](std::string_view name) { return name == "slow-down"; },
     [](const PointOutcome& o) { return number(o.slowed_to); }},
    {{"parameters", "", true},
     false,
     [](std::string_view name) { return find_family(name) != nullptr; },
     [](const PointOutcome& o) {
       return o.family_member ? Row(describe_parameters(*o.family_member, Digits::all)) : Row(nullptr);
     }},
    {{"peak_acceleration_mm_s2", "mm/s^2"},
     true,
     [](std::string_view name) { return name == "given"; },
     [](const PointOutcome& o) { return number(1e3 * o.peak_acceleration); }},
    {{"peak_jerk_mm_s3", "mm/s^3"},
     true,
     [](std::string_view name) { return name == "given"; },
     [](const PointOutcome& o) { return number(1e3 * o.peak_jerk); }},
    {{"lower_bound_ms", "ms"},
     false,
     has_proof,
     [](const PointOutcome& o) { return optional_number(o.result.lower_bound, 1e3); }},
    {{"gap", ""}, false, has_proof, [](const PointOutcome& o) { return optional_number(o.result.gap, 1.0); }},
    {{"stop", "", true},
     false,
     has_proof,
     [](const PointOutcome& o) { return Row(std::string(to_string(o.result.stop))); }},
    {{"message", "", true},
     false,
     [](std::string_view) { return true; },
     [](const PointOutcome& o) { return Row(o.result.message); }},
};

std::string column_name(std::string_view computation, std::string_view column) {
  return fmt::format("{}.{}", computation, column);
}

/// Peaks without a limit in the task are measured too, against limits that nothing reaches.
void find_peaks(PointOutcome& o, const Task& task, const Filter& filter, const std::vector<int>& delays) {
  Machine machine = task.machine;
  for (Axis& axis : machine.axes) axis.acceleration_max = axis.jerk_max = 1e12;
  const Filter command = Response(machine, task.sample_period).command(filter);
  for (std::size_t j = 0; j < delays.size(); ++j) {
    for (const LimitUse& use :
         axis_utilisation(command, task.corners[j].geometry(), delays[j], task.sample_period, machine)) {
      if (use.kind == LimitKind::acceleration) o.peak_acceleration = std::max(o.peak_acceleration, use.value);
      if (use.kind == LimitKind::jerk) o.peak_jerk = std::max(o.peak_jerk, use.value);
    }
  }
}

PointOutcome slowed_down(const Task& task) {
  require_no_shared_loads(task.machine, "slow-down");
  PointOutcome o;
  o.result.filter = make_filter(filter_of(task));
  const FilterBehind behind(*o.result.filter, task.machine, task.sample_period);
  double lost = 0.0;
  for (const TaskCorner& corner : task.corners) {
    // Both distances fall with the feed: at the one that the contour allows, the error is that part of its own.
    const CornerMeasures fast = measure(behind, corner.geometry(), 0, task.sample_period);
    double allowed = corner.error_max.value_or(unlimited);
    if (corner.contour_max && fast.contour_deviation > *corner.contour_max)
      allowed = std::min(allowed, fast.corner_error * *corner.contour_max / fast.contour_deviation);
    const SlowDown s = slow_down(behind, corner.geometry(), task.sample_period, allowed);
    lost += corner.weight * s.lost_time;
    o.slowed_to = std::min(o.slowed_to, s.factor);
  }
  const std::vector<int> none(task.corners.size(), 0);
  o.result.status = Status::feasible;
  o.result.cycle_time = cycle_time(task, o.result.filter->order(), none) + lost;
  o.result.corner_time = corner_time(task, o.result.filter->order(), none) + lost;
  return o;
}

/// With the same delay at every corner: the smallest delay at which legs do not overlap. If the last tap of one leg and
/// the first tap of the next together break a limit, it is a sample or two larger. Then their forces and jerks do not
/// overlap either. Behind a servo the command stops exactly, not the motion.
DesignResult exact_stop(const Task& task, const Filter& filter) {
  const Filter command = Response(task.machine, task.sample_period).command(filter);
  const int apart = DelayFinder(command).exact_stop_delay();
  DesignResult result;
  for (int d = apart; d <= apart + 2 && !result.filter; ++d) {
    result = assess(task, filter, std::vector<int>(task.corners.size(), d), false);
  }
  return result;
}

PointOutcome compute(const Task& task, std::string_view name, const DesignOptions& options) {
  PointOutcome o;
  if (const Family* family = find_family(name)) {
    FamilyResult best = best_member(task, *family);
    o.result = std::move(best.result);
    o.family_member = best.spec;
  } else if (name == "optimum") {
    Task open = task;
    open.filter.reset();
    o.result = design_task(open, options);
  } else if (name == "delays") {
    filter_of(task);
    o.result = design_delays(task, options);
  } else if (name == "given" || name == "exact-stop") {
    const Filter filter = make_filter(filter_of(task));
    if (name == "exact-stop") {
      o.result = exact_stop(task, filter);
    } else {
      std::vector<int> delays;
      for (const TaskCorner& corner : task.corners) delays.push_back(corner.delay.value_or(0));
      o.result = assess(task, filter, delays, true);
      find_peaks(o, task, filter, delays);
    }
  } else if (name == "slow-down") {
    o = slowed_down(task);
  } else {
    throw std::invalid_argument(fmt::format("unknown computation `{}`", name));
  }
  return o;
}

}  // namespace

std::vector<std::string_view> computations() {
  std::vector<std::string_view> names{"optimum"};
  for (const Family& family : families()) names.push_back(family.name);
  names.insert(names.end(), std::begin(of_the_filter), std::end(of_the_filter));
  return names;
}

std::string computation_title(std::string_view computation) {
  if (computation == "optimum") return "designed";
  const Family* family = find_family(computation);
  return family == nullptr ? std::string(computation) : family->title;
}

bool needs_filter(std::string_view computation) {
  return std::find(std::begin(of_the_filter), std::end(of_the_filter), computation) != std::end(of_the_filter);
}

const PointColumn* find_point_column(std::string_view column) {
  const std::size_t dot = column.rfind('.');
  if (dot == std::string_view::npos) return nullptr;
  const std::string_view last = column.substr(dot + 1);
  const auto found = std::find_if(std::begin(definitions), std::end(definitions),
                                  [&](const ColumnDefinition& d) { return d.column.name == last; });
  return found == std::end(definitions) ? nullptr : &found->column;
}

std::vector<std::string> columns_of(std::string_view computation) {
  std::vector<std::string> names;
  for (const ColumnDefinition& d : definitions) {
    if (d.has(computation)) names.push_back(column_name(computation, d.column.name));
  }
  return names;
}

void compute_into(Row& row, const Task& task, std::string_view computation, const DesignOptions& options) {
  for (const std::string& column : columns_of(computation)) row[column] = nullptr;
  try {
    const PointOutcome outcome = compute(task, computation, options);
    for (const ColumnDefinition& d : definitions) {
      if (!d.has(computation) || (d.needs_design && !outcome.result.filter)) continue;
      row[column_name(computation, d.column.name)] = d.value(outcome);
    }
  } catch (const std::exception& error) {
    row[column_name(computation, "status")] = "error";
    row[column_name(computation, "message")] = std::string(error.what());
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
  for (const Family& family : families()) {
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
