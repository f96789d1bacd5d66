#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

namespace accdec {

/// Line and column (from 1) of a byte offset in a text.
std::pair<long, long> line_and_column(std::string_view text, std::size_t offset);

/// Offset of the value that a JSON pointer leads to in a text known to be valid JSON: the deepest one that exists on
/// the way. JSON libraries do not keep positions, so the text is walked again when a message needs one.
std::size_t locate(std::string_view json, std::string_view pointer);

/// Offset of the first key that its object already has, in a text known to be valid JSON. JSON libraries keep one of
/// the two values and do not say which.
std::optional<std::size_t> duplicate_key(std::string_view json);

/// Offset of the first bracket that opens more than 64 deep, in any text. Copies and comparisons of JSON trees recurse.
std::optional<std::size_t> json_too_deep(std::string_view text);

}  // namespace accdec
