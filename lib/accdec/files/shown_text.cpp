#include <algorithm>

#include <fmt/format.h>

#include <accdec/files/shown_text.hpp>

namespace accdec {
namespace {

/// C0 and DEL; in UTF-8 also C1, U+0080 to U+009F, which terminals obey as well.
bool is_control(std::string_view text, std::size_t i) {
  const auto c = static_cast<unsigned char>(text[i]);
  if (c < 0x20 || c == 0x7F) return true;
  return c == 0xC2 && i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xE0) == 0x80;
}

bool needs_no_quotes(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-./,:=+@%").find(c) != std::string_view::npos;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n' || text[i] == '\t' || !is_control(text, i)) {
      shown += text[i];
      continue;
    }
    shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
    if (text[i] == '\xC2') shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
  }
  return shown;
}

std::string shell_quoted(std::string_view argument) {
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), needs_no_quotes)) return std::string(argument);
  bool control = false;
  for (std::size_t i = 0; i < argument.size(); ++i) control = control || is_control(argument, i);
  std::string quoted(control ? "$'" : "'");
  for (const char c : argument) {
    const auto byte = static_cast<unsigned char>(c);
    if (control && (byte < 0x20 || byte >= 0x7F))
      quoted += fmt::format("\\x{:02x}", byte);
    else if (control && (c == '\'' || c == '\\'))
      quoted.append(1, '\\').append(1, c);
    else if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  }
  return quoted + "'";
}

}  // namespace accdec
