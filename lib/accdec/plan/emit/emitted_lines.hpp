#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/gcode/line_writer.hpp>

namespace accdec {

/// The lines of a program that is written. Line numbers and comments stand with the first command of their block.
class EmittedLines : public LineWriter {
 public:
  using LineWriter::LineWriter;

  /// Keeps a line number ("N10") or a comment for the next command.
  void note(const std::string& words) {
    const bool number = words.starts_with('N');
    if (number && (!number_.empty() || !comments_.empty())) leave_notes();
    (number ? number_ : comments_).append(number ? words + " " : " " + words);
  }
  /// Writes the notes of blocks too short to be written.
  void leave_notes() {
    const std::string all = number_ + (comments_.empty() ? "" : comments_.substr(1));
    if (!all.empty()) line("{}", all.substr(0, all.find_last_not_of(' ') + 1));
    number_.clear(), comments_.clear();
  }
  /// A line with the notes of its block.
  template <class... Arguments>
  void command(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    line("{}{}{}", number_, fmt::format(format, std::forward<Arguments>(arguments)...), comments_);
    number_.clear(), comments_.clear();
  }

 private:
  std::string number_, comments_;  // of the block to come: "N10 ", " (one) (two)"
};

}  // namespace accdec
