#include <algorithm>
#include <type_traits>

#include <accdec/plan/feeds/stretches.hpp>

namespace accdec {
namespace {

/// Blocks first .. first + count - 1 as a path of their own.
Toolpath stretch_of(const Toolpath& path, std::size_t first, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(path.dimensions());
  const auto from = static_cast<std::ptrdiff_t>(first), to = from + static_cast<std::ptrdiff_t>(count);
  const auto part = [&](const auto& values) {
    return std::remove_cvref_t<decltype(values)>(values.begin() + from, values.begin() + to);
  };
  Toolpath out;
  out.axes = path.axes;
  out.points.assign(path.points.begin() + from * n, path.points.begin() + (to + 1) * n);
  out.duration = part(path.duration);
  out.tolerance = part(path.tolerance);
  out.joint = part(path.joint);
  out.line = part(path.line);
  out.rapid = part(path.rapid);
  out.inside_arc = part(path.inside_arc);
  for (PathArc arc : path.arcs) {
    // An arc cut by the stretch keeps only its chords.
    if (arc.first < first || arc.last >= first + count) continue;
    arc.first -= static_cast<std::uint32_t>(first);
    arc.last -= static_cast<std::uint32_t>(first);
    out.arcs.push_back(arc);
  }
  out.widen_arcs = path.widen_arcs;
  out.control = path.control;
  out.joint.back() = Joint::stop;
  return out;
}

}  // namespace

std::vector<Toolpath> stretches(const Toolpath& path, std::size_t whole_max) {
  if (path.blocks() <= whole_max) return {stretch_of(path, 0, path.blocks())};
  std::vector<Toolpath> parts;
  const std::size_t length = whole_max / 4, last = path.blocks() - length;
  for (std::size_t i = 0; i < 4; ++i)
    parts.push_back(stretch_of(path, std::min((2 * i + 1) * path.blocks() / 8, last), length));
  return parts;
}

}  // namespace accdec
