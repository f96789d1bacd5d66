#include <cmath>

#include <accdec/plan/feeds/split_blocks.hpp>

namespace accdec {
namespace {

void reserve(Toolpath& path, std::size_t blocks) {
  path.points.reserve((blocks + 1) * path.dimensions());
  path.duration.reserve(blocks);
  path.tolerance.reserve(blocks);
  path.joint.reserve(blocks);
  path.line.reserve(blocks);
  path.rapid.reserve(blocks);
  path.inside_arc.reserve(blocks);
}

/// Appends the point `distance` m behind the beginning of block b.
void add_point(Toolpath& out, const Toolpath& path, std::size_t b, double distance) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double length2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) length2 += (p[n + a] - p[a]) * (p[n + a] - p[a]);
  const double part = distance / std::sqrt(length2);
  for (std::size_t a = 0; a < n; ++a) out.points.push_back(p[a] + part * (p[n + a] - p[a]));
}

}  // namespace

Toolpath split_blocks(const Toolpath& path, const std::vector<FeedPiece>& pieces) {
  const std::size_t n = path.dimensions(), count = pieces.size();
  Toolpath out;
  static_cast<ToolpathFrame&>(out) = path;
  reserve(out, count);
  std::vector<std::uint32_t> last(path.blocks());  // piece of every block
  out.points.insert(out.points.end(), path.point(0), path.point(0) + n);
  double done = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t b = pieces[i].block;
    const bool ends = i + 1 == count || pieces[i + 1].block != b;
    done += pieces[i].length;
    if (ends) {
      out.points.insert(out.points.end(), path.point(b + 1), path.point(b + 1) + n);
      done = 0.0;
      last[b] = static_cast<std::uint32_t>(i);
    } else {
      add_point(out, path, b, done);
    }
    out.duration.push_back(pieces[i].length / pieces[i].speed);
    out.tolerance.push_back(ends ? path.tolerance[b] : unlimited);
    out.joint.push_back(ends ? path.joint[b] : Joint::straight);
    out.line.push_back(path.line[b]);
    out.rapid.push_back(path.rapid[b]);
    out.inside_arc.push_back(ends ? path.inside_arc[b] : 0);
  }
  for (PathArc arc : path.arcs) {
    arc.first = arc.first > 0 ? last[arc.first - 1] + 1 : 0;
    arc.last = last[arc.last];
    out.arcs.push_back(arc);
  }
  for (const auto& [b, time] : path.dwell) out.dwell.emplace_back(last[b], time);
  for (const auto& [b, time] : path.given_delays) out.given_delays.emplace_back(last[b], time);
  for (Toolpath::KeptWords passed : path.kept_words) {
    if (passed.block > 0) passed.block = last[passed.block - 1] + 1;
    out.kept_words.push_back(std::move(passed));
  }
  for (Toolpath::Mode mode : path.modes) {
    if (mode.block > 0) mode.block = last[mode.block - 1] + 1;
    out.modes.push_back(mode);
  }
  return out;
}

}  // namespace accdec
