#pragma once

namespace accdec {

/// Reads [+-]digits[.digits] at p, without exponent, and moves p behind it. Correctly rounded.
/// @return false, with p unmoved, if there is no such number or it exceeds `number_max`.
bool read_number(const char*& p, const char* end, double& value);
inline constexpr double number_max = 1e12;

}  // namespace accdec
