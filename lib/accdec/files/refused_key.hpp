#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace accdec {

/// A key of the task that is valid, but not for what was asked of it. Who has the task's file can name the place.
class RefusedKey : public std::invalid_argument {
 public:
  /// @param keys  its name, or those that may have caused it
  RefusedKey(const std::string& message, std::vector<std::string> keys)
      : std::invalid_argument(message), keys_(std::move(keys)) {}
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  std::vector<std::string> keys_;
};

}  // namespace accdec
