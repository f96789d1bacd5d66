#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/gcode/emitted_filters.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/design_program_filter.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/run/before_planning.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/standard_shapes.hpp>
#include <accdec/plan/run/todays_time.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

using Tell = std::function<void(const std::string&)>;

/// s, for a filter.
double filter_seconds(const Toolpath& path, const ProgramFileOptions& options) {
  // The plan needs a part of what is left; bounds come behind it.
  constexpr double part_of_limit = 0.5, part_of_left = 2.0 / 3.0;
  return options.time_limit
             ? std::max(0.05, std::min(part_of_limit * *options.time_limit, part_of_left * options.deadline.left()))
             : usual_seconds(path.blocks());
}

/// For settings: work, which ends the search at the same place on every machine. A time limit has a clock beside it.
/// @param part  of the search's
Effort settings_effort(const Toolpath& path, const ProgramFileOptions& options, double part) {
  const double seconds = part * filter_seconds(path, options);
  if (!options.time_limit) return Effort(seconds, options.deadline);
  return Effort(part * work_of_limit * *options.time_limit, options.deadline.within(std::max(0.05, seconds)));
}

/// Blocks of programs that are planned with settings whatever the time limit.
constexpr std::size_t at_once_max = 2'000;

/// The task's filter, the filter in a program that --emit wrote, or one designed for the program with any delays. None
/// if none holds; the message gives the reason.
ProgramFilter taps_for_program(const Toolpath& path, const Task& task, const ProgramFileOptions& options,
                               const Tell& tell) {
  if (task.filter) {
    ProgramFilter given;
    given.filter = make_filter(*task.filter);
    given.solver.method = "given";
    return given;
  }
  if (const auto emitted = options.fixed.dwells_before_filter ? emitted_filter(path) : std::nullopt) {
    if (tell) tell("the filter is the one that the program was planned for");
    ProgramFilter given;
    given.filter = *emitted;
    given.solver.method = "given by the program";
    return given;
  }
  const double limit = filter_seconds(path, options);
  ProgramFilter designed = options.fixed.feeds == Feeds::keep
                               ? design_program_filter(path, task, limit, tell, options.deadline)
                               : design_filter_for_feeds(path, task, limit, tell, options.deadline);
  designed.designed = true;
  return designed;
}

void mark_waits(Toolpath& path, const Task& task) {
  if (task.settings) mark_waits(path, control_of(task, 0.0));
}

/// As taps_for_program; settings if the task's control has families, and for taps whose control has only some delays.
ProgramFilter filter_for_program(const Toolpath& path, const Task& task, const ProgramFileOptions& options,
                                 const Tell& tell) {
  const bool emitted_one = options.fixed.dwells_before_filter && emitted_filter(path);
  ProgramFileOptions own = options;
  own.fixed.feeds = feeds_of(task, options.fixed.feeds);
  const bool keep = own.fixed.feeds == Feeds::keep;
  if (task.settings && task.settings->names_family() && !emitted_one) {
    const Effort effort = settings_effort(path, options, 1.0);
    return settings_filter(path, task, keep, path.blocks() <= at_once_max ? effort.with_one_plan() : effort, tell);
  }
  const bool of_taps = task.settings && !task.settings->names_family() && has_settings(*task.settings) &&
                       !(emitted_one && limits_taps(*task.settings) && task.settings->names(DelayKind::in_position));
  if (!of_taps) return taps_for_program(path, task, options, tell);
  ProgramFilter choice;
  choice.message = corner_without_stop(path, task);
  if (!choice.message.empty()) return choice;
  Task any = task;
  any.settings.reset();
  choice = taps_for_program(path, any, own, tell);
  const Effort effort = settings_effort(path, options, 1.0);
  if (choice.designed)
    offer_averages(path, task, keep, effort, choice);
  else if (choice.filter)
    choice.settings = {.chosen = taps_to_set(task, *choice.filter),
                       .width = width_for_program(path, task, *choice.filter, keep, effort)};
  return choice;
}

