#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include <accdec/files/shown_text.hpp>

namespace accdec {
namespace {

bool between(std::string_view bytes, const char* first, const char* last) {
  return bytes >= std::string_view(first) && bytes <= std::string_view(last);
}

/// Bytes of the control character that begins here; 0: none does. Terminals obey C0, DEL and in UTF-8 also C1, U+0080
/// to U+009F. Others are not seen, but reorder or break lines: marks, embeddings and isolates of writing directions,
/// separators, the byte order mark.
std::size_t control_bytes(std::string_view text, std::size_t i) {
  const auto c = static_cast<unsigned char>(text[i]);
  if (c < 0x20 || c == 0x7F) return 1;
  const std::string_view two = text.substr(i, 2), three = text.substr(i, 3);
  if (two.size() == 2 && (between(two, "\xC2\x80", "\xC2\x9F") || two == "\xD8\x9C")) return 2;
  const bool unseen = between(three, "\xE2\x80\x8E", "\xE2\x80\x8F") ||
                      between(three, "\xE2\x80\xA8", "\xE2\x80\xAE") ||
                      between(three, "\xE2\x81\xA6", "\xE2\x81\xA9") || three == "\xEF\xBB\xBF";
  return three.size() == 3 && unseen ? 3 : 0;
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
    const std::size_t control = text[i] == '\n' || text[i] == '\t' ? 0 : control_bytes(text, i);
    if (control == 0) shown += text[i];
    for (std::size_t k = 0; k < control; ++k)
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i + k]));
    if (control > 0) i += control - 1;
  }
  return shown;
}

std::string shell_quoted(std::string_view argument) {
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), needs_no_quotes)) return std::string(argument);
  bool control = false;
  for (std::size_t i = 0; i < argument.size(); ++i) control = control || control_bytes(argument, i) > 0;
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

std::string shown_above(double value, double limit) {
  for (int digits = 2;; ++digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (digits == std::numeric_limits<double>::max_digits10 || std::strtod(text.c_str(), nullptr) > limit) return text;
  }
}

std::string shown_ms(double seconds) {
  return fmt::format("{:g}", std::round(seconds * 1e9) * 1e-6);
}

}  // namespace accdec
