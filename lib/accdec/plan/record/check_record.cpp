#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/filter_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/gcode/emitted_filters.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/record/check_record.hpp>
#include <accdec/plan/record/program_comparison.hpp>
#include <accdec/plan/report/plan_facts.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/other_rules.hpp>
#include <accdec/plan/run/todays_time.hpp>
#include <accdec/plan/verify/motion_proof.hpp>
#include <accdec/plan/verify/program_departure.hpp>
#include <accdec/plan/verify/verify_delay_kinds.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {
namespace {

void compare_names(const ProgramRecord& record, std::vector<std::string>& reasons) {
  if (record.result.program == record.inputs.program) return;
  reasons.push_back(
      fmt::format("program is recorded as {}, inputs.program as {}", record.result.program, record.inputs.program));
}

/// Whether a plan with one filter has none of the settings that its task asks for. A program that --emit wrote may have
/// brought its filter along.
/// @param programmed  null: not read again
bool lacks_settings(const ProgramRecord& record, const Toolpath* programmed) {
  const auto& control = record.task.settings;
  if (!control || !control->names_family() || record.result.settings || record.result.plan.command() == nullptr)
    return false;
  return !record.inputs.reading.dwells_before_filter || (programmed != nullptr && !emitted_filter(*programmed));
}

/// s; no plan at the programmed feeds comes near. Ten times what a stop after every move takes, at half the feeds that
/// the filter surely starts and stops. The plan may have longer or shorter chords of arcs. A control that cannot stop
/// at will lowers its feeds until its delays do, to a hundredth if need be.
double slowest_at_kept_feeds(const Toolpath& programmed, const Filter& filter, const Task& task,
                             const Machine& machine) {
  const double sample_period = task.sample_period, latency = task.settings ? task.settings->in_position_latency : 0.0;
  const BlendLimits limits(filter, machine, sample_period);
  const std::size_t n = programmed.dimensions();
  std::vector<double> velocity(n);
  double time = programmed.dwells();
  for (std::size_t b = 0; b < programmed.blocks(); ++b) {
    const double* p = programmed.point(b);
    for (std::size_t a = 0; a < n; ++a) velocity[a] = (p[n + a] - p[a]) / programmed.duration[b];
    time += 2.0 * programmed.duration[b] / limits.start_factor(velocity.data());
  }
  for (const auto& [block, delay] : programmed.given_delays) time += delay;
  const double stop = (filter.order() + 2.0) * sample_period + latency;
  const bool stops_at_will =
      !task.settings || task.settings->any_delay() || task.settings->names(DelayKind::exact_stop);
  return (stops_at_will ? 10.0 : 1000.0) * (time + stop * static_cast<double>(programmed.blocks() + 1));
}

/// Estimates of other controls' times follow from the program and what they were asked with.
void estimate_again(const ProgramRecord& record, const Toolpath& programmed, ProgramResultCheck& check) {
  for (const ControlEstimate& asked : record.result.estimates) {
    std::map<std::string, double> given;
    for (const ControlParameter& one : asked.parameters) {
      if (one.from == "given") given[one.name] = one.value;
    }
    try {
      check.found.estimates.push_back(estimate_time(programmed, record.task.machine, asked.control, given));
    } catch (const std::invalid_argument& error) {
      check.reasons.push_back(fmt::format("estimates: {}", error.what()));
    }
  }
}

/// Finds again how much the multipliers of the bound for any motion prove, by code that did not seek them.
/// @returns s; 0 without multipliers, or with wrong ones
double check_motion_proof(const ProgramRecord& record, const Toolpath& programmed, std::vector<std::string>& reasons) {
  if (!record.result.corner_bound || record.result.corner_bound->proofs.empty()) return 0.0;
  const CornerBound& bound = *record.result.corner_bound;
  const Machine machine = program_machine(record.task.machine, programmed);
  try {
    const double proved = proved_time(programmed, machine, record.result.sample_period, bound.proofs);
    if (!(std::abs(proved - bound.proved) <= 1e-9 * proved))
      reasons.push_back(fmt::format("any_motion_proof.time_s is recorded as {:.12g}, its multipliers prove {:.12g}",
                                    bound.proved, proved));
    if (proved > bound.any_motion * (1.0 + 1e-6))
      reasons.push_back(
          fmt::format("bounds: any motion is recorded as {:.12g} s, but any_motion_proof proves {:.12g} s",
                      bound.any_motion, proved));
    return proved;
  } catch (const std::invalid_argument& error) {
    reasons.push_back(fmt::format("any_motion_proof: {}", error.what()));
    return 0.0;
  }
}

/// Holds the commands against the program, and makes what is recorded of it again.
void compare_with_program(const ProgramRecord& record, Toolpath programmed, ProgramResultCheck& check) {
  const ProgramInputs& in = record.inputs;
  if (const std::string wrong = departs_from(record.result.plan.path, programmed); !wrong.empty())
    check.reasons.push_back(fmt::format("the commands are not those of {}: {}", in.program, wrong));
  else if (record.task.settings)
    check_corner_feeds(record.result, record.task, programmed, check.reasons);
  estimate_again(record, programmed, check);
  ProgramResult& found = check.found;
  found.programmed_blocks = blocks_of(programmed);
  found.programmed_moves = programmed.blocks();
  found.feeds_chosen = record.result.feeds_chosen;
  const bool stepped = found.plan.path.blocks() != programmed.blocks();
  if (found.feeds_chosen ? !in.reading.clamp_feeds : stepped)
    check.reasons.push_back("the recorded feeds (chosen or programmed) are not those of the commands");
  found.plan.path.clamped = programmed.clamped;
  const Machine machine = program_machine(record.task.machine, programmed);
  if (found.plan.command() != nullptr) {
    const Filter& filter = found.plan.filter();
    // The recorded time is held against this, see program_differences.
    found.cycle_time_kept = slowest_at_kept_feeds(programmed, filter, record.task, machine);
    snap_durations(programmed, filter, found.sample_period, machine);
  }
  found.lower_bound = program_lower_bound(programmed, machine, found.sample_period);
  if (record.filter_bound) found.filter_bound = filter_lower_bound(programmed, machine, found.sample_period);
}

/// How many corners count for a bound of any motion, which is known before any linear program. None for arcs, which may
/// have been read again, finer.
/// @param programmed  as read: any motion waits at no end of a block
std::optional<CornerBound> counted_corners(const ProgramRecord& record, const Toolpath& programmed) {
  if (!programmed.arcs.empty() || programmed.blocks() > several_plans_max) return std::nullopt;
  return program_corner_bound(programmed, program_machine(record.task.machine, programmed), record.result.sample_period,
                              Deadline(0.0));
}

/// If the feeds are the programmed ones, the times that other rules for delays take follow from the commands.
void find_other_rules(const ProgramRecord& record, ProgramResult& found) {
  const FilteredCommand* command = found.plan.command();
  if (command == nullptr || record.filters || record.result.feeds_chosen) return;
  const Machine machine = program_machine(record.task.machine, found.plan.path);
  OtherRules times = other_rules(found.plan.path, command->filter, found.sample_period, machine);
  found.cycle_time_no_delay = times.no_delay;
  found.cycle_time_exact_stop = times.exact_stop;
  found.exact_stop_breaks = std::move(times.breaks);
}

/// Holds the time of today's setting against a plan with it.
class TodayCheck {
 public:
  TodayCheck(const ProgramRecord& record, const std::optional<Toolpath>& programmed, const Deadline& until)
      : result_(record.result), name_(result_.settings ? "settings.today_s" : "today_s") {
    if (!result_.today) return;
    if (!record.task.settings || todays_filter(record.task) == nullptr)
      reason_ = name_ + " is recorded, but the task names no setting of today";
    else if (result_.settings && result_.settings->is_today)
      compare(result_.cycle_time);
    else if (programmed && *result_.today >= result_.cycle_time)
      plan_again(record, *programmed, until);
    else  // one that is faster than the answer may be of a plan that a time limit cut short
      skipped_ = name_;
  }