/// The delays that the task's control has.
void set_control(Toolpath& path, const Task& task, const ProgramFilter& choice) {
  if (task.settings) give_control(path, planned_control(task, choice.settings ? choice.settings->width : 0.0));
}

/// The time at the programmed feeds, and those of other rules for delays at these feeds.
void take_kept(const ProgramResult& from, double time, ProgramResult& result) {
  result.cycle_time_kept = time;
  result.cycle_time_exact_stop = from.cycle_time_exact_stop;
  result.exact_stop_breaks = from.exact_stop_breaks;
  result.cycle_time_no_delay = from.cycle_time_no_delay;
}

/// As `--feeds keep` plans the program, with the filter designed for that, if it is faster than the result.
/// @param straight  the program as it was read, if it has no chords: longer ones change nothing, and it need not be a
///                  file
void offer_kept(std::optional<ProgramFile> straight, const Task& task, const ProgramFileOptions& options,
                ProgramResult& result) {
  ProgramFileOptions coarse = options;
  coarse.arc_tolerance = options.arc_tolerance.value_or(longest_chords);
  ProgramFile again = straight ? std::move(*straight) : read_program_file(result.program, task, coarse, {});
  coarse.fixed.feeds = Feeds::keep;
  const ProgramFilter filter = filter_for_program(again.path, task, coarse, {});
  if (!filter.filter) return;
  set_control(again.path, task, filter);
  ProgramResult kept = run_program(
      {result.program, std::move(again.path), task, coarse.fixed.feeds, options.deadline, options.fixed.filter_bound},
      *filter.filter, filter.plan);
  kept.reading = again.reading;
  const double wall_time = result.solver.wall_time + filter.solver.wall_time + kept.solver.wall_time;
  // A result at kept feeds has the times of its own filter.
  const bool best = !result.cycle_time_kept || kept.cycle_time <= *result.cycle_time_kept;
  if (kept.verification.feasible && result.feeds_chosen && best) take_kept(kept, kept.cycle_time, result);
  if (kept.verification.feasible && (!result.verification.feasible || kept.cycle_time < result.cycle_time)) {
    result = std::move(kept);
    result.solver = filter.solver;
  }
  result.kept_same_filter = false;
  result.solver.wall_time = wall_time;
}

/// Adds the settings, with how the control gives the delays.
void say_settings(ProgramResult& result, const ProgramFilter& choice, const Task& task) {
  result.settings = choice.settings;
  if (choice.settings->chosen.family == SettingFamily::taps && !result.plan.empty())
    result.settings->chosen = taps_to_set(task, result.plan.set());  // of the plan at kept feeds, if that is the answer
  result.settings->control = std::make_shared<const ControllerSettings>(*task.settings);
  if (result.plan.empty()) return;
  result.settings->is_today = is_todays(task, result.plan.set());
  result.settings->today_not_had = todays_filter_not_had(task);
  const FilteredCommand& command = *result.plan.command();
  CommandDelays delays = command_delays(result.plan.path, command.filter, task.sample_period, command.delays);
  if (!task.settings->delays.empty()) result.settings->chosen.delays = std::move(delays.kinds);
  result.settings->chosen.width = delays.width;
  // As whoever reads the result knows the control.
  result.plan.path.control.width = delays.width ? delays.width->middle() : 0.0;
  const Machine machine = program_machine(task.machine, result.plan.path);
  result.raised = raised_delays(result.plan.path, command.filter, task.sample_period, machine, command.delays);
}

/// Adds the time that the program takes with today's setting of the task's control, if the task names one.
/// @param programmed  of the answer's chords
void say_today(ProgramResult& result, Toolpath programmed, const Task& task, const ProgramFileOptions& options) {
  if (result.settings && result.settings->is_today) {
    result.today = result.verification.feasible ? result.cycle_time : unlimited;
    return;
  }
  const bool short_one = task.settings->names_family() && programmed.blocks() <= at_once_max;
  if (todays_filter(task) == nullptr || (!short_one && options.deadline.over())) return;
  const Deadline width = settings_effort(programmed, options, 0.5).clock();
  const auto whole = [&](const Deadline& end) { return short_one ? with_one_plan(end) : end; };
  TodaysTime today =
      todays_time(std::move(programmed), task, options.fixed.feeds, whole(width), whole(options.deadline));
  // A plan that was cut short says little of the setting, unless it is the faster one.
  if (today.cut && !(today.time < result.cycle_time)) return;
  result.today = today.time;
  result.today_breaks = std::move(today.breaks);
}

