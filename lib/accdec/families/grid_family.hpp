#pragma once

#include <string_view>

#include <accdec/filter.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// A family of a controller's filters that have a length and one real number, a multiple of the controller's step.
struct GridFamily {
  SettingFamily family;
  std::string_view number;  ///< what the number is, for people
  std::string_view unit;    ///< in which it is entered; may be empty
  double in_unit;           ///< of 1 in SI
  int least_order;          ///< without its being off
};

/// Null for families that have no such number.
const GridFamily* find_grid_family(SettingFamily family);

/// The step of the number, SI.
double grid_step(const Task& task, SettingFamily family);

/// The largest multiple of the step for filters of this order. Time constants are at most as long as the longest filter
/// within the task's orders; alpha and the cut-off have the ranges of gaussian() and blackman_sinc().
int largest_multiple(const Task& task, SettingFamily family, int order);

/// The member of an order. @param multiple  1 .. largest_multiple
FilterSpec grid_member(const Task& task, SettingFamily family, int order, int multiple);

/// Its number as it is entered.
Setting grid_setting(const Task& task, SettingFamily family, int multiple);

}  // namespace accdec