  void tell(std::vector<std::string>& reasons, ProgramDifferences& compared, std::string& shown) const {
    if (!reason_.empty()) reasons.push_back(reason_);
    if (!skipped_.empty()) compared.skipped.push_back(skipped_);
    shown += shown_;
  }

 private:
  void plan_again(const ProgramRecord& record, const Toolpath& programmed, const Deadline& until) {
    const Feeds asked = record.inputs.reading.clamp_feeds ? Feeds::choose : Feeds::keep;
    const TodaysTime again = todays_time(programmed, record.task, asked, until, until);
    if (again.cut) {
      skipped_ = name_;
      return;
    }
    compare(again.time);
    if (reason_.empty() && again.breaks != result_.today_breaks)
      reason_ = fmt::format("today_breaks is recorded as \"{}\", planned again it is \"{}\"", result_.today_breaks,
                            again.breaks);
    shown_ = again.time < unlimited ? fmt::format("; planned again with today's setting, {:.6g} s", again.time)
                                    : fmt::format("; planned again with today's setting, which breaks {}",
                                                  again.breaks.empty() ? "a limit" : again.breaks);
  }

  void compare(double found) {
    const double recorded = *result_.today;
    if (recorded == found || std::abs(recorded - found) <= 1e-9 * found) return;
    const auto seconds = [](double time) {
      return time < unlimited ? fmt::format("{:.9g}", time) : std::string("null (no plan holds)");
    };
    reason_ = fmt::format("{} is recorded as {}, planned again it is {}", name_, seconds(recorded), seconds(found));
  }

