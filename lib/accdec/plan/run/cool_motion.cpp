#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/cool_motion.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

namespace accdec {
namespace {

constexpr int rounds_max = 4;

/// A motion that was planned for lower limits, under those of the task. Says what it breaks.
std::string under_own_limits(const ProgramResult& profiles, ProgramResult lower, const Toolpath& path,
                             const Machine& machine, ProgramResult& result) {
  static_cast<ProgramSubject&>(result) = profiles;
  result.feeds_chosen = true;
  result.lower_bound = profiles.lower_bound;
  result.plan = {path, std::move(lower.plan.motion)};
  result.solver = lower.solver;
  result.rounds = lower.rounds;
  return judge_trajectory(result, machine);
}

/// Largest of rms / rating.
double warmth(const ProgramResult& result) {
  double most = 0.0;
  for (const AxisLoad& load : result.loads) most = std::max(most, load.rms / load.rms_max);
  return most;
}

}  // namespace

std::optional<ProgramResult> cool_motion(const ProgramFile& file, const ProgramResult& profiles,
                                         const std::optional<CoolProfiles>& limits, const ProgramResult* fixed,
                                         const Task& task, const ProgramFileOptions& options,
                                         const std::function<void(const std::string&)>& tell) {
  const Machine machine = program_machine(task.machine, file.path);
  Toolpath path = limits ? limits->path : file.path;
  Task lower = task;
  lower.machine = limits ? limits->machine : machine;
  for (Axis& axis : lower.machine.axes) axis.force_rms_max = unlimited;
  double had = profiles.verification.feasible ? profiles.cycle_time : unlimited;
  if (fixed != nullptr) had = std::min(had, fixed->cycle_time);
  for (int round = 0; round < rounds_max && (round == 0 || !options.deadline.over()); ++round) {
    ProgramFileOptions part = options;
    part.deadline = options.deadline.within(options.deadline.left() / (rounds_max - round));
    const ProgramResult begin = plan_profiles_of({file.name, path, lower, Feeds::choose, part.deadline});
    if (begin.plan.empty() || !begin.verification.feasible) return {};
    // One filter at the task's own limits does not hold lower ones.
    const bool own = !limits && round == 0;
    ProgramResult result;
    const std::string broken = under_own_limits(
        profiles,
        free_from(path, begin, plan_along(begin, lower, part.deadline), own ? fixed : nullptr, lower, part, tell),
        file.path, machine, result);
    if (broken.empty() && result.cycle_time < had) {
      if (result.plan.trajectory()->is_free()) result.candidates = {time_of(profiles)};
      return result;
    }
    const double warm = warmth(result);
    if (warm <= 1.0 || result.cycle_time >= had) {
      if (tell) tell("no motion that keeps the drives' ratings is faster: the plan stays what it is");
      return {};
    }
    // Forces of acceleration fall with the square of the factor, and friction less.
    constexpr double power = 0.6;
    slow_down(path, lower.machine, std::pow(warm, power));
  }
  return {};
}

}  // namespace accdec
