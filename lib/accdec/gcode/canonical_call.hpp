#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace accdec {

/// How the reader treats a canonical call.
enum class CallKind {
  unknown,
  followed,     ///< moves, or sets what moves depend on
  text,         ///< passed over; its argument is any text
  passed_over,  ///< does not change the path
  unsupported   ///< would change the path in a way not followed here
};

/// A canonical call found in a line; the name is empty if there is none.
struct CanonicalCall {
  std::string_view name;
  std::size_t column = 0;         ///< of the name, from 0
  std::size_t arguments = 0;      ///< index behind its '('
  std::int64_t program_line = 0;  ///< of an N word of `line_number_digits` digits, as numbered_lines writes it; else 0
};
/// More than an N word that somebody wrote has.
inline constexpr std::size_t line_number_digits = 10;

CanonicalCall find_call(std::string_view line);

/// By the list of the names that `rs274 -g` of LinuxCNC 2.9 prints (src/emc/sai/saicanon.cc).
CallKind call_kind(std::string_view name);

}  // namespace accdec
