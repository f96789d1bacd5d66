#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>

namespace accdec::test {

/// Plan free of a program without its bounds, for which it has seconds. One filter is planned beside it only if the
/// task names it: a search for one ends by the clock. So the answer is the same on every machine. One sweep of windows.
inline ProgramResult free_without_clock(const ProgramFile& file, const Task& task,
                                        const std::function<void(const std::string&)>& tell = {}) {
  const ProgramResult profiles = plan_profiles_of({file.name, file.path, task, Feeds::choose, {}});
  std::optional<ProgramResult> fixed;
  if (task.filter) fixed = run_fixed_plan(file, task, {}, {});
  ProgramFileOptions options;
  options.free.sweeps = 1;
  const bool holds = fixed && fixed->verification.feasible;
  return free_from(file.path, profiles, plan_along(profiles, task, {}), holds ? &*fixed : nullptr, task, options, tell);
}

}  // namespace accdec::test
