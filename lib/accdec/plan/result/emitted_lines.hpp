#pragma once

#include <iterator>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace accdec {

/// The lines of a program that is written. They are passed on in portions. Line numbers and comments stand with the
/// first command of their block.
class EmittedLines {
 public:
  explicit EmittedLines(std::ostream& out) : out_(out) {}

  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    text_.push_back('\n');
  }
  /// Whole lines.
  void append(std::string_view lines) { text_.append(lines); }

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

  /// Passes on what has gathered, if that is much.
  void pass_on() {
    if (text_.size() > 60'000) flush();
  }
  void flush() {
    out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    text_.clear();
  }

 private:
  std::ostream& out_;
  fmt::memory_buffer text_;
  std::string number_, comments_;  // of the block to come: "N10 ", " (one) (two)"
};

}  // namespace accdec
