#pragma once

#include <stdexcept>
#include <string>

namespace accdec {

/// Something in an input file is wrong. what() is "file:line:column: what is wrong; what is allowed", or "file: ..."
/// where no position applies (line 0: the file itself cannot be read).
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

}  // namespace accdec
