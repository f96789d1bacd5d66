#pragma once

#include <string>

#include <accdec/task.hpp>

namespace accdec {

/// Why no setting of a control gives a filter, by the filter's shape, the families, stages, steps and caps of the
/// control: "averages of 9 ms, 9 ms and 3 ms, and the control has 2 averages". Empty: a setting gives it, or it is taps
/// of no known shape. A shaper may be off.
/// @param period  s, of samples
std::string not_of_control(const ControllerSettings& control, const FilterSpec& filter, double period);

/// The same of today's setting, as a sentence of an answer with a blank before it. Empty: nothing to say.
std::string today_not_of_control(const ControllerSettings& control, const FilterSpec& today, double period);

}  // namespace accdec
