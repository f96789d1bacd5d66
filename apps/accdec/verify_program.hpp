#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/plan/record/program_record.hpp>

#include "command.hpp"

namespace accdec::cli {

/// `accdec verify` of a result of `accdec program`: makes the motion of its plan again, and compares the plan with the
/// program's file if that has not changed.
/// @param limit  s; what is estimated to take longer is not begun, and what does take longer is not checked
/// @param spent  s of it, for reading the text
void verify_program(const std::string& text, const std::string& path, double limit, double spent, Context& context);

/// Why the files that a result was made from do not tell whether it is right; empty if they do.
std::string changed_inputs(const ProgramInputs& in);

/// The program as it was read for the result; none where rs274 ran it and is not here to run it again.
/// @param reasons  what contradicts the record is added
std::optional<Toolpath> read_again(const ProgramRecord& record, std::vector<std::string>& reasons);

}  // namespace accdec::cli
