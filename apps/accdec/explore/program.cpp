#include "program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/result/fastest_plan.hpp>
#include <accdec/plan/result/fixed_plan.hpp>
#include <accdec/plan/result/free_plan.hpp>
#include <accdec/plan/result/samples.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/program.hpp>

#include "machines.hpp"
#include "requests.hpp"

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t most_points = 12'000;  ///< of a motion, as drawn
constexpr std::size_t most_program_corners = 5'000;
constexpr double mm = 1e3, um = 1e6, mm_min = 6e4;

/// Four digits behind the mm: 0.1 um can be seen nowhere.
double rounded(double x) {
  return std::round(1e4 * x) / 1e4;
}

double rounded_to(double x, double step) {
  return std::round(x / step) * step;
}

/// Acceleration and jerk of one axis from its velocities, the largest since they were taken last.
class Differences {
 public:
  explicit Differences(double period) : period_(period) {}
  void add(double velocity, bool rested) {
    const double acceleration = (velocity - velocity_) / period_;
    const double jerk = (acceleration - (rested ? 0.0 : acceleration_)) / period_;
    velocity_ = velocity, acceleration_ = acceleration;
    if (std::abs(acceleration) > std::abs(most_acceleration_)) most_acceleration_ = acceleration;
    if (std::abs(jerk) > std::abs(most_jerk_)) most_jerk_ = jerk;
  }
  double take_acceleration() { return rounded_to(mm * std::exchange(most_acceleration_, 0.0), 0.1); }
  double take_jerk() { return rounded_to(mm * std::exchange(most_jerk_, 0.0), 1.0); }

 private:
  double period_, velocity_ = 0.0, acceleration_ = 0.0, most_acceleration_ = 0.0, most_jerk_ = 0.0;
};

/// The bounds of every axis, null where there is none.
Json bounds_json(const Machine& machine, double Axis::*bound) {
  Json json = Json::array();
  for (const Axis& axis : machine.axes)
    json.push_back(axis.*bound < unlimited ? Json(mm * (axis.*bound)) : Json(nullptr));
  return json;
}

/// Every n-th sample: times, places, speeds and velocities, and the limit that bound most since the one before.
Json motion_json(const Toolpath& programmed, const Machine& machine, const ProgramResult& result) {
  const ProgramMotion motion = motion_of(result);
  const std::vector<std::int64_t> drawn = drawn_samples(motion, most_points);
  auto next = drawn.begin();
  std::vector<double> time, speed;
  std::vector<int> bound;
  std::vector<std::vector<double>> places(programmed.dimensions()), velocities(programmed.dimensions());
  std::vector<std::vector<double>> accelerations(programmed.dimensions()), jerks(programmed.dimensions());
  std::vector<Differences> differences(programmed.dimensions(), Differences(motion.sample_period));
  int binding = -1;
  std::int64_t before = -1;
  visit_velocities(machine, motion, [&](std::int64_t k, const double* at, const double* v, int binds) {
    binding = std::max(binding, binds);
    for (std::size_t a = 0; a < differences.size(); ++a) differences[a].add(v[a], k > before + 1);
    before = k;
    if (next == drawn.end() || k != *next) return;
    ++next;
    time.push_back(static_cast<double>(k) * motion.sample_period);
    for (std::size_t a = 0; a < places.size(); ++a) {
      places[a].push_back(rounded(mm * at[a]));
      velocities[a].push_back(rounded(mm * v[a]));
      accelerations[a].push_back(differences[a].take_acceleration());
      jerks[a].push_back(differences[a].take_jerk());
    }
    speed.push_back(rounded(mm * speed_of(v, places.size()))), bound.push_back(binding);
    binding = -1;
  });
  Json json{{"plan", result.plan.name()},
            {"cycle_time_s", result.cycle_time},
            {"t_s", time},
            {"speed_mm_s", speed},
            {"binds", bound},
            {"places_mm", places},
            {"velocities_mm_s", velocities},
            {"accelerations_mm_s2", accelerations},
            {"jerks_mm_s3", jerks},
            {"lost", Json::array()},
            {"bounds", bounds_to_json(bounds_of(result))}};
  for (const CornerLoss& loss : time_lost(programmed, motion))
    if (loss.count > 0)
      json["lost"].push_back({{"turn", class_name(loss)}, {"count", loss.count}, {"time_s", loss.time}});
  return json;
}

/// The page shows the way of the tool's tip.
ProgramFileOptions tip_options() {
  ProgramFileOptions options;
  options.tools.length = 0.0;
  return options;
}

