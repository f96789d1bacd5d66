#pragma once

#include <cstdio>
#include <string>

namespace accdec::cli {

/// Whether a stream is a terminal that takes escape sequences (TERM is set and not "dumb").
bool is_terminal(std::FILE* stream);

/// Whether to colour what goes to a stream: on terminals, unless NO_COLOR is set to anything (no-color.org).
bool is_coloured(std::FILE* stream);

/// A text with its status line coloured: `optimal` green, `feasible` yellow, `infeasible` and `failed` red.
std::string with_coloured_status(std::string text);

}  // namespace accdec::cli
