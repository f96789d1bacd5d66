#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/gcode/arc_sequence.hpp>

namespace accdec {
namespace {

/// Whether the second arc goes on along the circle or helix of the first, up to the digits of programs.
bool same_circle(const Arc& a, const Arc& b) {
  constexpr double digits = 1e-6;  // m
  const auto radius = [](const Arc& arc, const ProgramPoint& p) {
    return std::hypot(p[arc.first] - arc.center_first, p[arc.second] - arc.center_second);
  };
  const double r = radius(a, a.to);
  bool same = a.first == b.first && a.second == b.second && a.angle * b.angle > 0.0 && r > 1e3 * digits &&
              std::hypot(a.center_first - b.center_first, a.center_second - b.center_second) <= digits;
  for (const auto& [arc, point] : {std::pair{&a, &a.from}, std::pair{&b, &b.to}})
    same = same && std::abs(radius(*arc, *point) - r) <= digits;
  for (std::size_t i = 0; i < program_axis_count && same; ++i) {
    if (i == a.first || i == a.second) continue;
    const double slope = (a.to[i] - a.from[i]) / a.angle - (b.to[i] - b.from[i]) / b.angle;
    same = std::abs(slope) <= digits;
  }
  return same;
}

}  // namespace

void ArcSequence::begin(const Arc& arc, int chords) {
  goes_on_ = after_arc_ && same_circle(arc_, arc);
  arc_ = arc;
  chords_ = chords;
  distance_ = chord_distance(arc, chords);
}

}  // namespace accdec
