#pragma once

#include <string>
#include <vector>

#include <accdec/study/study_table.hpp>

// Internal to this folder: the parts of a study's page.

namespace accdec {

/// The outcome of the study, in sentences: answers, proofs, range of the times, optima cut off by the time limit.
std::string study_answer(const Study& study, const StudyTable& table);
/// Each computation's outcomes, with the shortest and longest time.
std::string study_outcomes(const Study& study, const StudyTable& table);
/// The varied quantities and their values.
std::string study_variations(const Study& study);
/// The base tasks with their limits; a varied limit says so instead of its value.
std::string study_base(const Study& study);
/// The first rows as a sortable table; columns without any value are left out.
std::string study_rows(const StudyTable& table);

}  // namespace accdec
