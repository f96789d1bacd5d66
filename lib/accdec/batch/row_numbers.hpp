#pragma once

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace accdec::batch {

/// One line of a table. Members keep their order. They are numbers, strings, or null if a value does not exist.
using Row = nlohmann::ordered_json;

/// A number of a raw record, rounded to this many significant digits; null if it is not finite.
inline Row rounded(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  // std::stod refuses numbers below 2.2e-308.
  return std::strtod(fmt::format("{:.{}g}", x, digits).c_str(), nullptr);
}
/// Twelve digits: the others are rounding of unit conversions, and 59.00000000000001 ms reads badly.
inline Row number(double x) {
  return rounded(x, 12);
}
inline Row seconds(double x) {
  return rounded(x, 5);
}

}  // namespace accdec::batch
