#pragma once

#include <string>
#include <string_view>

namespace accdec {

/// The kinds of files that commands read.
enum class InputKind { task, study, suite, result, program };

/// "a task is expected, this seems to be a result, which `accdec verify`, `plot` and `export` take". It looks for words
/// that only files of one kind have. Empty if the text has words of the expected kind, or of none.
std::string wrong_kind(std::string_view text, InputKind expected);

}  // namespace accdec
