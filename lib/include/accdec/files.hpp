// Errors of input and output files, and deadlines.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <string>

namespace accdec {

/// Something in an input file is wrong. The text of what() is "file:line:column: what is wrong; what is allowed". If no
/// position applies, it is "file: ..." (line 0: the file itself cannot be read).
class InputError : public std::runtime_error {
 public:
  /// @param line, column  counted from 1; line 0: none
  /// @param pointer       JSON pointer of the offending value ("/corner/0/angle_deg"), where the input is a tree
  InputError(std::string file, long line, long column, std::string message, std::string pointer = "");

  const std::string& file() const { return file_; }
  long line() const { return line_; }
  long column() const { return column_; }
  const std::string& message() const { return message_; }
  const std::string& pointer() const { return pointer_; }

 private:
  std::string file_, message_, pointer_;
  long line_, column_;
};

/// A file could not be written; what() names it. Nothing is left behind.
class OutputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Wall clock time since then, s.
inline double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

/// A moment of wall clock after which no more work is begun, or a request to end sooner. Copies keep both.
class Deadline {
 public:
  /// Never.
  Deadline() = default;
  /// So many seconds from now.
  explicit Deadline(double seconds) : seconds_(seconds) {}
  /// Also over as soon as `asked` is true. The reference is kept: it must outlive all copies.
  void end_when(const std::atomic<bool>& asked) { asked_ = &asked; }
  /// So many seconds from now, unless this one is over sooner.
  Deadline within(double seconds) const {
    Deadline sooner(std::min(seconds, left()));
    sooner.asked_ = asked_;
    return sooner;
  }
  bool asked_to_end() const { return asked_ != nullptr && *asked_; }
  /// s; unlimited for never, below 0 once it is over.
  double left() const {
    if (asked_to_end()) return -1.0;
    return seconds_ < std::numeric_limits<double>::infinity() ? seconds_ - seconds_since(start_) : seconds_;
  }
  bool over() const { return left() < 0.0; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double seconds_ = std::numeric_limits<double>::infinity();
  const std::atomic<bool>* asked_ = nullptr;
};

}  // namespace accdec
