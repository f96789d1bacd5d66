#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/files/parse_toml.hpp>

namespace accdec::toml_input {
namespace {

constexpr int deepest = 64;

/// The end of the string that opens at `at`: behind its closing quotes, or at the end of its line or of the text.
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

/// Refuses numbers that are written with digits but read as 0, such as 1e-400, and integers that no double holds, as
/// all keys read doubles.
class LostNumbers {
 public:
  LostNumbers(std::string_view text, const std::string& name) : text_(text), name_(name) {
    for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
      lines_.push_back(at + 1);
  }
  void refuse(const toml::node& node) const {
    if (const toml::table* table = node.as_table()) {
      for (const auto& [key, value] : *table) refuse(value);
    } else if (const toml::array* list = node.as_array()) {
      for (const toml::node& element : *list) refuse(element);
    } else if (node.is_floating_point() && node.as_floating_point()->get() == 0.0) {
      look(node.source().begin);
    } else if (node.is_integer() && !node.value<double>()) {
      const toml::source_position at = node.source().begin;
      throw InputError(name_, at.line, at.column,
                       "the integer has more digits than a number keeps: beyond 9007199254740992, write it with fewer "
                       "digits, such as 9.007e15");
    }
  }

 private:
  void look(const toml::source_position& at) const {
    if (at.line < 1 || at.line > lines_.size()) return;
    const std::string_view behind = text_.substr(std::min(text_.size(), lines_[at.line - 1] + at.column - 1));
    const std::string_view digits = behind.substr(0, behind.find_first_not_of("+-0123456789._"));
    if (digits.find_first_of("123456789") != std::string_view::npos)
      throw InputError(name_, at.line, at.column, "the number is too small: it cannot be told from 0; write 0");
  }

  std::string_view text_;
  const std::string& name_;
  std::vector<std::size_t> lines_{0};  // where they begin
};

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& name) {
  if (const auto at = too_deep(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column,
                     fmt::format("tables or lists nest more than {} deep; no key of accdec does", deepest));
  }
  try {
    toml::table table = toml::parse(text, name);
    LostNumbers(text, name).refuse(table);
    return table;
  } catch (const toml::parse_error& error) {
    throw InputError(name, error.source().begin.line, error.source().begin.column,
                     fmt::format("not valid TOML: {}", error.description()));
  }
}

}  // namespace accdec::toml_input
