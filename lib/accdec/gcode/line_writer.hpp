#pragma once

#include <iterator>
#include <ostream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace accdec {

/// Lines of a program that is written. They gather, and are passed on in portions.
class LineWriter {
 public:
  explicit LineWriter(std::ostream& out) : out_(out) {}

  template <class... Arguments>
  void line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
    text_.push_back('\n');
  }
  /// Whole lines.
  void append(std::string_view lines) { text_.append(lines); }

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
};

}  // namespace accdec
