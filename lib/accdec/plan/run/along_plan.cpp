#include <algorithm>
#include <chrono>
#include <utility>

#include <accdec/plan/along/along_run.hpp>
#include <accdec/plan/along/smooth_path.hpp>
#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

namespace accdec {
namespace {

/// Power, regeneration and vibration are not kept along a path.
bool keeps_limits(const Machine& machine) {
  return !machine.axes.empty() && std::all_of(machine.modes.begin(), machine.modes.end(), [](const Mode& mode) {
    return mode.residual_max >= 1.0;
  }) && std::all_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) {
    return !(axis.power_max < unlimited) && !(axis.regeneration_max < unlimited);
  });
}

}  // namespace

bool rests_too_long(const Toolpath& path, double sample_period) {
  constexpr double rests_max = 2e6;  // samples
  return path.dwells() / sample_period > rests_max;
}

FreeMotion as_motion(const Toolpath& path, const FreeSamples& samples) {
  FreeMotion motion;
  const auto n = static_cast<std::ptrdiff_t>(path.dimensions());
  motion.position.assign(samples.position.begin() + n, samples.position.end());
  const std::vector<std::size_t> legs = legs_of(path, samples);
  for (std::size_t k = 1; k < legs.size(); ++k) motion.block.push_back(static_cast<std::uint32_t>(legs[k]));
  return motion;
}

ProgramResult with_samples(const ProgramResult& plan, const FreeSamples& samples) {
  ProgramResult result;
  static_cast<ProgramSubject&>(result) = plan;
  result.feeds_chosen = true;
  result.lower_bound = plan.lower_bound;
  result.corner_bound = plan.corner_bound;
  result.plan = {plan.plan.path, Trajectory{{}, Filter({1.0}), as_motion(plan.plan.path, samples)}};
  return result;
}

std::optional<AlongPlan> plan_along(const ProgramResult& profiles, const Task& task, const Deadline& deadline) {
  const Toolpath& path = profiles.plan.path;
  const Machine machine = program_machine(task.machine, path);
  const Trajectory* trajectory = profiles.plan.trajectory();
  if (trajectory == nullptr || !has_curves(path) || path.blocks() > several_plans_max || !keeps_limits(machine) ||
      !profiles.verification.feasible || rests_too_long(path, profiles.sample_period))
    return {};
  const auto start = std::chrono::steady_clock::now();
  const FreePath tube(path, machine, profiles.sample_period);
  FreeSamples samples = with_runs_along(tube, sampled(path, *trajectory, profiles.sample_period), deadline);
  ProgramResult result = with_samples(profiles, samples);
  const std::string broken = judge_trajectory(result, machine);
  if (!broken.empty() || !(result.cycle_time < profiles.cycle_time)) return {};
  result.solver.method = "speed along the path";
  result.solver.wall_time = profiles.solver.wall_time + seconds_since(start);
  return AlongPlan{std::move(result), std::move(samples)};
}

}  // namespace accdec
