#pragma once

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace accdec::solvers {

/// Options passed to a library by name. All are numbers.
class NativeOptions {
 public:
  /// @throws std::invalid_argument for a name not in `known`, listing those, or a value that is no number from 0 to
  /// 1e15.
  NativeOptions(const char* library, const std::map<std::string, std::string>& given,
                std::initializer_list<const char*> known) {
    for (const auto& [name, text] : given) {
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw std::invalid_argument(
            fmt::format("{} has no option \"{}\"; known are {}", library, name, fmt::join(known, ", ")));
      }
      double value = 0.0;
      const char* end = text.data() + text.size();
      if (const auto [stop, error] = std::from_chars(text.data(), end, value); error != std::errc() || stop != end) {
        throw std::invalid_argument(fmt::format("{} option \"{}\" needs a number, not \"{}\"", library, name, text));
      }
      if (!(value >= 0.0 && value < 1e15)) {
        throw std::invalid_argument(
            fmt::format("{} option \"{}\" needs a number from 0 to 1e15, not \"{}\"", library, name, text));
      }
      values_[name] = value;
    }
  }
  double get(const char* name, double otherwise) const {
    const auto found = values_.find(name);
    return found == values_.end() ? otherwise : found->second;
  }
  bool has(const char* name) const { return values_.count(name) > 0; }

 private:
  std::map<std::string, double> values_;
};

}  // namespace accdec::solvers
