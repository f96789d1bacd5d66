#pragma once

// Debian's Emscripten (3.1.6) has a C++ library that lacks parts of C++20. The toolkit uses these. The compiler reads
// this file before every source.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace std {

inline to_chars_result to_chars(char* first, char* last, double value) {
  const auto written = fmt::format_to_n(first, last - first, "{}", value);
  const bool fits = written.size <= static_cast<size_t>(last - first);
  return {fits ? written.out : last, fits ? errc() : errc::value_too_large};
}
inline to_chars_result to_chars(char* first, char* last, double value, chars_format, int digits) {
  const auto written = fmt::format_to_n(first, last - first, "{:.{}g}", value, digits);
  return {written.out, errc()};
}
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const string text(first, last);
  char* end = nullptr;
  const bool may = !text.empty() && !isspace(static_cast<unsigned char>(text.front())) && text.front() != '+';
  const double read = may ? strtod(text.c_str(), &end) : 0.0;
  if (!may || end == text.c_str()) return {first, errc::invalid_argument};
  value = read;
  return {first + (end - text.c_str()), errc()};
}

template <class To, class From>
constexpr To bit_cast(const From& from) {
  return __builtin_bit_cast(To, from);
}

/// Whole orders, by its series.
inline double cyl_bessel_i(double order, double x) {
  double term = 1.0, sum = 0.0;
  for (int i = 1; i <= order; ++i) term *= 0.5 * x / i;
  for (int k = 0; term > 1e-17 * sum; ++k) {
    sum += term;
    term *= 0.25 * x * x / ((k + 1.0) * (k + 1.0 + order));
  }
  return sum;
}

class jthread : public thread {
 public:
  using thread::thread;
  jthread(jthread&&) = default;
  ~jthread() {
    if (joinable()) join();
  }
};

namespace ranges {

template <class Range, class Test>
bool any_of(Range&& range, Test test) {
  return std::any_of(begin(range), end(range), [&](const auto& item) { return invoke(test, item); });
}
template <class Range, class Test>
bool all_of(Range&& range, Test test) {
  return std::all_of(begin(range), end(range), [&](const auto& item) { return invoke(test, item); });
}
template <class Range, class Test>
bool none_of(Range&& range, Test test) {
  return !any_of(range, test);
}
template <class Range, class Test, class Value>
void replace_if(Range&& range, Test test, const Value& value) {
  std::replace_if(
      begin(range), end(range), [&](const auto& item) { return invoke(test, item); }, value);
}
template <class From, class To>
auto copy(From&& from, To to) {
  return std::copy(begin(from), end(from), to);
}
template <class A, class B, class Same = std::equal_to<>, class Projection = std::identity>
constexpr bool equal(A&& a, B&& b, Same same = {}, Projection of = {}) {
  auto i = begin(a);
  auto j = begin(b);
  while (i != end(a) && j != end(b) && invoke(same, invoke(of, *i), *j)) ++i, ++j;
  return i == end(a) && j == end(b);
}
template <class Range, class Value, class Projection = std::identity>
auto find(Range&& range, const Value& value, Projection of = {}) {
  return std::find_if(begin(range), end(range), [&](const auto& item) { return invoke(of, item) == value; });
}
template <class Range, class Less = std::less<>, class Projection>
auto max_element(Range&& range, Less before, Projection of) {
  return std::max_element(begin(range), end(range),
                          [&](const auto& a, const auto& b) { return invoke(before, invoke(of, a), invoke(of, b)); });
}
template <class Range>
auto max(Range&& range) {
  return *std::max_element(begin(range), end(range));
}
template <class Range, class Less = std::less<>, class Projection = std::identity>
void stable_sort(Range&& range, Less before = {}, Projection of = {}) {
  std::stable_sort(begin(range), end(range),
                   [&](const auto& a, const auto& b) { return invoke(before, invoke(of, a), invoke(of, b)); });
}
template <class Range, class Less = std::less<>>
void sort(Range&& range, Less before = {}) {
  std::sort(begin(range), end(range), before);
}
template <class Range, class Value, class Less = std::less<>, class Projection = std::identity>
auto upper_bound(Range&& range, const Value& value, Less before = {}, Projection of = {}) {
  return std::upper_bound(begin(range), end(range), value,
                          [&](const auto& v, const auto& item) { return invoke(before, v, invoke(of, item)); });
}

}  // namespace ranges
}  // namespace std
