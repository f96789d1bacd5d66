#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <accdec/program.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/direct.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The inputs of a program's result: enough to read the program again in the same way.
struct ProgramInputs {
  std::string program, program_hash;  ///< path and hash of the file
  std::string task_path, task_text;   ///< the whole task file
  ToolpathOptions reading;
  bool interpreted = false;  ///< run by rs274: the text read is not the file itself
  ProgramTools tools;        ///< that rs274 was given
};

/// Schemas of the results of `accdec program`.
enum class ProgramSchema {
  program_2,   ///< accdec.program/2
  program_1,   ///< accdec.program/1: blocks are straight moves, joints inside arcs are corners; plans fixed and per-leg
  profiles_1,  ///< accdec.profiles/1: plan profiles without its motion, which is planned again
};

/// A result of `accdec program` read back.
struct ProgramRecord {
  ProgramSchema schema = ProgramSchema::program_2;
  ProgramInputs inputs;
  Task task;             ///< of its text
  ProgramResult result;  ///< what `verify_program_result`, `plot_program` and exports use; the rest is empty
  std::optional<BlockFilters> filters;  ///< of plan per-leg, which earlier versions had
  bool filter_bound = false;            ///< the result has one
  bool commands = false;  ///< its plan is whole: false where it is too large to hold it, or the version did not
};

/// Moves up to which a result holds its plan: about 10 MB of JSON.
inline constexpr std::size_t recorded_blocks_max = 50'000;

/// `accdec.program/2` with two more members, "inputs" and, up to recorded_blocks_max, "commands". The commands have
/// points, durations, tolerances, joints and errors of every move, and delays or speeds and ramps. With the filter they
/// are the plan.
std::string program_to_json(const ProgramResult& result, const ProgramInputs& inputs);

/// The schema of a program's result; none where the text is something else.
std::optional<ProgramSchema> schema_of_program(std::string_view text);

/// @throws InputError naming the member that is missing, has a wrong type or contradicts another
ProgramRecord parse_program_record(std::string_view text, const std::string& name);

/// Hash of a file's bytes. @throws InputError if it cannot be read
std::string hash_of_file(const std::string& path);

/// The result's filter as a design, for exports; its corners are the joints without stops, with their lines and delays,
/// where the result holds its plan.
/// @throws InputError if the plan is profiles: its corners have filters of their own
DesignResult filter_of(const ProgramRecord& record, const std::string& name);

}  // namespace accdec