/// The plans that hold, the fastest first, each with the bounds that `accdec program` prints beside it.
std::vector<ProgramResult> plans_of(const std::string& name, const ProgramFile& file, const Task& task,
                                    double free_seconds, const std::function<void(const std::string&)>& tell) {
  std::vector<ProgramResult> plans;
  std::optional<CornerBound> bound;
  if (file.path.blocks() <= several_plans_max && !has_servo(program_machine(task.machine, file.path)))
    bound = corner_bound_of(file.path, task);
  const double chords = file.reading.read.arc_tolerance;
  const auto add = [&](ProgramResult result) {
    if (result.verification.feasible)
      plans.push_back(std::move(result));
    else
      tell(result.message);
  };
  FixedPlan fixed{file, {}};
  fixed.result = run_fixed_plan(name, fixed.file, task, {}, tell);
  const bool fixed_holds = fixed.result.verification.feasible;
  if (bound && fixed_holds)
    fixed.result.corner_bound = corner_bound_as_read(*bound, chords, name, fixed.file, task, tip_options());
  add(fixed.result);
  try {
    ProgramResult profiles = plan_profiles_of(name, file.path, task);
    profiles.corner_bound = bound;
    add(std::move(profiles));
  } catch (const std::invalid_argument& error) {
    tell(error.what());  // a program with delays of its own, or vibration bounds that no last filter holds
  }
  if (free_seconds > 0.0) {
    ProgramFileOptions options;
    options.deadline = Deadline(free_seconds);
    ProgramFile copy = file;
    ProgramResult best =
        run_free_plan(name, copy, task, options, tell, fixed_holds ? std::optional(std::move(fixed)) : std::nullopt);
    // If no window gives way, the answer is the plan it began with.
    if (best.plan.trajectory() != nullptr && best.plan.trajectory()->is_free()) add(std::move(best));
  }
  std::stable_sort(plans.begin(), plans.end(),
                   [](const auto& a, const auto& b) { return a.cycle_time < b.cycle_time; });
  if (plans.empty()) throw std::runtime_error("no plan of this program holds all limits: accdec program says why");
  return plans;
}

Eigen::VectorXd direction(const Toolpath& path, std::size_t block) {
  const auto n = static_cast<Eigen::Index>(path.dimensions());
  const Eigen::Map<const Eigen::VectorXd> from(path.point(block), n), to(path.point(block + 1), n);
  return (to - from).normalized();
}

/// The feeds of one filter at the corners of a program, which a plan passes in their order. It may have chords of its
/// own, and joints inside blocks.
class PlannedFeeds {
 public:
  explicit PlannedFeeds(const Toolpath* plan) : plan_(plan) {}
  /// mm/min before and behind the joint after this block of the program; none where the plan has no such corner.
  std::optional<std::array<double, 2>> at(const Toolpath& path, std::size_t block) {
    for (std::size_t b = next_; plan_ != nullptr && b + 1 < plan_->blocks(); ++b) {
      if (plan_->line[b] != path.line[block] || plan_->joint[b] == Joint::straight || !same(path, block, b)) continue;
      next_ = b + 1;
      return std::array{rounded_down(block_feed(*plan_, b)), rounded_down(block_feed(*plan_, b + 1))};
    }
    return {};
  }

 private:
  /// To 0.001 mm/min, and no faster than planned.
  static double rounded_down(double feed) { return std::floor(1e3 * mm_min * feed + 1e-6) / 1e3; }
  bool same(const Toolpath& path, std::size_t block, std::size_t of_plan) const {
    const std::vector<double>& points = plan_->programmed.empty() ? plan_->points : plan_->programmed;
    const double* const planned = &points[(of_plan + 1) * path.dimensions()];
    return std::equal(planned, planned + path.dimensions(), path.point(block + 1),
                      [](double x, double y) { return std::abs(x - y) < 1e-9; });
  }

  const Toolpath* plan_;
  std::size_t next_ = 0;
};

