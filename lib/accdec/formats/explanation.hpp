#pragma once

#include <string>

#include <accdec/design.hpp>

namespace accdec {

/// An explanation in sentences and one table, for people: first what more room saves, then where limits are used to the
/// full.
/// @param samples  name them for every limit that is used to the full
std::string explanation_text(const Explanation& explanation, bool samples = false);

/// The same as `accdec.explanation/1`: times in s, values of limits in the unit of their task key. Ends with a line
/// feed.
std::string explanation_to_json(const Explanation& explanation);

}  // namespace accdec
