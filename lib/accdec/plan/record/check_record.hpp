#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/plan/record/program_record.hpp>

namespace accdec {

/// Findings of a recheck of a program's result.
struct RecordCheck {
  std::vector<std::string> reasons;  ///< why the result is not accepted; empty: it is
  std::vector<std::string> skipped;  ///< members that nobody compared
  std::string shown;                 ///< what was made again, in words
  double proved_bound = 0.0;         ///< s: no motion within the tolerances is faster, by any_motion_proof; 0: none
};

/// Makes the motion of a result's plan again (verify_program_result), holds the plan against the program, and compares
/// all that is recorded with what follows from both. A result of accdec.profiles/1 has no motion: the program is
/// planned again, and where this version plans it otherwise, that is the reason.
/// @param text        of the result  @param record  read from it, with its plan if its schema has one
/// @param programmed  the program, read as for the result; none where that is not possible: then points, tolerances,
///                    feeds and what is recorded of the program are not compared
/// @param today       ends planning the program again with today's setting of its control: its time is not compared
/// then
RecordCheck check_program_record(std::string_view text, const ProgramRecord& record, std::optional<Toolpath> programmed,
                                 const Deadline& today = {});

}  // namespace accdec
