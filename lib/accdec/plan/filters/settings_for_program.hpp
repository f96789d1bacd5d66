#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/filter.hpp>
#include <accdec/plan/filters/design_program_filter.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The settings with which a program takes the least time, and what was looked at. None: no setting that was planned
/// holds all limits.
///
/// Guesses the time of the program with members of the families that the task's settings name, and plans the best
/// guesses. A guess has every corner by itself, with the in-position width that suits them together. The first plan is
/// that of today's setting, then of one that starts and stops at the highest feed within the limits. Then come members
/// all over the families, first of few orders and then of all, shorter and longer than the best guess until they only
/// lose. Steps around the best of them are halved. The best guesses are planned, then steps around the best plan whose
/// guess is better, then all the others, the nearest first. A control with widths and other kinds of delays begins with
/// the best setting without a width. A member is passed over for one of two reasons. Way over feed, the filter's length
/// and its stops alone take as long as the best plan. Or its guess with delays of any number of samples does. The work
/// left decides how many are planned.
/// @param task      with settings that name a family; its filter or baseline is today's
/// @param keep      at the programmed feeds; else feeds are chosen
/// @param effort    ends the search
/// @param tell      one line a step, may be empty
std::optional<ProgramSettings> settings_for_program(const Toolpath& path, const Task& task, bool keep, Effort effort,
                                                    const std::function<void(const std::string&)>& tell);

/// The same as a filter for the program; without settings, the message says so.
ProgramFilter settings_filter(const Toolpath& path, const Task& task, bool keep, const Effort& effort,
                              const std::function<void(const std::string&)>& tell);

/// Why the control cannot pass the program's corners: the first one that must be passed exactly (G61), by its line,
/// where the control runs on at every corner. Empty: it can.
std::string corner_without_stop(const Toolpath& path, const Task& task);

/// The filter that a task's control has today; null if the task names none. A given filter of free taps is the
/// result's.
const FilterSpec* todays_filter(const Task& task);

/// A sentence, with a blank before it: why the control has no such setting. Empty: it has, or the task names none.
std::string todays_filter_not_had(const Task& task);

/// Whether a filter is that one.
bool is_todays(const Task& task, const Filter& filter);

/// The taps of a plan as what to set: the task's own filter or today's as it is given, or any taps.
ChosenSettings taps_to_set(const Task& task, const Filter& set);

/// The in-position width, m, with which the program takes the least time with a given filter; 0 if the control has
/// none.
/// @param task  with settings
double width_for_program(const Toolpath& path, const Task& task, const Filter& filter, bool keep, Effort effort);

/// Puts two averages, or today's filter, in place of taps that were designed for delays of any number of samples. It
/// does so if the program is planned faster with them and the control's own delays. Sets the width, too.
/// @param task    with settings of free taps  @param choice  the taps; none if no filter was found
void offer_averages(const Toolpath& path, const Task& task, bool keep, Effort effort, ProgramFilter& choice);

}  // namespace accdec
