#pragma once

#include <string>

#include <accdec/program.hpp>

namespace accdec {

/// The settings and the in-position width, to be set. @param result  with settings
std::string program_settings_in_words(const ProgramResult& result);

/// The answer for the user of a control: what to set, the time and what was looked at, the saving against today.
/// @param result  with settings; of its plan, the time
std::string program_settings_answer(const ProgramResult& result);

/// The setting of a control that takes free taps, for ProgramResult::taps_control; empty for other tasks.
std::string control_of_taps(const Task& task);

/// The answer for a control that takes the taps of plan fixed. @param result  its delays and times
std::string program_taps_answer(const ProgramResult& result);

/// The answer of a program's result, a line: settings, or the taps that a control takes. Empty for a plan that does not
/// hold, and for tasks that name no control.
std::string program_answer(const ProgramResult& result);

}  // namespace accdec
