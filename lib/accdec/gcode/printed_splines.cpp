#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/gcode/modal_groups.hpp>
#include <accdec/gcode/number.hpp>
#include <accdec/gcode/printed_splines.hpp>
#include <accdec/gcode/spline_words.hpp>

namespace accdec {
namespace {

constexpr std::string_view mark = "accdec spline G";
constexpr std::string_view digits = "0123456789.";

/// Behind the bracket that closes the one at i.
std::size_t brackets_end(std::string_view s, std::size_t i) {
  int depth = 0;
  for (; i < s.size(); ++i) {
    if (s[i] == '[') ++depth;
    if (s[i] == ']' && --depth == 0) return i + 1;
  }
  return s.npos;
}

/// Behind the value at i as rs274 reads one: a number, an expression, a parameter, or a function of one.
std::size_t value_end(std::string_view s, std::size_t i) {
  if (i >= s.size()) return s.npos;
  if (s[i] == '+' || s[i] == '-') return value_end(s, i + 1);
  if (s[i] == '[') return brackets_end(s, i);
  if (s.substr(i).starts_with("#<")) {
    const std::size_t end = s.find('>', i);
    return end == s.npos ? end : end + 1;
  }
  if (s[i] == '#') return value_end(s, i + 1);
  const std::size_t number = std::min(s.find_first_not_of(digits, i), s.size());
  if (number > i) return number;
  const std::size_t end = brackets_end(s, s.find('[', i));
  // ATAN[..]/[..]
  return end != s.npos && s.substr(end).starts_with("/[") ? brackets_end(s, end + 1) : end;
}

struct Word {
  char letter;
  std::string_view value;
};

/// The words of a line but its assignments; none if it is not understood.
std::vector<Word> split(std::string_view s) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < s.size();) {
    const bool assignment = s[i] == '#';
    if (assignment) {
      i = value_end(s, i);
      if (i >= s.size() || s[i] != '=') return {};
    }
    const std::size_t end = value_end(s, i + 1);
    if (end == s.npos || (!assignment && (s[i] < 'A' || s[i] > 'Z'))) return {};
    if (!assignment) words.push_back({s[i], s.substr(i + 1, end - i - 1)});
    i = end;
  }
  return words;
}

/// A code in tenths if it is written as a number; else -1.
int tenths_of(std::string_view value) {
  const char* begin = value.data();
  double number = 0.0;
  if (!read_number(begin, value.data() + value.size(), number) || begin != value.data() + value.size()) return -1;
  return number >= 0.0 && number < 1000.0 ? static_cast<int>(std::lround(10.0 * number)) : -1;
}

/// A quick look for G5 to G5.3.
bool may_be_spline(std::string_view text) {
  for (std::size_t g = text.find('G'); g != text.npos; g = text.find('G', g + 1)) {
    const std::size_t digit = text.find_first_not_of('0', g + 1);
    if (digit != text.npos && text[digit] == '5') return true;
  }
  return false;
}

const Word* find(const std::vector<Word>& words, char letter) {
  const auto at = std::find_if(words.begin(), words.end(), [&](const Word& word) { return word.letter == letter; });
  return at == words.end() ? nullptr : &*at;
}

/// A line that keeps the values of these words, and a message that names them.
struct Kept {
  std::string assignments, message;

  void add(const std::vector<Word>& words, std::string_view letters) {
    for (const char letter : letters) {
      const Word* const word = find(words, letter);
      if (word == nullptr) continue;
      assignments += fmt::format("#<accdec_{}>={}", letter, word->value);
      message += fmt::format(" {0}#<accdec_{0}>", letter);
    }
  }
};

}  // namespace

std::vector<std::string> lines_with_spline(const std::string& text, std::string_view line, const std::string& number,
                                           bool& open) {
  if (!open && !may_be_spline(text)) return {};
  const std::vector<Word> words = split(text);
  int code = open ? 52 : -1;
  std::string ends;  // words that end the program or stop it, which would come before the message
  std::string others;
  for (const Word& word : words) {
    const int tenths = word.letter == 'G' || word.letter == 'M' ? tenths_of(word.value) : -1;
    if (word.letter == 'G' && is_spline(tenths)) code = tenths;
    const bool end = word.letter == 'M' && tenths >= 0 && m_group(tenths) == m_stop;
    (end ? ends : others) += fmt::format("{}{}", word.letter, word.value);
  }
  const auto has = [&](char letter) { return find(words, letter) != nullptr; };
  Kept kept;
  open = code == 52;
  if (code == 52) {
    kept.add(words, "XYPL");
    if (kept.assignments.empty()) return {};
    return {number + kept.assignments, fmt::format("{}(debug,{}5.2{} A#<_absolute>)", number, mark, kept.message),
            number + std::string(line)};
  }
  const bool cubic = code == 50 && has('P') && has('Q') && has('I') == has('J');
  if (!cubic && !(code == 51 && has('I') && has('J'))) return {};
  kept.add(words, cubic ? "IJPQ" : "IJ");
  std::vector<std::string> lines{number + kept.assignments, number + (ends.empty() ? std::string(line) : others)};
  if (text.find('=') != text.npos && !ends.empty()) return {};
  lines.push_back(fmt::format("{}(debug,{}5.{}{} X#<_x> Y#<_y>)", number, mark, cubic ? 0 : 1, kept.message));
  if (!ends.empty()) lines.push_back(number + ends);
  return lines;
}

