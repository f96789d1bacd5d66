#pragma once

#include <string>
#include <vector>

#include <accdec/design.hpp>
#include <accdec/formats/design_report.hpp>

namespace accdec {

/// An explanation in sentences and one table, for people: first what more room saves, then where limits are used to the
/// full.
/// @param samples  name them for every limit that is used to the full
std::string explanation_text(const Explanation& explanation, bool samples = false);

/// The sentences of an explanation that are the same wherever it is shown.
struct ExplanationWords {
  std::string verdict;  ///< that there is no design, and why; empty where there is one
  std::string above;    ///< the table of changes that make a design possible; empty without one
  ReportTable changes;
  std::vector<std::string> notes;  ///< below all tables
};
ExplanationWords explanation_words(const Explanation& explanation);

/// The same as `accdec.explanation/1`: times in s, values of limits in the unit of their task key. Ends with a line
/// feed.
std::string explanation_to_json(const Explanation& explanation);

}  // namespace accdec