/// Whether the plan that keeps the feeds gets a filter of its own.
bool plans_kept_too(const Toolpath& path, const ProgramFilter& choice, const Task& task,
                    const ProgramFileOptions& options) {
  return feeds_of(task, options.fixed.feeds) == Feeds::choose && choice.designed &&
         path.blocks() <= several_plans_max && (!options.fixed.compensate_arcs || path.arcs.empty());
}

/// With one filter, and with arcs as they were read: widened where options.fixed.compensate_arcs says so.
ProgramResult plan_with_filter(ProgramFile file, const ProgramFilter& choice, const Task& task,
                               const ProgramFileOptions& options) {
  const Feeds asked = feeds_of(task, options.fixed.feeds);
  const bool finer = asked == Feeds::choose && !options.arc_tolerance && !file.path.arcs.empty() &&
                     file.path.blocks() <= several_plans_max && file.reading.read.arc_tolerance < longest_chords;
  const bool kept = plans_kept_too(file.path, choice, task, options);
  const bool families = choice.settings && task.settings->names_family();
  const Deadline deadline = families ? with_one_plan(options.deadline) : options.deadline;
  const auto plan = [&](ProgramFile read, Feeds feeds) {
    set_control(read.path, task, choice);
    ProgramResult planned =
        run_program({read.name, std::move(read.path), task, feeds, deadline, options.fixed.filter_bound},
                    *choice.filter, choice.plan);
    planned.reading = std::move(read.reading);
    return planned;
  };
  // Kept feeds widen no arcs: they were planned with the program as it is commanded without.
  const bool widen = asked == Feeds::choose && options.fixed.compensate_arcs && !file.path.arcs.empty();
  const Feeds feeds = widen ? Feeds::choose_only : kept ? Feeds::choose_fitting : asked;
  ProgramResult result = plan(std::move(file), finer ? Feeds::choose_only : feeds);
  double planning = result.solver.wall_time;
  if (finer && !options.deadline.over()) {
    ProgramFileOptions coarse = options;
    coarse.arc_tolerance = longest_chords;
    ProgramResult other = plan(read_program_file(result.program, task, coarse, {}), feeds);
    planning += other.solver.wall_time;
    const bool as_asked =
        !options.fixed.compensate_arcs || !other.plan.path.programmed.empty() || result.plan.path.programmed.empty();
    const bool better = other.verification.feasible && as_asked &&
                        (!result.verification.feasible || other.cycle_time < result.cycle_time);
    if (!result.cycle_time_kept && other.cycle_time_kept) take_kept(other, *other.cycle_time_kept, result);
    if (better) result = std::move(other);
  }
  result.solver = choice.solver;
  result.solver.wall_time += planning;
  result.kept_same_filter = choice.designed || families;
  return result;
}

/// As plan_with_filter, and at kept feeds with a filter for them; with what is said of settings.
ProgramResult plan_as_read(ProgramFile file, const ProgramFilter& choice, const Task& task,
                           const ProgramFileOptions& options) {
  const bool kept = plans_kept_too(file.path, choice, task, options);
  const bool says = (choice.settings || !control_of_taps(task).empty()) && file.path.blocks() <= several_plans_max;
  Toolpath programmed = says ? file.path : Toolpath{};
  const double chords = file.reading.read.arc_tolerance;
  std::optional<ProgramFile> straight;
  if (kept && std::ranges::count(file.path.inside_arc, 0) == std::ssize(file.path.inside_arc)) straight = file;
  ProgramResult result = plan_with_filter(std::move(file), choice, task, options);
  if (kept && !options.deadline.over()) offer_kept(std::move(straight), task, options, result);
  if (choice.settings) say_settings(result, choice, task);
  if (result.settings && options.fixed.feeds == Feeds::keep) result.settings->breaks = breaks_at_feed(result.too_fast);
  if (result.plan.empty() || !says) return result;
  if (result.reading.read.arc_tolerance != chords) {
    ProgramFileOptions as_answered = options;
    as_answered.arc_tolerance = result.reading.read.arc_tolerance;
    programmed = read_program_file(result.program, task, as_answered, {}).path;
  }
  say_today(result, std::move(programmed), task, options);
  return result;
}