void PrintedSplines::feed(std::size_t column) {
  leave();
  if (!open_.empty()) return close(column);
  waiting_ = {column, static_cast<std::int64_t>(source_.line_number())};
}

void PrintedSplines::leave() {
  if (waiting_.column == 0) return;
  source_.stands_for(waiting_.line);  // that of the call, not of what comes now
  unknown(waiting_.column);
}

void PrintedSplines::unknown(std::size_t column) const {
  source_.fail(
      column,
      "rs274 prints G5 to G5.3 (NURBS_FEED) without their control points: give the program itself. Its splines "
      "are read where their words stand in it, not in subroutines that have files of their own");
}

PrintedSplines::Numbers PrintedSplines::numbers_of(std::string_view text) {
  Numbers numbers;
  const char* const end = text.data() + text.size();
  for (const char* p = text.data(); p != end;) {
    const char letter = *p++;
    double value = 0.0;
    if (letter == ' ' || !read_number(p, end, value)) continue;
    (letter == 'X'   ? numbers.x
     : letter == 'Y' ? numbers.y
     : letter == 'I' ? numbers.i
     : letter == 'J' ? numbers.j
     : letter == 'P' ? numbers.p
     : letter == 'Q' ? numbers.q
     : letter == 'L' ? numbers.l
                     : numbers.absolute) = value;
  }
  return numbers;
}

void PrintedSplines::message(std::string_view text) {
  const std::size_t at = text.find(mark);
  if (at == text.npos) return;
  text.remove_prefix(at + mark.size());
  const std::string_view code = text.substr(0, text.find(' '));
  const Numbers numbers = numbers_of(text.substr(code.size()));
  if (code == "5.2") return control_point(numbers);
  if (waiting_.column == 0 || !numbers.x || !numbers.y) return;
  curve(numbers, code == "5.0");
  waiting_ = {};
}

ControlPoint PrintedSplines::point(double x, double y, double weight) const {
  ProgramPoint program = position_.here();
  program[0] = x;
  program[1] = y;
  const ProgramPoint machine = position_.frame().to_machine(program);
  return {machine[0], machine[1], weight};
}

void PrintedSplines::curve(const Numbers& numbers, bool cubic) {
  const double unit = state_.unit;
  ProgramPoint to = position_.here();
  const double x = to[0], y = to[1];
  const double i = numbers.i.value_or(next_i_.value_or(0.0)) * unit;
  const double j = numbers.j.value_or(next_j_.value_or(0.0)) * unit;
  std::vector<ControlPoint> control{{state_.position[0], state_.position[1]}, point(x + i, y + j)};
  to[0] = *numbers.x * unit;
  to[1] = *numbers.y * unit;
  if (cubic) {
    control.push_back(point(to[0] + numbers.p.value_or(0.0) * unit, to[1] + numbers.q.value_or(0.0) * unit));
    next_i_ = -numbers.p.value_or(0.0);
    next_j_ = -numbers.q.value_or(0.0);
  }
  const ProgramPoint end = position_.machine_of(to);
  control.push_back({end[0], end[1]});
  position_.go_unprinted(to);
  state_.spline(control, cubic ? 4 : 3, waiting_.column);
}

void PrintedSplines::control_point(const Numbers& numbers) {
  if (numbers.absolute != 1.0) source_.fail(1, "control points of G5.2 are absolute: G90 must come first");
  const bool with_point = numbers.x && numbers.y;
  if (open_.empty()) {
    order_ = 3;
    open_.push_back({state_.position[0], state_.position[1], with_point ? 1.0 : numbers.p.value_or(1.0)});
  }
  if (numbers.l) order_ = std::max(3, static_cast<int>(*numbers.l));
  if (!with_point) return;
  open_.push_back(point(*numbers.x * state_.unit, *numbers.y * state_.unit, numbers.p.value_or(1.0)));
  last_ = position_.here();
  last_[0] = *numbers.x * state_.unit;
  last_[1] = *numbers.y * state_.unit;
}

void PrintedSplines::close(std::size_t column) {
  if (static_cast<int>(open_.size()) < order_) unknown(column);
  const ProgramPoint end = position_.machine_of(last_);
  open_.back().x = end[0];
  open_.back().y = end[1];
  position_.go_unprinted(last_);
  state_.spline(open_, order_, column);
  open_.clear();
}

}  // namespace accdec
