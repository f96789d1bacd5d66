#include <algorithm>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/files/parse_toml.hpp>

namespace accdec::toml_input {
namespace {

constexpr int deepest = 64;

/// Where the string that opens at `at` ends: behind its closing quotes, or at the end of its line or of the text.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool many_lines = text.substr(at).starts_with(three);
  for (at += many_lines ? 3 : 1; at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"') {
      ++at;
    } else if (many_lines ? text.substr(at).starts_with(three) : text[at] == quote || text[at] == '\n') {
      at += many_lines ? 3 : 1;
      // One or two quotes may stand right before the three that close.
      for (int more = 0; many_lines && more < 2 && at < text.size() && text[at] == quote; ++more) ++at;
      return at;
    }
  }
  return text.size();
}

/// The first dot or bracket beyond the allowed depth.
std::optional<std::size_t> too_deep(std::string_view text) {
  int brackets = 0, dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at = end_of_string(text, at);
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (c == '.' && ++dots >= deepest) return at;
    if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) dots = 0;
    if ((c == '[' || c == '{') && ++brackets > deepest) return at;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    ++at;
  }
  return std::nullopt;
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& name) {
  if (const auto at = too_deep(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column,
                     fmt::format("tables or lists nest more than {} deep; no key of accdec does", deepest));
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(name, error.source().begin.line, error.source().begin.column,
                     fmt::format("not valid TOML: {}", error.description()));
  }
}

}  // namespace accdec::toml_input
