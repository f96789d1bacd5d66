#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace accdec {

/// Appends a finite number with enough digits to read it back exactly.
inline void append_number(std::string& out, double value) {
  char digits[32];
  const std::to_chars_result written = std::to_chars(digits, digits + sizeof digits, value);
  const std::string_view text(digits, static_cast<std::size_t>(written.ptr - digits));
  out += text;
  // A whole number is written with a fraction, like all others.
  if (text.find_first_of(".e") == std::string_view::npos) out += ".0";
}

}  // namespace accdec