/// s, for a filter of free taps to compare with.
double free_taps_seconds(const Toolpath& path, const ProgramFileOptions& options) {
  constexpr double longest = 10.0;
  return std::min(longest, options.time_limit ? 0.5 * *options.time_limit : filter_seconds(path, options));
}

/// The time of the program with delays of any number of samples: as a task without a control plans it, or with the
/// taps of the settings, whichever is faster.
std::optional<double> time_of_free_taps(const ProgramResult& result, const ProgramFile& file, const Task& task,
                                        const ProgramFileOptions& options) {
  constexpr double with_plans = 5.0;
  Task any = task;
  any.settings.reset(), any.filter.reset();
  ProgramFileOptions bounded = options;
  const double seconds = std::min(free_taps_seconds(file.path, options), filter_seconds(file.path, options));
  bounded.time_limit = 2.0 * seconds;
  bounded.deadline = options.deadline.within(std::min(with_plans * seconds, options.deadline.left()));
  std::optional<double> best;
  const auto take = [&best](const ProgramResult& plan) {
    if (plan.verification.feasible) best = std::min(best.value_or(unlimited), plan.cycle_time);
  };
  // The plan with the settings is one of free taps.
  take(result);
  const Filter own = make_filter(result.settings->chosen.filter);
  take(run_program({file.name, file.path, any, options.fixed.feeds, bounded.deadline}, own));
  if (bounded.deadline.over()) return best;
  const ProgramFilter designed = filter_for_program(file.path, any, bounded, {});
  if (designed.filter && !bounded.deadline.over()) take(plan_as_read(file, designed, any, bounded));
  return best;
}

/// The plan with today's setting, where the search's choice turned out slower: refined plans differ from those of the
/// search.
ProgramResult keep_today(ProgramResult result, ProgramFilter choice, const ProgramFile& file, const Task& task,
                         const ProgramFileOptions& options) {
  const auto today = choice.settings->today;
  if (!today || result.settings->is_today || !(result.today.value_or(unlimited) < result.cycle_time)) return result;
  const bool keep = feeds_of(task, options.fixed.feeds) == Feeds::keep;
  choice.settings->chosen = *today;
  choice.filter = make_filter(today->filter), choice.plan = {};
  ProgramFile again = file;
  mark_waits(again.path, task);
  choice.settings->width = width_for_program(again.path, task, *choice.filter, keep,
                                             settings_effort(again.path, options, 0.5).with_one_plan());
  ProgramResult kept = plan_as_read(std::move(again), choice, task, options);
  return kept.verification.feasible && kept.cycle_time < result.cycle_time ? kept : result;
}

/// How a program with arcs commanded as they are compares with one that widens them.
std::string compensation_note(const ProgramResult& plain, const ProgramResult& widened) {
  return fmt::format("arcs are commanded as programmed, which takes {:.6g} s: {}", plain.cycle_time,
                     widened.plan.path.programmed.empty()
                         ? "no plan that widens them holds all limits"
                         : fmt::format("widened, they take {:.6g} s", widened.cycle_time));
}

/// The program with the fastest standard shape. None if none holds, or if the filter is known.
std::optional<ProgramResult> plan_with_shape(const ProgramFile& file, const Task& task,
                                             const ProgramFileOptions& options, const Tell& tell) {
  constexpr double part_of_search = 0.3, part_of_plan = 0.3;
  const bool known = task.filter || (options.fixed.dwells_before_filter && emitted_filter(file.path));
  if (known || task.settings || file.path.blocks() > several_plans_max || !needs_standard_shapes(file.path, task))
    return {};
  const Deadline search = options.deadline.within(part_of_search * options.deadline.left());
  const ProgramFilter shape = fastest_standard_shape(file.path, task, options.fixed.feeds == Feeds::keep, search, tell);
  if (!shape.filter) return {};
  ProgramFileOptions own = options;
  own.deadline = options.deadline.within(part_of_plan * options.deadline.left());
  ProgramResult result = plan_with_filter(file, shape, task, own);
  return result.verification.feasible ? std::optional(std::move(result)) : std::nullopt;
}

