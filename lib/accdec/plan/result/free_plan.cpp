#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/plan/result/fastest_plan.hpp>
#include <accdec/plan/result/free_plan.hpp>
#include <accdec/plan/result/verify_program_result.hpp>

namespace accdec {
namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& instead) {
  throw std::invalid_argument("plan free " + what + "; " + instead);
}

void refuse_options(const Toolpath& path, const ProgramFileOptions& options) {
  if (options.feeds == Feeds::keep)
    refuse("takes F as an upper bound and chooses the speed of every sample", "only plan fixed keeps feeds");
  if (options.compensate_arcs) refuse("runs along arcs as they are", "leave out --compensate-arcs");
  if (!path.given.empty()) refuse("takes no delays from the program", "leave out --dwells-before-filter");
}

void refuse_limits(const Task& task, const Toolpath& path) {
  const char* const others = "use --plan profiles";
  for (const Mode& mode : task.machine.modes) {
    if (mode.residual_max < 1.0) refuse("keeps no vibration bounds ([[mode]])", others);
  }
  const Machine machine = program_machine(task.machine, path);
  if (machine.axes.empty()) refuse("needs limits of the axes ([[axis]])", others);
  for (const Axis& axis : machine.axes) {
    if (axis.power_max < unlimited) refuse(fmt::format("keeps no limit of power (axis {})", axis.name), others);
    if (axis.regeneration_max < unlimited)
      refuse(fmt::format("keeps no limit of regeneration (axis {})", axis.name), others);
    if (!(axis.acceleration_max < unlimited) && !(axis.force_max < unlimited && axis.mass > 0.0))
      refuse(fmt::format("needs a limit of acceleration or of force with a mass (axis {})", axis.name), others);
  }
}

FreeMotion as_motion(const Toolpath& path, const FreeSamples& samples) {
  FreeMotion motion;
  const auto n = static_cast<std::ptrdiff_t>(path.dimensions());
  motion.position.assign(samples.position.begin() + n, samples.position.end());
  const std::vector<std::size_t> legs = legs_of(path, samples);
  for (std::size_t k = 1; k < legs.size(); ++k) motion.block.push_back(static_cast<std::uint32_t>(legs[k]));
  return motion;
}

}  // namespace

ProgramResult run_free_plan(const std::string& name, const ProgramFile& file, const Task& task,
                            const ProgramFileOptions& options, FreeOptions free,
                            const std::function<void(const std::string&)>& tell) {
  refuse_options(file.path, options);
  refuse_limits(task, file.path);
  const auto start = std::chrono::steady_clock::now();
  if (tell) tell("plan profiles, which the free motion begins with");
  ProgramResult profiles = plan_profiles_of(name, file.path, file.reading.read.arc_tolerance, task, options.deadline);
  if (file.path.blocks() <= several_plans_max)
    profiles.corner_bound = corner_bound_of(file.path, task, options.deadline);
  if (!profiles.verification.feasible) return profiles;
  const Toolpath& path = profiles.plan.path;
  const Machine machine = program_machine(task.machine, path);
  const FreePath tube(path, machine, task.sample_period);
  FreeSamples motion = sampled(path, *profiles.plan.trajectory(), task.sample_period);
  free.deadline = options.deadline;
  const FreeReport report = shorten_motion(tube, motion, free);
  ProgramResult result;
  result.program = name;
  result.sample_period = task.sample_period;
  result.task_machine = task.machine;
  result.programmed_blocks = profiles.programmed_blocks;
  result.programmed_moves = profiles.programmed_moves;
  result.feeds_chosen = true;
  result.lower_bound = profiles.lower_bound;
  result.corner_bound = profiles.corner_bound;
  result.plan = {path, Trajectory{{}, Filter({1.0}), as_motion(path, motion)}};
  const std::string broken = judge_free_motion(result, machine);
  if (!broken.empty() || result.cycle_time > profiles.cycle_time) {
    if (!broken.empty() && tell) tell("plan free was refused by the check of its samples: " + broken);
    profiles.solver.wall_time = seconds_since(start);
    return profiles;
  }
  result.candidates = {{"profiles", profiles.cycle_time, profiles.verification.feasible}};
  result.solver.method = "windows by interior point";
  result.solver.evaluations = report.programmes;
  result.solver.wall_time = seconds_since(start);
  if (report.ended && tell) tell("ended early with the best motion so far");
  return result;
}

}  // namespace accdec
