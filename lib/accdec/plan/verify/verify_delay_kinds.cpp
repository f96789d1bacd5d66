#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/verify/verify_delay_kinds.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {
namespace {

double feed_of(const Toolpath& path, std::size_t b) {
  double square = 0.0;
  for (std::size_t a = 0; a < path.dimensions(); ++a)
    square += std::pow((path.point(b + 1)[a] - path.point(b)[a]) / path.duration[b], 2);
  return std::sqrt(square);
}

constexpr double snapped = 1e-5;  // runs are shortened to whole samples by less

/// Whether the feed steps down before the joint inside its block, or up behind it.
bool steps_beside(const Toolpath& path, std::size_t b) {
  const auto step = [&](std::size_t from, std::size_t fast, std::size_t slow) {
    return path.line[from] == path.line[from + 1] && path.joint[from] == Joint::straight &&
           path.inside_arc[from] == 0 && feed_of(path, fast) > feed_of(path, slow) * (1.0 + snapped);
  };
  return (b > 0 && step(b - 1, b - 1, b)) || (b + 2 < path.blocks() && step(b + 1, b + 2, b + 1));
}

class DelayKindsCheck {
 public:
  DelayKindsCheck(const ProgramResult& result, const Task& task, const Filter& filter,
                  std::vector<std::string>& reasons)
      : result_(result),
        path_(result.plan.path),
        command_(*result.plan.command()),
        task_(task),
        filter_(filter),
        reasons_(reasons) {}

  void run(const DirectMotion& motion) {
    if (!result_.settings || task_.settings->delays.empty()) return;
    const ChosenSettings& chosen = result_.settings->chosen;
    if (chosen.delays.size() != path_.blocks()) return wrong("settings.delays must name a kind for every block");
    bool in_position = false;
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      const bool passed = !ends_leg(path_, b) && command_.delays[b] == 0;
      if (passed && !runs_on(b, chosen.delays[b]))
        wrong(fmt::format("line {}: settings.delays names {} where the control runs on", path_.line[b],
                          to_string(chosen.delays[b])));
      if (path_.joint[b] == Joint::stop) check_stop(b);
      if (passed || path_.joint[b] == Joint::stop) continue;
      check_kind(motion, b, chosen.delays[b]);
      in_position = in_position || chosen.delays[b] == DelayKind::in_position;
    }
    if (in_position != chosen.width.has_value())
      wrong("an in-position width must be recorded with corners that are in-position, and only then");
  }

 private:
  void wrong(std::string reason) {
    if (reasons_.size() < most_reasons) reasons_.push_back(std::move(reason));
  }

  /// A stop waits until the motion behind the control's smoothing has ended, and a sample more where a limit asks.
  void check_stop(std::size_t b) {
    if (task_.settings->any_delay()) return;
    const int most = apart() + Response(task_.machine, task_.sample_period).order() + exact_stop_more;
    if (command_.delays[b] > most)
      wrong(fmt::format("line {}: the control's exact stop waits {} samples at most, not {}", path_.line[b], most,
                        command_.delays[b]));
  }
  int apart() const { return filter_.order(); }

  /// Whether a kind passes the end of block b without a wait. Points inside arcs are no ends.
  bool runs_on(std::size_t b, DelayKind kind) const {
    if (kind == DelayKind::continuous && path_.inside_arc[b] != 0) return true;
    const bool none = kind == DelayKind::continuous || kind == DelayKind::dwell || kind == DelayKind::timed_axis;
    return none && allows(kind);
  }
  bool allows(DelayKind kind) const {
    return task_.settings->names(kind) ||
           (kind == DelayKind::continuous && task_.settings->names(DelayKind::corner_feed));
  }

  void check_kind(const DirectMotion& motion, std::size_t b, DelayKind kind) {
    const int delay = command_.delays[b];
    if (!allows(kind))
      wrong(fmt::format("line {}: the control has no delay of kind {}", path_.line[b], to_string(kind)));
    if ((kind == DelayKind::continuous && delay != 0) ||
        (kind == DelayKind::exact_stop && (delay < apart() || delay > apart() + exact_stop_more)))
      wrong(fmt::format("line {}: a delay of {} samples is not {}", path_.line[b], delay, to_string(kind)));
    const bool slows = task_.settings->names(DelayKind::corner_feed);
    if (kind == DelayKind::continuous && slows && steps_beside(path_, b))
      wrong(fmt::format("line {}: a corner at a lower feed is a corner-feed, not continuous", path_.line[b]));
    if (kind == DelayKind::corner_feed && (delay != 0 || !lowered(b)))
      wrong(fmt::format("line {}: no lower feed passes this corner without a delay", path_.line[b]));
    if (kind != DelayKind::in_position || !result_.settings->chosen.width) return;
    const WidthInterval& width = *result_.settings->chosen.width;
    // The control sees the motion within the width its latency before it starts the next block.
    const double late = task_.settings->in_position_latency;
    const int seen = static_cast<int>(std::floor(delay - late / task_.sample_period + 0.5));
    if (seen < 0) {
      return wrong(
          fmt::format("line {}: a delay of {} samples is shorter than the control's in-position latency of "
                      "{:.6g} ms",
                      path_.line[b], delay, 1e3 * late));
    }
    double before = unlimited;
    for (int d = 0; d < seen; ++d) before = std::min(before, distance(motion, b, d));
    if (distance(motion, b, seen) > width.low * (1.0 + rounding) + position_rounding ||
        before < width.high * (1.0 - rounding) - position_rounding)
      wrong(fmt::format("line {}: in-position widths from {:.9g} to {:.9g} m do not give a delay of {} samples",
                        path_.line[b], width.low, width.high, delay));
  }