/// Joints that turn, as corners of a task, and where they are: those that `accdec program` counts. They have the feeds
/// of plan fixed: a task has one filter, too, and the programmed feeds may be too fast for it.
/// @param fixed  its path; nullptr: that plan does not hold
Json corners_json(const Toolpath& path, const Toolpath* fixed) {
  PlannedFeeds planned(fixed);
  Json corners = Json::array();
  const auto list = [](const Eigen::VectorXd& v) { return std::vector<double>(v.begin(), v.end()); };
  for (std::size_t b = 0; b + 1 < path.blocks() && corners.size() < most_program_corners; ++b) {
    if (path.joint[b] == Joint::straight || path.inside_arc[b] != 0) continue;
    const Eigen::VectorXd in = direction(path, b), out = direction(path, b + 1);
    const double angle = 180.0 - std::acos(std::clamp(in.dot(out), -1.0, 1.0)) * 180.0 / M_PI;
    const std::array programmed{mm_min * block_feed(path, b), mm_min * block_feed(path, b + 1)};
    Json corner{{"name", "N" + std::to_string(path.line[b])},
                {"direction_in", list(in)},
                {"direction_out", list(out)},
                {"feed_in_mm_min", programmed[0]},
                {"feed_out_mm_min", programmed[1]}};
    const auto feeds = planned.at(path, b);
    if (feeds) corner["feed_in_mm_min"] = (*feeds)[0], corner["feed_out_mm_min"] = (*feeds)[1];
    // A motion that rests at the corner is one that a delay of the whole filter makes.
    const double tolerance = path.joint[b] == Joint::stop ? 0.0 : path.tolerance[b];
    if (tolerance < unlimited) corner["error_max_um"] = um * tolerance;
    std::vector<double> at(path.point(b + 1), path.point(b + 1) + path.dimensions());
    for (double& x : at) x = rounded(mm * x);
    corners.push_back({{"line", path.line[b]},
                       {"angle_deg", angle},
                       {"at_mm", at},
                       {"stop", path.joint[b] == Joint::stop},
                       {"programmed_mm_min", programmed},
                       {"planned", feeds.has_value()},
                       {"corner", std::move(corner)}});
  }
  return corners;
}

/// Corners that are passed before those where the program stops: a way back on itself is no task.
bool sharper(const Json& a, const Json& b) {
  if (a["stop"] != b["stop"]) return b["stop"].get<bool>();
  return a["angle_deg"] < b["angle_deg"];
}

/// The task of its corners by themselves: an axis for every column of the path, and the program's filter as today's.
Json base_of(Task task, const Toolpath& path) {
  task.machine.axes = program_machine(task.machine, path).axes;
  for (std::size_t a = 0; a < path.dimensions(); ++a) task.machine.axes[a].name = path.axis_name(a);
  Json json = task_to_json(task);
  json.erase("program");
  if (json.contains("filter")) {
    json["baseline"] = json["filter"];
    json.erase("filter");
  }
  return json;
}

/// The corner that turns most; where there is none, a task to begin with.
Task first_task(const Json& program, const std::string& name) {
  const Json& corners = program["corners"];
  if (corners.empty()) return parse_task(cli::machine_file(cli::first_machine).text, std::string(cli::first_machine));
  Json task = program["base"];
  task["corner"] = Json::array({(*std::min_element(corners.begin(), corners.end(), sharper))["corner"]});
  return parse_task_json(task.dump(), name, {.response = Considered::all});
}

}  // namespace

std::string program_start_json(const std::string& name, const Task& task, double free_seconds,
                               const std::function<void(const std::string&)>& tell) {
  const ProgramFile file = read_program_file(name, task, tip_options(), tell);
  const Toolpath& path = file.path;
  const Machine machine = program_machine(task.machine, path);
  Json program{{"name", name},
               {"axes", Json::array()},
               {"limits", Json::array()},
               {"colours", figure_style::colours},
               {"palette", figure_style::line_palette},
               {"velocity_max", bounds_json(machine, &Axis::velocity_max)},
               {"acceleration_max", bounds_json(machine, &Axis::acceleration_max)},
               {"jerk_max", bounds_json(machine, &Axis::jerk_max)},
               {"plans", Json::array()}};
  for (std::size_t a = 0; a < path.dimensions(); ++a) program["axes"].push_back(path.axis_name(a));
  for (std::size_t i = 0; i < axis_limits.size(); ++i) program["limits"].push_back(binding_name(static_cast<int>(i)));
  program["other"] = binding_name(-1);
  const std::vector<ProgramResult> plans = plans_of(name, file, task, free_seconds, tell);
  for (const ProgramResult& plan : plans) program["plans"].push_back(motion_json(path, machine, plan));
  const auto fixed =
      std::find_if(plans.begin(), plans.end(), [](const auto& p) { return p.plan.command() != nullptr; });
  program["corners"] = corners_json(path, fixed == plans.end() ? nullptr : &fixed->plan.path);
  program["base"] = base_of(task, path);
  std::string start = start_json(first_task(program, name), name);
  start.pop_back();  // its closing brace
  return start + ", \"program\": " + program.dump(-1, ' ', false, Json::error_handler_t::replace) + "}";
}

}  // namespace accdec::explore
