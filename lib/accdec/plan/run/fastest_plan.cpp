#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <utility>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/files.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/verify/motion_proof.hpp>

namespace accdec {
PlanTime time_of(const ProgramResult& r) {
  // Only profiles may be without a plan, where checking its samples takes longer than the time limit.
  return {r.plan.empty() ? "profiles" : r.plan.name(), r.cycle_time, r.verification.feasible,
          r.verification.feasible ? "" : r.verification.worst};
}

void require_plan(const ProgramResult& result, const Deadline& deadline) {
  if (!result.plan.empty()) return;
  const char* const instead = deadline.asked_to_end() ? "; nothing is written" : "; give --time-limit longer";
  throw std::invalid_argument(result.message + instead);
}

bool time_for_one_filter(const Toolpath& path, const Deadline& deadline) {
  constexpr std::size_t always = 2000;  // blocks: takes less time than the bound
  return path.blocks() <= several_plans_max && (path.blocks() <= always || !deadline.over());
}

ProgramResult plan_profiles_of(PlanningProblem problem, std::optional<CoolProfiles>* cool) {
  const double bound = program_lower_bound(problem.path, program_machine(problem.task.machine, problem.path),
                                           problem.task.sample_period);
  std::optional<CoolProfiles> lower;
  ProgramResult result = run_profiles(std::move(problem), cool != nullptr ? *cool : lower);
  result.lower_bound = bound;
  return result;
}

ProgramResult plan_profiles_first(const ProgramFile& file, const Task& task, const Deadline& deadline,
                                  std::optional<CoolProfiles>* cool) {
  // If checking its samples takes all the time there is, one filter may still be planned.
  const bool several = file.path.blocks() <= several_plans_max;
  const Deadline most = several ? deadline.within(0.6 * deadline.left()) : deadline;
  ProgramResult profiles = plan_profiles_of({file.name, file.path, task, Feeds::choose, most}, cool);
  profiles.reading = file.reading;
  return profiles;
}

bool has_bounds(const Toolpath& path) {
  if (path.blocks() > several_plans_max) return false;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if ((path.joint[b] == Joint::corner || path.joint[b] == Joint::smooth) && !(path.tolerance[b] < unlimited))
      return false;
  }
  return true;
}

CornerBound corner_bound_of(const Toolpath& path, const Task& task, const Deadline& deadline, bool thorough) {
  const Machine machine = program_machine(task.machine, path);
  // Bounds of motions that are free take longer than those of legs, and are mostly larger.
  const double of_legs = thorough ? 0.05 : 0.15, of_motions = thorough ? 0.25 : 0.15, longest = 10.0;
  const double left = deadline.left(), part = std::max(0.0, left), limit = left < unlimited ? of_legs * part : longest;
  CornerBound bound = program_corner_bound(path, machine, task.sample_period, deadline.within(limit));
  // A plan needs a short time more than its bound.
  const double for_motions = left < unlimited ? of_motions * part : thorough ? 3.0 * longest : longest;
  AnyMotionBound any = any_motion_bound(path, machine, task.sample_period, deadline.within(for_motions), thorough);
  bound.any_motion = any.time, bound.any_motion_complete = any.complete;
  // Long proofs take as much time as a plan to check, and more room than it.
  constexpr std::size_t proof_blocks_max = 10'000;
  if (!any.proofs.empty() && path.blocks() <= proof_blocks_max) {
    try {
      bound.proved = proved_time(path, machine, task.sample_period, any.proofs);
      bound.proofs = std::move(any.proofs);
    } catch (const std::invalid_argument&) {
      // Multipliers that rounding spoils, as with 10^13 samples, prove nothing.
    }
  }
  // It finds the least sum of multipliers closer than their search does.
  bound.any_motion = std::max(bound.any_motion, bound.proved);
  bound.time = std::max(bound.time, bound.any_motion);
  return bound;
}

CornerBound corner_bound_as_read(const CornerBound& known, double chords, const ProgramResult& answer, const Task& task,
                                 ProgramFileOptions options) {
  options.arc_tolerance = answer.reading.read.arc_tolerance;
  if (*options.arc_tolerance == chords) return known;
  return corner_bound_of(read_program_file(answer.program, task, options, {}).path, task, options.deadline);
}

namespace {

ProgramResult faster_plan(const ProgramFile& file, const Task& task, const ProgramFileOptions& options,
                          const std::function<void(const std::string&)>& tell) {
  if (options.fixed.feeds == Feeds::keep) {
    throw std::invalid_argument(
        "plan profiles takes F as an upper bound and chooses the speed of every sample: only plan fixed keeps feeds");
  }
  const double chords = file.reading.read.arc_tolerance;
  ProgramResult profiles = plan_profiles_first(file, task, options.deadline);
  const bool holds = !profiles.plan.empty() && profiles.verification.feasible;
  if (has_bounds(file.path)) profiles.corner_bound = corner_bound_of(file.path, task, options.deadline);
  const bool late = !time_for_one_filter(file.path, options.deadline);
  if (late && holds) return profiles;
  std::optional<AlongPlan> along;
  if (!late && !profiles.plan.empty()) along = plan_along(profiles, task, options.deadline);
  ProgramResult other = run_fixed_plan(file, task, options, tell);
  ProgramResult& best = along ? along->result : profiles;
  if (along) along->result.candidates = {time_of(profiles)};
  if (other.plan.empty()) {
    require_plan(best, options.deadline);
    return std::move(best);
  }
  const PlanTime mine = time_of(best), theirs = time_of(other);
  const bool faster = theirs.verified && (!mine.verified || theirs.time < mine.time);
  if (faster || best.plan.empty()) {
    other.candidates = {mine};
    if (profiles.corner_bound)
      other.corner_bound = corner_bound_as_read(*profiles.corner_bound, chords, other, task, options);
    return other;
  }
  best.candidates.push_back(theirs);
  return std::move(best);
}

}  // namespace

ProgramResult run_fastest_plan(const ProgramFile& file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell) {
  const auto start = std::chrono::steady_clock::now();
  ProgramResult result = faster_plan(file, task, options, tell);
  result.solver.wall_time = seconds_since(start);  // both plans and the bounds
  return result;
}

}  // namespace accdec
