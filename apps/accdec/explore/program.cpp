#include "program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/program.hpp>

#include "drawn_program.hpp"
#include "machines.hpp"
#include "requests.hpp"

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_program_corners = 5'000;
constexpr double um = 1e6, mm_min = 6e4;

/// The bounds of every axis, null where there is none.
Json bounds_json(const Machine& machine, double Axis::*bound) {
  Json json = Json::array();
  for (const Axis& axis : machine.axes)
    json.push_back(axis.*bound < unlimited ? Json(mm * (axis.*bound)) : Json(nullptr));
  return json;
}

/// The page shows the way of the tool's tip.
ProgramFileOptions tip_options() {
  ProgramFileOptions options;
  options.tools.length = 0.0;
  return options;
}

struct Plans {
  std::vector<ProgramResult> holding;  ///< the fastest first, each with the bounds that `accdec program` prints
  std::vector<std::string> others;     ///< a sentence for each plan that is not among them, and why
};

/// The plans of a program. Each that holds all limits is kept.
class Planner {
 public:
  Planner(const ProgramFile& file, const Task& task, const std::function<void(const std::string&)>& tell)
      : file_(file), task_(task), tell_(tell) {
    if (file.path.blocks() <= several_plans_max && !has_servo(program_machine(task.machine, file.path)))
      bound_ = corner_bound_of(file.path, task);
  }

  void fixed() {
    ProgramResult plan = run_fixed_plan(file_, task_, {}, tell_);
    const bool holds = plan.verification.feasible;
    const double chords = file_.reading.read.arc_tolerance;
    if (holds && bound_) plan.corner_bound = corner_bound_as_read(*bound_, chords, plan, task_, tip_options());
    keep("fixed", plan);
    if (holds) fixed_ = std::move(plan);
  }
  void profiles() {
    try {
      ProgramResult result = plan_profiles_of({file_.name, file_.path, task_});
      result.corner_bound = bound_;
      keep("profiles", std::move(result));
    } catch (const std::invalid_argument& error) {
      const std::string why = error.what();
      tell_(why);
      // Behind the semicolon there is advice for the command line.
      leave("profiles", "is not available for this task", why.substr(0, why.find(';')));
    }
  }
  void free(double seconds) {
    ProgramFileOptions options;
    options.deadline = Deadline(seconds);
    options.free.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    ProgramResult best = run_free_plan(file_, task_, options, tell_, std::move(fixed_));
    // If no window gives way, the answer is the plan it began with.
    if (best.plan.trajectory() != nullptr && best.plan.trajectory()->is_free())
      keep("free", std::move(best));
    else
      plans_.others.push_back(fmt::format("Plan free found nothing faster in {:g} s.", seconds));
  }
  Plans plans() {
    std::stable_sort(plans_.holding.begin(), plans_.holding.end(),
                     [](const auto& a, const auto& b) { return a.cycle_time < b.cycle_time; });
    return std::move(plans_);
  }

 private:
  void keep(const char* plan, ProgramResult result) {
    if (result.verification.feasible) {
      plans_.holding.push_back(std::move(result));
    } else {
      tell_(result.message);
      leave(plan, "does not hold here", result.message);
    }
  }
  void leave(const char* plan, const char* what, const std::string& why) {
    plans_.others.push_back(fmt::format("Plan {} {}: {}.", plan, what, why));
  }

  const ProgramFile& file_;
  const Task& task_;
  const std::function<void(const std::string&)>& tell_;
  std::optional<CornerBound> bound_;
  std::optional<ProgramResult> fixed_;  ///< if it holds
  Plans plans_;
};

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
               {"colours", Json::array()},
               {"other_colour", figure_style::colours.at(figure_style::baseline_style)},
               {"palette", figure_style::line_palette},
               {"velocity_max", bounds_json(machine, &Axis::velocity_max)},
               {"acceleration_max", bounds_json(machine, &Axis::acceleration_max)},
               {"jerk_max", bounds_json(machine, &Axis::jerk_max)},
               {"plans", Json::array()}};
  for (std::size_t a = 0; a < path.dimensions(); ++a) program["axes"].push_back(path.axis_name(a));
  const auto styles = binding_styles(machine);
  for (std::size_t i = 0; i < binding_limits; ++i) {
    program["limits"].push_back(binding_name(static_cast<int>(i)));
    program["colours"].push_back(figure_style::colours.at(static_cast<std::size_t>(styles[i])));
  }
  program["other"] = binding_name(-1);
  Planner planner(file, task, tell);
  planner.fixed();
  planner.profiles();
  if (free_seconds > 0.0) planner.free(free_seconds);
  const auto [plans, others] = planner.plans();
  if (plans.empty()) throw std::runtime_error("no plan of this program holds all limits: accdec program says why");
  const std::int64_t step = common_step(plans);
  for (const ProgramResult& plan : plans) program["plans"].push_back(motion_json(path, machine, plan, step));
  program["others"] = others;
  const auto fixed =
      std::find_if(plans.begin(), plans.end(), [](const auto& p) { return p.plan.command() != nullptr; });
  program["corners"] = corners_json(path, fixed == plans.end() ? nullptr : &fixed->plan.path);
  program["base"] = base_of(task, path);
  std::string start = start_json(first_task(program, name), name);
  start.pop_back();  // its closing brace
  return start + ", \"program\": " + program.dump(-1, ' ', false, Json::error_handler_t::replace) + "}";
}

}  // namespace accdec::explore
