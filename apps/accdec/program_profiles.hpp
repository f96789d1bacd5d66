#pragma once

#include <string>
#include <variant>

#include <accdec/formats/program_record.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>

#include "command.hpp"

namespace accdec::cli {

/// Where `accdec program --plan profiles` writes; empty: nowhere, -: standard output.
struct ProfileOutputs {
  std::string json, samples, stream, figure;
};

/// Writes what run_fastest_plan answered.
/// @param inputs      kept in the JSON, for `accdec verify`
/// @param programmed  the path as the program has it, for the figure
void write_fastest(const std::variant<ProfileResult, ProgramResult>& fastest, const ProgramInputs& inputs,
                   const Toolpath& programmed, const Machine& machine, const ProfileOutputs& outputs, Context& context);

}  // namespace accdec::cli