/// The faster one of the plan with a designed filter and that with a standard shape.
ProgramResult faster_of(ProgramResult designed, std::optional<ProgramResult> shaped) {
  if (!shaped) return designed;
  const double wall_time = designed.solver.wall_time + shaped->solver.wall_time;
  if (!designed.verification.feasible || shaped->cycle_time < designed.cycle_time) {
    if (designed.cycle_time_kept && !(shaped->cycle_time_kept.value_or(unlimited) <= *designed.cycle_time_kept)) {
      take_kept(designed, *designed.cycle_time_kept, *shaped);
      shaped->kept_same_filter = false;
    }
    designed = std::move(*shaped);
  }
  designed.solver.wall_time = wall_time;
  return designed;
}

/// With the filter that suits the program as it was read.
ProgramResult choose_and_plan(ProgramFile file, const Task& task, const ProgramFileOptions& options, const Tell& tell) {
  const bool compared = task.settings && task.settings->names_family() && file.path.blocks() <= several_plans_max;
  const ProgramFile read = compared ? file : ProgramFile{};
  mark_waits(file.path, task);
  std::optional<ProgramResult> shaped = plan_with_shape(file, task, options, tell);
  ProgramFileOptions designing = options;
  constexpr double part_of_design = 0.7;  // of what a plan with a standard shape left
  if (shaped) designing.deadline = options.deadline.within(part_of_design * options.deadline.left());
  const ProgramFilter choice = filter_for_program(file.path, task, designing, tell);
  if (!choice.filter && shaped) return *shaped;
  if (!choice.filter) {
    ProgramResult none;
    static_cast<ProgramSubject&>(none) = subject_of(file.name, file.path, task);
    none.reading = file.reading;
    none.message = choice.message, none.solver = choice.solver;
    return none;
  }
  if (tell) tell("planning and simulating");
  const bool settings = choice.settings && compared;
  ProgramResult result = faster_of(plan_as_read(std::move(file), choice, task, options), std::move(shaped));
  if (!settings || result.plan.empty()) return result;
  result = keep_today(std::move(result), choice, read, task, options);
  if (!options.deadline.over()) {
    result.settings->free_taps = time_of_free_taps(result, read, task, options);
    if (result.settings->free_taps) result.settings->free_taps_limit = free_taps_seconds(read.path, options);
  }
  return result;
}

}  // namespace

ProgramResult run_fixed_plan(ProgramFile file, const Task& task, const ProgramFileOptions& options,
                             const std::function<void(const std::string&)>& tell) {
  if (!options.fixed.compensate_arcs || file.path.arcs.empty())
    return choose_and_plan(std::move(file), task, options, tell);
  // First without compensation and with all the time there is: a time limit cannot make the answer slower than that.
  ProgramFile plain = file;
  plain.path.widen_arcs = plain.reading.widen_arcs = false;
  ProgramFileOptions as_programmed = options;
  as_programmed.fixed.compensate_arcs = false;
  ProgramResult result = choose_and_plan(std::move(plain), task, as_programmed, tell);
  if (options.deadline.over() && result.verification.feasible) {
    result.compensation = "arcs are commanded as programmed: the time limit ended before a plan that widens them";
    return result;
  }
  ProgramResult widened = choose_and_plan(std::move(file), task, options, tell);
  if (!result.verification.feasible || (widened.verification.feasible && widened.cycle_time <= result.cycle_time))
    return widened;
  result.compensation = compensation_note(result, widened);
  result.solver.wall_time += widened.solver.wall_time;
  return result;
}

}  // namespace accdec
