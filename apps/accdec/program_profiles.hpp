#pragma once

#include <string>
#include <vector>

#include <accdec/formats/program_record.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>

#include "command.hpp"

namespace accdec::cli {

/// Where `accdec program --plan profiles` writes; empty: nowhere, -: standard output.
struct ProfileOutputs {
  std::string json, samples, stream, page;
};

/// Plan profiles, never slower than the plans of one filter: those are `others`, and the fastest that holds is written,
/// with the times of all.
/// @param inputs      what all are made from
/// @param programmed  the path as the program has it, for the page
void write_fastest(ProfileResult profiles, std::vector<ProgramResult> others, const ProgramInputs& inputs,
                   const Toolpath& programmed, const Machine& machine, const ProfileOutputs& outputs, Context& context);

}  // namespace accdec::cli
