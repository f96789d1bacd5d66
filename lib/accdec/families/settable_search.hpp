#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/task.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {

/// The best that a task's settings allow.
struct SettableDesign {
  std::optional<ChosenSettings> chosen;  ///< none: no member of any family holds all limits within the task's orders
  KindDelays delays;
  double cost = unlimited;  ///< samples, see objective.hpp
  bool complete = false;    ///< all families were searched to the end
  long tried = 0;           ///< filters built
};

/// Searches every family that the task's settings name, all members of every order within the task's bounds, each with
/// the cheapest delays of the kinds named. Members are left out by lower bounds on the cost alone. Members of few
/// stages come first, so that time that ends early leaves none of these out. Among equal costs count the fewest stages,
/// then the first family, then the lowest order. The answer is not simulated, and free taps are not a family here.
/// @param task     with settings that name a family; its own filter, if any, is ignored
/// @param seconds  of wall time
/// @param cancel   ends the search as the time does; null: nothing does
SettableDesign best_settings(const Task& task, double seconds = unlimited, const std::atomic<bool>* cancel = nullptr);

/// The lengths that step, cap or set of a stage allow, samples, rising; without that of a stage that is off.
/// @param most  samples: longer ones are left out
std::vector<int> settable_lengths(const SettableStage& stage, double period, int most);

/// Settings of stages in a controller's words, off stages as 0. @param lengths  samples, one a stage; 0: off
std::vector<Setting> values_of(const ControllerSettings& settings, const std::vector<int>& lengths, double period);

/// The times between a shaper's impulses that can be set, samples, rising. They are whole samples, or those of all
/// frequencies of the control's step.
/// @param task  with a shaper  @param order_max  no filter is longer
std::vector<double> shaper_delays(const Task& task, int order_max);

/// The frequency to which a filter's shaper is set. @param filter  with a shaper that these settings allow
Setting shaper_setting(const ControllerSettings& settings, const FilterSpec& filter, double period);

}  // namespace accdec
