#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <accdec/files.hpp>

namespace accdec {

/// Several errors of one file. File, position and message are those of the first. what() has a line for each of the
/// first ten and gives the number of the others.
class InputErrors : public InputError {
 public:
  /// @param all        at least one
  /// @param unlisted  how many more there are
  /// @param at_least  there may be still more
  explicit InputErrors(std::vector<InputError> all, std::size_t unlisted = 0, bool at_least = false);

  const std::vector<InputError>& all() const { return all_; }
  std::size_t unlisted() const { return unlisted_; }
  bool at_least() const { return at_least_; }
  const char* what() const noexcept override { return lines_.c_str(); }

 private:
  std::vector<InputError> all_;
  std::size_t unlisted_;
  bool at_least_;
  std::string lines_;
};

/// The errors in the order of a file.
void sort_by_position(std::vector<InputError>& errors);

/// The errors of one file, collected to be reported together.
class Faults {
 public:
  /// Only the first `most` errors are kept.
  static constexpr std::size_t most = 100;

  void add(InputError error) {
    if (!full()) list_.push_back(std::move(error));
  }
  bool none() const { return list_.empty(); }
  std::size_t size() const { return list_.size(); }
  bool full() const { return list_.size() >= most; }
  /// Whether nothing is wrong at or below a JSON pointer.
  bool none_below(const std::string& pointer) const;

  /// Reads a part of the file unless it already has an error; keeps an error that it throws.
  template <class Read>
  void attempt(const std::string& pointer, Read read) {
    if (!none_below(pointer)) return;
    try {
      read();
    } catch (InputError& error) {
      add(std::move(error));
    }
  }

  /// @throws InputErrors with all of them, in the order of the file, if there are any
  void raise();

 private:
  std::vector<InputError> list_;
};

}  // namespace accdec
