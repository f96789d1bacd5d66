#pragma once

#include <atomic>
#include <string>

#include <accdec/design.hpp>

namespace accdec {

/// The best that the controller of a task lets its user set: filter, delays of the kinds it has, and the in-position
/// width. `optimal` means that every shorter member of every family is refuted, by code that does not share the
/// search's (proof::FamilyEnumeration). Free taps are designed beside it, for at most ten seconds, so that the result
/// says what the family costs. The task's [filter] is today's setting. It becomes the result's [baseline] unless there
/// is one. The result's savings are against it, with delays of the same kinds.
/// @param task  with settings that name a family
DesignResult design_settings(const Task& task, const DesignOptions& options);

/// Whether the control restricts filter or delays: what other controls have is no comparison then.
bool control_restricts(const Task& task);

/// The task's [filter] with the best delays that its control can give it. If a control restricts these, the result is
/// verified but not proved, and it has a message in place of a filter if no such delays hold all limits.
DesignResult design_given(Task task, const DesignOptions& options = {});

/// Adds what the task's [baseline] takes with the best delays that the controller can give it, and what is saved.
void compare_with_today(DesignResult& result);

/// Explains to people why no setting of a task holds all limits. The first part is the setting that comes closest, with
/// the limit that it breaks most. The second is the nearest that holds them, beyond steps, caps and kinds of delays. A
/// part is missing where it is not found in time, the first also where some setting holds.
std::string why_no_setting_holds(const Task& task, double seconds, const std::atomic<bool>* cancel = nullptr);

}  // namespace accdec
