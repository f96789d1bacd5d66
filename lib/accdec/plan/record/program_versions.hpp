#pragma once

#include <nlohmann/json_fwd.hpp>

#include <accdec/plan/record/program_record.hpp>

namespace accdec {

/// `found`, which is accdec.program/2, with the members of an earlier schema. A file of that version is compared with
/// it member by member.
/// @param record  the file's; its `filters` say that the plan was per-leg
nlohmann::ordered_json as_written_then(nlohmann::ordered_json found, const ProgramResult& result,
                                       const ProgramRecord& record);

}  // namespace accdec
