#pragma once

#include <string>

#include <accdec/program.hpp>

namespace accdec {

/// The answer for the user of a control: what to set, the time and what was looked at, the saving against today.
/// @param time  s, of the plan  @param has_today  whether the task names today's setting
std::string program_settings_answer(const ProgramSettings& settings, double time, bool has_today);

}  // namespace accdec
