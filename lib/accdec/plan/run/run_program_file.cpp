#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/words.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/program.hpp>

namespace accdec {
namespace {

constexpr std::array<std::pair<PlanKind, std::string_view>, 3> plan_kinds{
    {{PlanKind::fixed, "fixed"}, {PlanKind::profiles, "profiles"}, {PlanKind::free, "free"}}};

/// Plan fixed with the bounds of any motion.
ProgramResult fixed_with_bounds(ProgramFile file, const Task& task, const ProgramFileOptions& options,
                                const std::function<void(const std::string&)>& tell) {
  const double chords = file.reading.read.arc_tolerance;
  // Behind a servo there are no bounds: they are of motions, and the time of the plan is that of the command.
  const bool bounded = has_bounds(file.path) && !has_servo(program_machine(task.machine, file.path));
  const Toolpath path = bounded ? file.path : Toolpath{};
  // The plan, which might take all the time, leaves a part of it.
  constexpr double part_of_plan = 0.75;
  ProgramFileOptions planning = options;
  if (bounded) planning.deadline = options.deadline.within(part_of_plan * options.deadline.left());
  ProgramResult result = run_fixed_plan(std::move(file), task, planning, tell);
  result.taps_control = control_of_taps(task);
  if (!bounded || result.plan.empty()) return result;
  if (tell) tell("bounds");
  result.corner_bound =
      corner_bound_as_read(corner_bound_of(path, task, options.deadline), chords, result, task, options);
  return result;
}

/// Feeds that had to be lowered may make a move longer than any that a program or a result may have.
ProgramResult with_times_in_range(ProgramResult result) {
  constexpr double longest = 1e9;  // s
  const Toolpath& path = result.plan.path;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (path.duration[b] < longest) continue;
    throw std::invalid_argument(
        fmt::format("line {}: at the feed that the limits leave, the move takes more than 1e9 s; nothing is written",
                    path.line[b]));
  }
  return result;
}

}  // namespace

const std::vector<std::string>& plan_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [kind, name] : plan_kinds) list.emplace_back(name);
    return list;
  }();
  return names;
}

PlanKind plan_kind(std::string_view name) {
  if (const auto kind = value_of<PlanKind>(plan_kinds, name)) return *kind;
  throw std::invalid_argument(fmt::format("plans are {}", fmt::join(plan_names(), ", ")));
}

ProgramResult run_program_file(ProgramFile file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell) {
  if (task.settings) require_planned_taps(*task.settings);
  switch (options.plan) {
    case PlanKind::profiles: return with_times_in_range(run_fastest_plan(file, task, options, tell));
    case PlanKind::free: return with_times_in_range(run_free_plan(file, task, options, tell));
    case PlanKind::fixed: break;
  }
  return with_times_in_range(fixed_with_bounds(std::move(file), task, options, tell));
}

}  // namespace accdec
