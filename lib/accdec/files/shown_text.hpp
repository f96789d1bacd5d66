#pragma once

#include <string>
#include <string_view>

namespace accdec {

/// A text from a file, made safe for a terminal. Control characters other than line feed and tab are written as "\x1b",
/// so that no name moves the cursor. Characters of Unicode that reorder or break lines are written so, too.
std::string printable(std::string_view text);

/// An argument as a shell takes it: unchanged where it needs no quotes, otherwise between single ones; with control
/// characters as $'..'.
std::string shell_quoted(std::string_view argument);

/// A number above a limit with two digits, or with as many as show that it is above: "2.1", not "2", beside 2.
std::string shown_above(double value, double limit);

/// A time in ms without the last digits, which are rounding.
std::string shown_ms(double seconds);

}  // namespace accdec
