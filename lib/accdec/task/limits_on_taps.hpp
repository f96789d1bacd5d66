#pragma once

#include <memory>

#include <accdec/task.hpp>

namespace accdec {

/// The task with only the limits that bind the designed taps themselves. Behind a servo, force, power, regeneration,
/// errors and smallest speeds are of the motion, which is smoother. Behind the control's own smoothing, acceleration,
/// jerk and vibration are of another filter, too. Without a response it is the task itself, which must then outlive the
/// pointer: a task of very many corners is not copied.
std::shared_ptr<const Task> limits_on_taps(const Task& task);

}  // namespace accdec