  /// Whether a part of the lines that meet at the end of block b is faster than it is there.
  bool lowered(std::size_t b) const {
    std::size_t first = b, last = b + 1;
    while (first > 0 && path_.line[first - 1] == path_.line[b]) --first;
    while (last + 1 < path_.blocks() && path_.line[last + 1] == path_.line[b + 1]) ++last;
    for (std::size_t i = first; i <= last; ++i) {
      if (feed_of(path_, i) > feed_of(path_, i <= b ? b : b + 1)) return true;
    }
    return false;
  }

  /// m, of the motion from the end of block b, d samples after the command has reached it: along the path, or of the
  /// axis that is farthest from it.
  double distance(const DirectMotion& motion, std::size_t b, int d) const {
    // An order later the motion has come to rest.
    const auto k = static_cast<std::size_t>(motion.windows[b].first + std::min(d, filter_.order() + 1));
    double square = 0.0, farthest = 0.0;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const double way = motion.position[a][k] - path_.point(b + 1)[a];
      square += way * way, farthest = std::max(farthest, std::abs(way));
    }
    return task_.settings->in_position_by_axis ? farthest : std::sqrt(square);
  }

  const ProgramResult& result_;
  const Toolpath& path_;
  const FilteredCommand& command_;
  const Task& task_;
  const Filter& filter_;
  std::vector<std::string>& reasons_;
};

}  // namespace

void check_delay_kinds(const ProgramResult& result, const Task& task, const Filter& filter, const DirectMotion& motion,
                       std::vector<std::string>& reasons) {
  DelayKindsCheck(result, task, filter, reasons).run(motion);
}

void check_corner_feeds(const ProgramResult& result, const Task& task, const Toolpath& programmed,
                        std::vector<std::string>& reasons) {
  const Toolpath& path = result.plan.path;
  if (!result.settings || result.settings->chosen.delays.size() != path.blocks()) return;
  std::vector<std::size_t> corners;
  for (std::size_t b = 0; b + 1 < programmed.blocks(); ++b) {
    if (programmed.joint[b] == Joint::corner) corners.push_back(b);
  }
  const auto slowed = [&](std::size_t b) {
    const DelayKind kind = result.settings->chosen.delays[b];
    return kind == DelayKind::corner_feed ||
           (kind == DelayKind::continuous && task.settings->names(DelayKind::corner_feed) && steps_beside(path, b));
  };
  std::size_t seen = 0;
  for (std::size_t b = 0; b + 1 < path.blocks() && seen < corners.size(); ++b) {
    if (path.joint[b] != Joint::corner) continue;
    const std::size_t corner = corners[seen++];
    if (!slowed(b)) continue;
    double before = feed_of(programmed, corner), behind = feed_of(programmed, corner + 1);
    // A rapid move is slowed to the feed move beside it.
    if (programmed.rapid[corner] != 0 && programmed.rapid[corner + 1] == 0) before = std::min(before, behind);
    if (programmed.rapid[corner] == 0 && programmed.rapid[corner + 1] != 0) behind = std::min(before, behind);
    const double in = feed_of(path, b) / before, out = feed_of(path, b + 1) / behind;
    const double steps = std::round(in / task.settings->corner_feed_step);
    const double part = in > 1.0 - snapped ? 1.0 : steps * task.settings->corner_feed_step;
    if (part > 0.0 && std::abs(in / part - 1.0) < snapped && std::abs(out / part - 1.0) < snapped) continue;
    if (reasons.size() >= most_reasons) return;
    reasons.push_back(fmt::format(
        "line {}: the corner is passed at {:.6g} and {:.6g} of the feeds before and behind it, which are not "
        "one multiple of corner_feed_step = {:.6g}",
        path.line[b], in, out, task.settings->corner_feed_step));
  }
}

}  // namespace accdec
