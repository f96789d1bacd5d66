#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/run/before_planning.hpp>
#include <accdec/plan/run/cool_profiles.hpp>
#include <accdec/plan/run/refused_keys.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plan/verify/judge_program.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/contour_watch.hpp>

namespace accdec {
namespace {

/// A plan with drives as cool as they have to be. @param cool  with which lower limits, if any
ProfilePlan cool_plan(const Toolpath& path, const Machine& machine, double sample_period,
                      std::optional<CoolProfiles>& cool, const Deadline& deadline) {
  ProfilePlan plan = plan_profiles(path, machine, sample_period, deadline);
  if (!plan.checked) return plan;
  // A plan that is too warm is none: it has a short time to cool if the limit ended before.
  const Deadline until = deadline.over() ? Deadline(seconds_for_one_plan(path)) : deadline;
  cool = cool_profiles(path, machine, sample_period, plan, until);
  if (cool) plan = std::move(cool->plan);
  return plan;
}

/// The same within the path's contour. Plans know only tolerances: those of corners whose samples leave the contour
/// narrow.
ProfilePlan plan_within_contour(const Toolpath& path, const Machine& machine, double sample_period,
                                std::optional<CoolProfiles>& cool, const Deadline& deadline) {
  constexpr int rounds_max = 40;
  constexpr double enough = 0.995;
  Toolpath within = within_contour(path);
  for (int round = 0;; ++round) {
    ProfilePlan plan = cool_plan(within, machine, sample_period, cool, deadline);
    if (!(path.contour_max < unlimited) || !plan.checked || round == rounds_max || deadline.over()) return plan;
    bool narrowed = false;
    for (const auto& [point, use] : contour_of(path, Trajectory{plan.chain, plan.last}, sample_period).off()) {
      if (point == 0 || point == path.blocks() || path.joint[point - 1] == Joint::stop) continue;
      within.tolerance[point - 1] *= enough / use;
      narrowed = true;
    }
    if (!narrowed) return plan;
  }
}

}  // namespace

ProgramResult run_profiles(PlanningProblem problem) {
  std::optional<CoolProfiles> cool;
  return run_profiles(std::move(problem), cool);
}

ProgramResult run_profiles(PlanningProblem problem, std::optional<CoolProfiles>& cool) {
  const Task& task = problem.task;
  const Toolpath& path = problem.path;
  require_positions(task, "plan profiles");
  const auto start = std::chrono::steady_clock::now();
  if (!path.given_delays.empty()) {
    throw std::invalid_argument(
        "plan profiles takes no delays from the program: it has no one filter that they "
        "belong to; leave out --dwells-before-filter");
  }
  ProgramResult result = before_planning(problem);
  result.feeds_chosen = true;
  const Machine machine = program_machine(task.machine, path);
  result.solver.method = "look-ahead";
  ProfilePlan plan = plan_within_contour(path, machine, task.sample_period, cool, problem.deadline);
  if (!plan.checked) {
    result.message =
        fmt::format("{} ended plan profiles before all its samples were checked", ended_by(problem.deadline));
    result.solver.wall_time = seconds_since(start);
    return result;
  }
  result.rounds = plan.rounds;
  result.plan = {std::move(problem.path), Trajectory{std::move(plan.chain), std::move(plan.last)}};
  if (cool || path.contour_max < unlimited) {
    // The check was of lower limits and narrower tolerances.
    judge_trajectory(result, machine);
  } else {
    result.errors = std::move(plan.errors);
    result.check = std::move(plan.check);
    result.cycle_time = static_cast<double>(result.check.samples) * task.sample_period;
    judge_program(result, machine);
  }
  say_what_ended(result, problem.deadline);
  result.solver.wall_time = seconds_since(start);
  return result;
}

}  // namespace accdec
