#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace accdec {

/// An error in a program, with its place. what() is "file:line:column: message"; lines and columns count from 1.
class ReadError : public std::invalid_argument {
 public:
  ReadError(const std::string& file, std::int64_t line, std::size_t column, const std::string& message)
      : std::invalid_argument(file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + message),
        line_(line),
        column_(column) {}
  std::int64_t line() const { return line_; }
  std::size_t column() const { return column_; }

 private:
  std::int64_t line_;
  std::size_t column_;
};

/// Only an interpreter of the whole language understands this: parameters, expressions, O words, cycles, offsets.
class NeedsInterpreter : public ReadError {
 public:
  using ReadError::ReadError;
};

}  // namespace accdec
