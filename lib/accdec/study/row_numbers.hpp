#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

#include <accdec/study/point_columns.hpp>

namespace accdec::study {

/// A number of a raw record, to so many significant digits; null where it is not finite.
inline Row rounded(double x, int digits) {
  if (!std::isfinite(x)) return nullptr;
  return std::stod(fmt::format("{:.{}g}", x, digits));
}
/// Twelve: what lies beyond is the rounding of unit conversions, and 59.00000000000001 ms reads badly.
inline Row number(double x) {
  return rounded(x, 12);
}
inline Row seconds(double x) {
  return rounded(x, 5);
}

}  // namespace accdec::study