  const ProgramResult& result_;
  std::string name_, reason_, skipped_, shown_;
};

/// Members that cannot be checked without the output of rs274, which is not kept.
const std::vector<std::string> of_the_program{"blocks",        "straight_moves", "feeds",     "feeds_clamped",
                                              "lower_bound_s", "filter_bound_s", "estimates", "arcs"};

RecordCheck with(std::vector<std::string> reasons, ProgramDifferences compared, std::string shown,
                 double proved_bound = 0.0) {
  reasons.insert(reasons.end(), compared.reasons.begin(), compared.reasons.end());
  return {std::move(reasons), std::move(compared.skipped), std::move(shown), proved_bound};
}

RecordCheck check_plan(std::string_view text, const ProgramRecord& record, std::optional<Toolpath> programmed,
                       const Deadline& until) {
  const TodayCheck today(record, programmed, until);
  ProgramResult result = record.result;
  std::vector<std::string> reasons;
  const double proved = programmed ? check_motion_proof(record, *programmed, reasons) : 0.0;
  std::optional<CornerBound> corners;
  if (programmed) corners = counted_corners(record, *programmed);
  if (programmed && result.settings && record.task.settings) mark_waits(*programmed, result.plan.path.control);
  if (programmed) take_arcs(result.plan.path, *programmed);
  ProgramResultCheck check = verify_program_result(result, record.task, record.filters);
  check.found.task_machine = record.task.machine;
  check.found.corner_bound = std::move(corners);
  check.reasons.insert(check.reasons.end(), reasons.begin(), reasons.end());
  compare_names(record, check.reasons);
  if (lacks_settings(record, programmed ? &*programmed : nullptr))
    check.reasons.emplace_back("the task asks for settings, none are recorded");
  if (record.result.plan.path.tolerance.back() < unlimited || record.result.errors.back() != 0.0)
    check.reasons.emplace_back("no move follows the last block: its tolerance must be null, and its error 0");
  std::vector<std::string> skip;
  if (!programmed) skip = of_the_program;
  // The plan of a filter a leg is made no more: its delays are compared with the tolerances, not with others.
  if (record.filters)
    skip.insert(skip.end(),
                {"leg_filters", "cycle_time_one_filter_s", "corners.exact_stops", "corners.raised_by_overlap"});
  if (programmed) compare_with_program(record, std::move(*programmed), check);
  if (record.schema == ProgramSchema::program_2) find_other_rules(record, check.found);
  check.found.worst_shown = record.result.worst_shown;
  check.found.today = record.result.today;
  check.found.today_breaks = record.result.today_breaks;
  check.found.taps_control = record.result.taps_control;
  ProgramDifferences compared = program_differences(text, record, check.found, skip);
  today.tell(check.reasons, compared, check.shown);
  return with(std::move(check.reasons), std::move(compared), std::move(check.shown), proved);
}

/// As accdec.profiles/1 left room beside arcs for their chords.
void leave_room_for_arcs(Toolpath& path, double arc_tolerance) {
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double tolerance = path.tolerance[b];
    if (is_chord(path, b) || (b + 1 < path.blocks() && is_chord(path, b + 1)))
      path.tolerance[b] = std::max(0.5 * tolerance, tolerance - arc_tolerance);
  }
}

RecordCheck check_planned_again(std::string_view text, const ProgramRecord& record, Toolpath programmed) {
  leave_room_for_arcs(programmed, record.inputs.reading.read.arc_tolerance);
  std::vector<std::string> reasons;
  compare_names(record, reasons);
  const ProgramResult found = plan_profiles_of({record.inputs.program, std::move(programmed), record.task});
  ProgramDifferences compared = program_differences(text, record, found, {});
  if (!compared.reasons.empty())
    reasons.emplace_back("accdec.profiles/1 holds no motion, and the program planned again has another one:");
  return with(std::move(reasons), std::move(compared),
              fmt::format("planned again from {} and the task, {} samples, {:.6g} s: all bounds hold",
                          record.inputs.program, found.check.samples, found.cycle_time));
}

}  // namespace

RecordCheck check_program_record(std::string_view text, const ProgramRecord& record, std::optional<Toolpath> programmed,
                                 const Deadline& today) {
  if (record.schema != ProgramSchema::profiles_1) return check_plan(text, record, std::move(programmed), today);
  if (programmed) return check_planned_again(text, record, std::move(*programmed));
  return {{"accdec.profiles/1 holds no motion, and the program cannot be read to plan it again"}, {}, "", 0.0};
}

}  // namespace accdec
