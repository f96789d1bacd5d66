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

/// The lengths that step, cap or set of a stage allow, samples, rising. Off stands first: 1, as an average of one
/// sample changes nothing, or 0 of a pole.
/// @param most  samples: longer ones are left out
std::vector<int> stage_options(SettingFamily family, const SettableStage& stage, double period, int most);

/// The filter of a pole, or of averages in any order. @param lengths  samples, one a stage, as of stage_options
/// @param shaper  behind the averages; null: none  @param pair_delay  between its impulses, samples
FilterSpec settable_spec(SettingFamily family, const std::vector<int>& lengths, const ShaperInfo* shaper,
                         double pair_delay);

/// A member in the controller's words, without its delays.
/// @param lengths  samples, one a stage; 0: off  @param multiple  of the step of a real number; 0: none
ChosenSettings chosen_settings(const Task& task, SettingFamily family, const FilterSpec& filter,
                               const std::vector<int>& lengths, int multiple);

/// The times between a shaper's impulses that can be set, samples, rising. They are whole samples, or those of all
/// frequencies of the control's step.
/// @param task  with a shaper  @param order_max  no filter is longer
std::vector<double> shaper_delays(const Task& task, int order_max);

}  // namespace accdec
