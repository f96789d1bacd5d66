#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <accdec/formats/json_value.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/program.hpp>

// Internal to the room: a control's settings in results of programs.

namespace accdec {

/// The time with today's setting, null if no plan with it holds. @param result  with today
nlohmann::ordered_json program_today_json(const ProgramResult& result);
void read_program_today(const Value& json, ProgramResult& result);

/// @param result  with settings
nlohmann::ordered_json program_settings_to_json(const ProgramResult& result);

/// Reads what `program_settings_to_json` wrote into the result. The filter of the settings stays empty: the result has
/// its taps. @param task  of the record @throws Mistake for what it never writes
void read_program_settings(const Value& json, const Task& task, ProgramResult& result);
/// Holds the answer in words against the result, whose commands have been read. @throws Mistake where it says another
void check_settings_answer(const Value& json, const ProgramResult& result);

}  // namespace accdec
