#pragma once

#include <string>

namespace accdec {

/// Reads [+-]digits[.digits] at p, without exponent, and moves p after it. Correctly rounded.
/// @return false, with p unmoved, if there is no such number or it exceeds `number_max`.
bool read_number(const char*& p, const char* end, double& value);
/// The same with an exponent, as in 1.5e+01, if there is one.
bool read_scientific(const char*& p, const char* end, double& value);
inline constexpr double number_max = 1e12;

/// A finite number as programs write it: without exponent, with at most `decimals` decimals and no trailing zeros.
std::string plain_number(double value, int decimals);

}  // namespace accdec
