#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include <accdec/gcode/number.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/gcode/words.hpp>

namespace accdec {
namespace {

std::string printable(char c) {
  if (c > ' ' && c < '\x7f') return fmt::format("'{}'", c);
  return fmt::format("byte {:#04x}", static_cast<unsigned char>(c));
}

[[noreturn]] void refuse(const LineSource& source, char c, std::size_t column) {
  switch (c) {
    case '#': needs_interpreter(source, column, "parameters (#)");
    case '[':
    case ']': needs_interpreter(source, column, "expressions ([ ])");
    case '@':
    case '^': needs_interpreter(source, column, "polar coordinates (@ ^)");
    case ')': source.fail(column, "')' without its '('");
    case '/': source.fail(column, "'/' deletes a block only as its first character");
    case '%': source.fail(column, "'%' must stand alone on its line");
    case '-':
    case '+':
    case '.':
    case '0':
    case '1':
    case '2':
    case '3':
    case '4':
    case '5':
    case '6':
    case '7':
    case '8':
    case '9': source.fail(column, "a number without its letter");
    default: source.fail(column, printable(c) + " is no word of a program");
  }
}

bool blank(char c) {
  return c == ' ' || c == '\t';
}
bool of_number(char c) {
  return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
}

/// Reads the number at p, which may contain blanks, and moves p after it.
bool read_spaced_number(const char*& p, const char* end, double& value) {
  std::string digits;
  const char* q = p;
  for (; q != end && (blank(*q) || of_number(*q)); ++q) {
    if (!blank(*q)) digits += *q;
  }
  const char* d = digits.data();
  if (!read_number(d, digits.data() + digits.size(), value) || d != digits.data() + digits.size()) return false;
  p = q;
  return true;
}

/// As read_number, but ignores blanks.
bool read_word_number(const char*& p, const char* end, double& value) {
  const char* const start = p;
  if (read_number(p, end, value)) {
    if (p == end || !blank(*p)) return true;
    const char* q = p;
    while (q != end && blank(*q)) ++q;
    if (q == end || !of_number(*q)) return true;
    p = start;
  }
  return p != end && of_number(*p) && read_spaced_number(p, end, value);
}

/// The comment that begins at a bracket of the line, with its brackets.
std::string_view bracketed(LineSource& source, std::string_view line, std::size_t from) {
  const std::size_t end = line.find_first_of("()", from + 1);
  if (end == line.npos) source.fail(from + 1, "comment without its ')'");
  if (line[end] == '(') source.fail(end + 1, "'(' inside a comment");
  return line.substr(from, end + 1 - from);
}

/// O and the digits after it, if only comments follow; else empty.
std::string_view program_number(std::string_view line) {
  const std::size_t digits = std::min(line.find_first_not_of("0123456789", 1), line.size());
  const std::size_t next = line.find_first_not_of(" \t", digits);
  const bool alone = digits > 1 && (next == line.npos || line[next] == '(' || line[next] == ';');
  return alone ? line.substr(0, digits) : std::string_view();
}

}  // namespace

void needs_interpreter(const LineSource& source, std::size_t column, const std::string& what) {
  throw NeedsInterpreter(source.name(), source.line_number(), column, "LinuxCNC's interpreter is needed for " + what);
}

void Words::add_code(LineSource& source, char letter, double value, std::size_t column) {
  const double tenths = std::round(value * 10.0);
  if (std::abs(value * 10.0 - tenths) > 1e-6 || tenths < 0.0 || tenths > 9999.0)
    source.fail(column, fmt::format("{}{} is not supported", letter, value));
  std::size_t& count = letter == 'G' ? g_count_ : m_count_;
  if (count == codes_max) source.fail(column, "more than 16 codes in a block");
  (letter == 'G' ? g_ : m_)[count++] = {static_cast<int>(tenths), static_cast<std::uint32_t>(column)};
}

void Words::add_word(LineSource& source, char letter, double value, std::size_t column) {
  const std::uint32_t bit = letter_bit(letter);
  if ((present_ & bit) != 0U) source.fail(column, fmt::format("word {} twice in a block", letter));
  present_ |= bit;
  value_[static_cast<std::size_t>(letter - 'A')] = value;
  column_[static_cast<std::size_t>(letter - 'A')] = static_cast<std::uint32_t>(column);
}

std::size_t Words::first_column(std::uint32_t letters) const {
  std::size_t column = SIZE_MAX;
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    if ((present_ & letters & letter_bit(letter)) != 0U && this->column(letter) < column) column = this->column(letter);
  }
  return column;
}

LineKind scan_words(LineSource& source, std::string_view line, Words& words) {
  words.clear();
  const char* const begin = line.data();
  const char* const end = begin + line.size();
  const char* p = begin;
  bool first = true;
  const auto column = [&](const char* at) { return static_cast<std::size_t>(at - begin) + 1; };
  while (p != end) {
    const char c = *p;
    if (c == ' ' || c == '\t') {
      ++p;
      continue;
    }
    const char letter = static_cast<char>(c & ~0x20);
    if (letter < 'A' || letter > 'Z') {
      if (c == ';') {
        words.comments_.push_back(line.substr(static_cast<std::size_t>(p - begin)));
        break;
      }
      if (c == '(') {
        const std::string_view comment = bracketed(source, line, static_cast<std::size_t>(p - begin));
        words.comments_.push_back(comment);
        p += comment.size();
        first = false;
        continue;
      }
      if (first && c == '/') return LineKind::empty;
      if (first && c == '%' && line.find_first_not_of(" \t", static_cast<std::size_t>(p + 1 - begin)) == line.npos)
        return LineKind::percent;
      refuse(source, c, column(p));
    }
    if (letter == 'N' && !first) source.fail(column(p), "N numbers a line: it must be its first word");
    first = false;
    const char* const word = p++;
    while (p != end && (*p == ' ' || *p == '\t')) ++p;
    if (letter == 'O') {
      words.label_ = program_number(line.substr(static_cast<std::size_t>(word - begin)));
      // With anything before or after it, it is an O word of the interpreter: a loop or a subroutine.
      if (words.label_.empty() || begin + line.find_first_not_of(" \t") != word)
        needs_interpreter(source, column(word), "O words");
      p = words.label_.data() + words.label_.size();
      continue;
    }
    double value = 0.0;
    if (!read_word_number(p, end, value)) {
      if (p != end && (*p == '#' || *p == '[')) refuse(source, *p, column(p));
      source.fail(column(word), fmt::format("word {} has no number from -1e12 to 1e12", letter));
    }
    if (letter == 'G' || letter == 'M')
      words.add_code(source, letter, value, column(word));
    else
      words.add_word(source, letter, value, column(word));
  }
  return words.present_ == 0U && words.g_count_ == 0 && words.m_count_ == 0 ? LineKind::empty : LineKind::words;
}

}  // namespace accdec
