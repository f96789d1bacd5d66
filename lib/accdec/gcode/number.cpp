#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include <accdec/gcode/number.hpp>

namespace accdec {
namespace {

constexpr double powers[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

}  // namespace

bool read_number(const char*& p, const char* end, double& value) {
  const char* q = p;
  const bool negative = q != end && *q == '-';
  if (q != end && (*q == '-' || *q == '+')) ++q;
  const char* const start = q;
  std::uint64_t digits = 0;
  unsigned digit = 0;
  while (q != end && (digit = static_cast<unsigned>(*q) - '0') <= 9U) digits = digits * 10U + digit, ++q;
  std::ptrdiff_t count = q - start, decimals = 0;
  if (q != end && *q == '.') {
    const char* const point = ++q;
    while (q != end && (digit = static_cast<unsigned>(*q) - '0') <= 9U) digits = digits * 10U + digit, ++q;
    decimals = q - point;
    count += decimals;
  }
  if (count == 0) return false;
  double result = 0.0;
  if (count <= 15) {  // both exact as doubles, so the quotient is correctly rounded
    result = static_cast<double>(digits) / powers[decimals];
  } else if (std::from_chars(start, q, result, std::chars_format::fixed).ec != std::errc{}) {
    return false;
  }
  if (!(result <= number_max)) return false;
  value = negative ? -result : result;
  p = q;
  return true;
}

bool read_scientific(const char*& p, const char* end, double& value) {
  const char* const start = p;
  if (!read_number(p, end, value)) return false;
  if (p == end || (*p | 0x20) != 'e') return true;
  double result = 0.0;
  const auto [behind, error] =
      std::from_chars(*start == '+' ? start + 1 : start, end, result, std::chars_format::general);
  // Numbers too small for a double count as 0. Without digits the e remains, and the next reader refuses it.
  if ((error != std::errc{} && !(error == std::errc::result_out_of_range && p + 1 != end && p[1] == '-')) ||
      !(std::abs(result) <= number_max)) {
    p = start;
    return false;
  }
  value = error == std::errc{} ? result : 0.0;
  p = behind;
  return true;
}

std::string plain_number(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

}  // namespace accdec
