#include <algorithm>

#include <accdec/estimate/segments.hpp>

namespace accdec {

std::vector<Segment> segments_of(const std::vector<ControlMove>& moves, ArcCut cut, double setting,
                                 bool rests_for_words) {
  std::vector<Segment> segments;
  for (const ControlMove& move : moves) {
    const double parts = move.arc ? std::max(1.0, cut(move, setting)) : 1.0;
    Vector from = move.from;
    for (double i = 1.0; i <= parts; ++i) {
      const Vector to = i == parts ? move.to : arc_point(move, i / parts);
      const double length = (to - from).norm();
      if (length > 0.0) segments.push_back({(to - from) / length, length, move.feed, move.rapid});
      from = to;
    }
    if (segments.empty()) continue;
    segments.back().dwell = move.dwell;
    segments.back().rests = move.dwells || move.ends || (rests_for_words && move.waits);
  }
  return segments;
}

}  // namespace accdec
