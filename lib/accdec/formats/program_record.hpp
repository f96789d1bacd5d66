#pragma once

#include <string>
#include <string_view>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Where a program's result came from: enough to read the program again in the same way.
struct ProgramInputs {
  std::string program, program_hash;  ///< path and hash of the file
  std::string task_path, task_text;   ///< the task file, whole
  ToolpathOptions reading;
  bool interpreted = false;  ///< run by rs274: what was read is not the file itself
  std::string tool_table;    ///< that rs274 was given; may be empty
};

/// A result of `accdec program` read back.
struct ProgramRecord {
  ProgramInputs inputs;
  Task task;                  ///< of its text
  ProgramResult result;       ///< what `verify_program_result`, `plot_program` and exports use; the rest is empty
  bool filter_bound = false;  ///< the result has one
  bool commands = false;      ///< false: the result is too large to hold them, or older than they are
};

/// Commanded blocks up to which a result holds its commands: about 10 MB of JSON.
inline constexpr std::size_t recorded_blocks_max = 50'000;

/// `accdec.program/1` with two members more: "inputs" and, up to recorded_blocks_max, "commands": points, durations,
/// tolerances, joints, delays and errors of every commanded block, which together with the filter are the plan.
std::string program_to_json(const ProgramResult& result, const ProgramInputs& inputs);

/// `accdec.profiles/1` with "inputs": its motion has no short description, but is planned the same from them.
std::string profiles_to_json(const ProfileResult& result, const ProgramInputs& inputs);

/// Whether a file's text is a program's result.
bool is_program_result(std::string_view text);
/// Or of its plan profiles, accdec.profiles/1.
bool is_profile_result(std::string_view text);

/// For those who want one filter. @throws InputError if it is a result of plan profiles, which has none
void refuse_profiles(std::string_view text, const std::string& name);

/// @throws InputError naming what is missing, mistyped or contradicts itself
ProgramRecord parse_program_record(std::string_view text, const std::string& name);

/// Of plan profiles: inputs, task, program and status alone.  @throws InputError as parse_program_record
ProgramRecord parse_profile_record(std::string_view text, const std::string& name);

/// Hash of a file's bytes. @throws InputError if it cannot be read
std::string hash_of_file(const std::string& path);

/// The result's filter as a design, for exports.
DesignResult filter_of(const ProgramRecord& record);

}  // namespace accdec
