#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/run/before_planning.hpp>
#include <accdec/plan/run/cool_profiles.hpp>
#include <accdec/plan/run/refused_keys.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plan/verify/judge_program.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/program.hpp>

namespace accdec {

ProgramResult run_profiles(PlanningProblem problem) {
  std::optional<CoolProfiles> cool;
  return run_profiles(std::move(problem), cool);
}

ProgramResult run_profiles(PlanningProblem problem, std::optional<CoolProfiles>& cool) {
  const Task& task = problem.task;
  const Toolpath& path = problem.path;
  require_positions(task, path, "plan profiles");
  const auto start = std::chrono::steady_clock::now();
  if (!path.given_delays.empty()) {
    throw std::invalid_argument(
        "plan profiles takes no delays from the program: it has no one filter that they "
        "belong to; leave out --dwells-before-filter");
  }
  ProgramResult result = before_planning(problem);
  result.feeds_chosen = true;
  const Machine machine = program_machine(task.machine, path);
  ProfilePlan plan = plan_profiles(path, machine, task.sample_period, problem.deadline);
  result.solver.method = "look-ahead";
  if (!plan.checked) {
    result.message =
        fmt::format("{} ended plan profiles before all its samples were checked", ended_by(problem.deadline));
    result.solver.wall_time = seconds_since(start);
    return result;
  }
  // A plan that is too warm is none: it has a short time to cool if the limit ended before.
  const Deadline until = problem.deadline.over() ? Deadline(seconds_for_one_plan(path)) : problem.deadline;
  cool = cool_profiles(path, machine, task.sample_period, plan, until);
  if (cool) plan = std::move(cool->plan);
  result.rounds = plan.rounds;
  result.plan = {std::move(problem.path), Trajectory{std::move(plan.chain), std::move(plan.last)}};
  if (cool) {
    // The check was of lower limits.
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
