#include <cmath>

#include <accdec/gcode/move_sink.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

double length(const ProgramPoint& from, const ProgramPoint& to, std::size_t first) {
  const double x = to[first] - from[first], y = to[first + 1] - from[first + 1], z = to[first + 2] - from[first + 2];
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

double feed_duration(const ProgramPoint& from, const ProgramPoint& to, double feed) {
  for (const std::size_t first : {0U, 6U, 3U}) {
    const double l = length(from, to, first);
    if (l > 0.0) return l / feed;
  }
  return 0.0;
}

bool rotary_only(const ProgramPoint& from, const ProgramPoint& to) {
  return length(from, to, 0) == 0.0 && length(from, to, 6) == 0.0 && length(from, to, 3) > 0.0;
}

}  // namespace accdec
