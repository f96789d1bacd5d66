#pragma once

#include <string>

#include <accdec/design/explain.hpp>

namespace accdec {

/// An explanation in sentences and one table, for people.
std::string explanation_text(const Explanation& explanation);

/// The same as `accdec.explanation/1`: times in s, values of limits in the unit of their task key. Ends with a line
/// feed.
std::string explanation_to_json(const Explanation& explanation);

}  // namespace accdec
