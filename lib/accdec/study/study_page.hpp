#pragma once

#include <string>
#include <vector>

#include <accdec/study/study_table.hpp>

// Internal to the room: the parts of a study's page.

namespace accdec {

/// What came of the study, in sentences: answers, proofs, range of the times, time limits that cut optima off.
std::string study_answer(const Study& study, const StudyTable& table);
/// Each computation's outcomes, with the shortest and longest time.
std::string study_outcomes(const Study& study, const StudyTable& table);
/// What is varied, and over which values.
std::string study_variations(const Study& study);
/// The base tasks with their limits; what is varied says so instead of its value.
std::string study_base(const Study& study);
/// The first rows as a table that sorts; columns without any value are left out.
std::string study_rows(const StudyTable& table);

}  // namespace accdec
