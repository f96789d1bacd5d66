#include <algorithm>
#include <chrono>
#include <future>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/plan/along/straight_run.hpp>
#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/run/cool_motion.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/run/refused_keys.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

namespace accdec {
namespace {

/// Part of the time left behind plan profiles, for motions along arcs: more than plan profiles itself leaves them.
constexpr double of_arcs = 0.9;

[[noreturn]] void refuse(const std::string& what, const std::string& instead) {
  throw std::invalid_argument("plan free " + what + "; " + instead);
}

void refuse_options(const Toolpath& path, const ProgramFileOptions& options) {
  if (options.fixed.feeds == Feeds::keep)
    refuse("takes F as an upper bound and chooses the speed of every sample", "only plan fixed keeps feeds");
  if (!path.given_delays.empty()) refuse("takes no delays from the program", "leave out --dwells-before-filter");
}

/// Why the plan is not written sample by sample; empty if it is.
/// @param fixed  one filter for the program, if it holds
std::string why_no_motion(const ProgramResult& profiles, const ProgramResult* fixed, const Deadline& deadline) {
  constexpr double samples_a_second = 1e6;  // made, checked and written by one core of 2.6 GHz
  constexpr double always = 0.1;            // s, even if the time is over: no longer than a plan takes
  const bool holds = !profiles.plan.empty() && profiles.verification.feasible;
  if (!holds && fixed == nullptr)
    return profiles.plan.empty() ? profiles.message : "plan profiles found no motion that holds all limits";
  const ProgramResult& first = holds ? profiles : *fixed;
  if (rests_too_long(first.plan.path, first.sample_period))
    return "dwells of more than two million samples are not written one by one";
  const auto samples = static_cast<double>(first.check.samples);
  if (samples / samples_a_second > std::max(always, deadline.left()))
    return fmt::format("{:.0f} samples take longer to write one by one than the time limit leaves", samples);
  return "";
}

/// One filter for the program, in a part of the time; if there is no other plan, even when the time is over.
std::optional<ProgramResult> fixed_beside(const ProgramFile& file, const Task& task, ProgramFileOptions options,
                                          bool only) {
  if (!only && !time_for_one_filter(file.path, options.deadline)) return {};
  if (const double left = options.deadline.left(); options.time_limit || left < unlimited) {
    // Windows gain little in so short a time: a filter has as much of it as beside plan profiles.
    constexpr double part = 0.3, short_time = 0.5;  // s
    const double all = std::min(left, options.time_limit.value_or(unlimited));
    if (all > short_time) options.time_limit = std::max(part * all, short_time);
    options.deadline = options.deadline.within(options.time_limit.value_or(unlimited));
  }
  ProgramResult fixed = run_fixed_plan(file, task, options, {});
  if (fixed.plan.empty() || !fixed.verification.feasible) return {};
  return fixed;
}

/// The fastest of the plans as samples: profiles, along its arcs, or one filter. None if only the filter's plan holds
/// and it has none, or they leave the tube.
std::optional<AlongPlan> fastest_samples(const ProgramResult& profiles, std::optional<AlongPlan> along,
                                         const ProgramResult* fixed, const Task& task) {
  const Toolpath& path = profiles.plan.path;
  const bool holds = profiles.verification.feasible;
  const double best = along ? along->result.cycle_time : holds ? profiles.cycle_time : unlimited;
  if (fixed && fixed->cycle_time < best) {
    if (std::optional<FreeSamples> samples = sampled(path, fixed->plan, profiles.sample_period)) {
      ProgramResult result = with_samples(profiles, *samples);
      // If many moves overlap, a filter may leave the tube around a leg.
      const std::string broken = judge_trajectory(result, program_machine(task.machine, path));
      if (broken.empty() && result.cycle_time < best) return AlongPlan{std::move(result), std::move(*samples)};
    }
  }
  if (along || !holds) return along;
  return AlongPlan{profiles, sampled(path, *profiles.plan.trajectory(), profiles.sample_period)};
}

/// A motion's samples made otherwise, if that is faster and the check takes it.
AlongPlan if_faster(AlongPlan begun, FreeSamples samples, const ProgramResult& profiles, const FreePath& tube,
                    const char* method, const std::function<void(const std::string&)>& tell) {
  if (!(samples.position.size() < begun.samples.position.size())) return begun;
  ProgramResult result = with_samples(profiles, samples);
  const std::string broken = judge_trajectory(result, tube.machine);
  if (!broken.empty() && tell) tell(std::string(method) + " were refused by the check of their samples: " + broken);
  if (!broken.empty() || !(result.cycle_time < begun.result.cycle_time)) return begun;
  result.solver.method = method;
  return {std::move(result), std::move(samples)};
}

/// The motion with each straight leg between stops by itself.
AlongPlan with_fastest_legs(AlongPlan begun, const ProgramResult& profiles, const FreePath& tube,
                            const Deadline& deadline, const std::function<void(const std::string&)>& tell) {
  FreeSamples straight = with_straight_runs(tube, begun.samples);
  begun =
      if_faster(std::move(begun), std::move(straight), profiles, tube, "legs from stop to stop by closed form", tell);
  FreeSamples shortest = with_shortest_legs(tube, begun.samples, deadline);
  return if_faster(std::move(begun), std::move(shortest), profiles, tube, "legs from stop to stop by linear programmes",
                   tell);
}

/// The beginning with its samples shortened; the beginning itself where nothing is gained.
ProgramResult shortened(const ProgramResult& profiles, AlongPlan begun, const Machine& machine,
                        const ProgramFileOptions& options, const std::function<void(const std::string&)>& tell) {
  const FreePath tube(profiles.plan.path, machine, profiles.sample_period);
  options.free.tell("legs from stop to stop");
  begun = with_fastest_legs(std::move(begun), profiles, tube, options.deadline, tell);
  const FreeReport report = shorten_motion(tube, begun.samples, options.free, options.deadline);
  ProgramResult result = with_samples(profiles, begun.samples);
  const std::string broken = judge_trajectory(result, machine);
  if (!broken.empty() && tell) tell("plan free was refused by the check of its samples: " + broken);
  if (!broken.empty() || result.cycle_time > begun.result.cycle_time)
    result = std::move(begun.result);
  else
    result.solver.method = "windows by interior point";
  if (result.plan.trajectory()->is_free()) result.candidates = {time_of(profiles)};
  result.solver.evaluations = report.programmes;
  return result;
}

}  // namespace

ProgramResult free_from(const Toolpath& path, const ProgramResult& profiles, std::optional<AlongPlan> along,
                        const ProgramResult* fixed, const Task& task, const ProgramFileOptions& options,
                        const std::function<void(const std::string&)>& tell) {
  const std::string no_motion = why_no_motion(profiles, fixed, options.deadline);
  if (!no_motion.empty()) {
    if (tell) tell(no_motion + ": the plan stays what it is");
    return along ? std::move(along->result) : profiles;
  }
  ProgramResult unchecked;  // plan profiles without a plan, if the time ended before its check
  if (profiles.plan.empty()) unchecked = profiles, unchecked.plan = {path, Trajectory{}};
  const ProgramResult& first = profiles.plan.empty() ? unchecked : profiles;
  std::optional<AlongPlan> begun = fastest_samples(first, std::move(along), fixed, task);
  if (!begun) {
    if (tell) tell("no plan has samples that keep to their legs");
    return profiles;
  }
  const Machine machine = program_machine(task.machine, path);
  ProgramResult result = shortened(first, std::move(*begun), machine, options, tell);
  if (options.fixed.compensate_arcs)
    result.compensation = "arcs are commanded as programmed: samples lie on them, or as near as tolerances ask";
  return result;
}

ProgramResult run_free_plan(const ProgramFile& file, const Task& task, const ProgramFileOptions& options,
                            const std::function<void(const std::string&)>& tell, std::optional<ProgramResult> fixed) {
  refuse_options(file.path, options);
  require_positions(task, "plan free");
  require_free(task, file.path);
  const auto start = std::chrono::steady_clock::now();
  options.free.tell("plan profiles");
  const double chords = file.reading.read.arc_tolerance;
  std::optional<CoolProfiles> limits;
  ProgramResult profiles = plan_profiles_first(file, task, options.deadline, &limits);
  const bool rated = has_ratings(program_machine(task.machine, file.path));
  // Before one filter and the bounds, which may take all the time that is left; windows need some of it, too.
  options.free.tell("motions along arcs");
  std::optional<AlongPlan> along;
  if (!profiles.plan.empty() && !rated)
    along = plan_along(profiles, task, options.deadline.within(of_arcs * options.deadline.left()));
  // The bound is computed beside what follows.
  std::future<CornerBound> bound;
  if (has_bounds(file.path)) {
    const std::launch how = options.free.threads > 1 ? std::launch::async : std::launch::deferred;
    bound = std::async(how, [&] { return corner_bound_of(file.path, task, options.deadline, true); });
  }
  // One filter may be faster than profiles, and than any motion that was found.
  const bool only = profiles.plan.empty() || !profiles.verification.feasible;
  if (!fixed) {
    options.free.tell("plan fixed");
    fixed = fixed_beside(file, task, options, only);
  }
  // With more threads, windows are shortened beside it.
  options.free.tell("bounds");
  if (bound.valid() && options.free.threads == 1) bound.wait();
  ProgramResult* const beside = fixed ? &*fixed : nullptr;
  const auto answer = [&](ProgramResult result) {
    if (bound.valid()) result.corner_bound = bound.get();
    if (beside && (!result.verification.feasible || beside->cycle_time < result.cycle_time)) {
      std::swap(*beside, result);
      if (beside->corner_bound)
        result.corner_bound = corner_bound_as_read(*beside->corner_bound, chords, result, task, options);
      if (tell) tell("plan fixed is faster than the free motion that was found");
    }
    if (beside) result.candidates.push_back(time_of(*beside));
    require_plan(result, options.deadline);
    result.solver.wall_time = seconds_since(start);
    return result;
  };
  if (rated) {
    std::optional<ProgramResult> cool = cool_motion(file, profiles, limits, beside, task, options, tell);
    return answer(cool ? std::move(*cool) : std::move(profiles));
  }
  return answer(free_from(file.path, profiles, std::move(along), beside, task, options, tell));
}

}  // namespace accdec
