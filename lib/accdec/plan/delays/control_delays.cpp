#include <algorithm>
#include <cmath>
#include <deque>

#include <Eigen/Core>
#include <fmt/format.h>

#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {
namespace {

/// Whether the feed steps down before the joint inside its block, or up behind it. Chords of an arc have feeds of their
/// own.
bool lowered_beside(const Toolpath& path, std::size_t b) {
  const auto step = [&](std::size_t joint) {
    return path.line[joint] == path.line[joint + 1] && path.joint[joint] == Joint::straight &&
           path.inside_arc[joint] == 0;
  };
  return (b > 0 && step(b - 1) && commanded_feed(path, b - 1) > commanded_feed(path, b)) ||
         (b + 2 < path.blocks() && step(b + 1) && commanded_feed(path, b + 2) > commanded_feed(path, b + 1));
}

/// The kind with which the control runs on: of no samples, if it lists no other. Points inside arcs are no ends of
/// blocks, so that every control is continuous there.
DelayKind kind_without_wait(const ControlDelays& control) {
  for (const DelayKind kind : {DelayKind::continuous, DelayKind::dwell, DelayKind::timed_axis}) {
    if (control.names(kind)) return kind;
  }
  return DelayKind::continuous;
}

/// Takes the command and finds how the control holds it back at each joint.
class DelaySink {
 public:
  DelaySink(const Toolpath& path, const Filter& filter, const std::vector<int>& delays)
      : path_(path), filter_(filter), apart_(exact_stop_delay(filter)) {
    found_.kinds.assign(path.blocks(), kind_without_wait(path.control));
    found_.delays = delays;
    if (waits_at_ends(path.control)) found_.kinds.back() = path.control.kinds.front();
    std::copy_n(path.point(0), path.dimensions(), start_.begin());
  }

  void command(const AxisRow<0>&, const AxisRow<0>& u, std::int64_t count, const AxisRow<0>& end) {
    const auto kept = std::min<std::int64_t>(count, filter_.order() + 1);
    for (std::int64_t back = kept; back-- > 0;) {
      AxisRow<0> at = end;
      for (std::size_t a = 0; a < path_.dimensions(); ++a) at[a] -= static_cast<double>(back) * u[a];
      before_.push_front(at);
    }
    before_.resize(std::min(before_.size(), static_cast<std::size_t>(filter_.order()) + 1));
  }

  void joint(std::size_t b, double, std::int64_t) {
    const int delay = found_.delays[b];
    const bool passed = !ends_leg(path_, b) && delay == 0;
    if (passed || path_.joint[b] == Joint::stop) {
      if (!passed) found_.kinds[b] = DelayKind::exact_stop;
      return;
    }
    found_.kinds[b] = kind(b, delay);
  }

  CommandDelays take() {
    if (any_) found_.width = WidthInterval{low_, high_};
    return std::move(found_);
  }

 private:
  DelayKind kind(std::size_t b, int delay) {
    const ControlDelays& control = path_.control;
    if (delay == 0 && control.names(DelayKind::corner_feed) && lowered_beside(path_, b)) return DelayKind::corner_feed;
    if (delay == 0 && control.names(DelayKind::continuous)) return DelayKind::continuous;
    const bool stops = delay >= apart_ && control.names(DelayKind::exact_stop);
    if (stops && delay <= apart_ + exact_stop_more) return DelayKind::exact_stop;
    if (control.names(DelayKind::dwell)) return DelayKind::dwell;
    if (control.names(DelayKind::timed_axis)) return DelayKind::timed_axis;
    if (control.width > 0.0 && control.names(DelayKind::in_position)) {
      in_position(b);
    } else if (found_.wrong.empty()) {
      found_.wrong = fmt::format("line {}: the control cannot delay by {} samples", path_.line[b], delay);
    }
    return DelayKind::in_position;
  }

  void in_position(std::size_t b) {
    take_gone(b);
    double high = unlimited, way = way_left(0);
    int d = 0;
    for (; way > path_.control.width; way = way_left(++d)) high = std::min(high, way);
    found_.delays[b] = d + path_.control.latency;
    low_ = std::max(low_, way), high_ = std::min(high_, high);
    any_ = true;
  }

  /// From the command to the joint, of each axis and 1 to N samples before it.
  void take_gone(std::size_t b) {
    const double* joint = path_.point(b + 1);
    gone_.resize(filter_.order(), static_cast<Eigen::Index>(path_.dimensions()));
    for (Eigen::Index back = 0; back < gone_.rows(); ++back) {
      const auto sample = static_cast<std::size_t>(back) + 1;
      const AxisRow<0>& at = sample < before_.size() ? before_[sample] : start_;
      for (Eigen::Index a = 0; a < gone_.cols(); ++a) {
        const auto axis = static_cast<std::size_t>(a);
        gone_(back, a) = joint[axis] - at[axis];
      }
    }
  }

  /// m, from the filtered command to the joint after a rest of d samples.
  double way_left(int d) const {
    const Eigen::Index left = std::max(0, filter_.order() - d);
    const Eigen::Map<const Eigen::VectorXd> taps(filter_.taps().data(), filter_.order() + 1);
    double square = 0.0, longest = 0.0;  // along the path, and of one axis
    for (Eigen::Index a = 0; a < gone_.cols(); ++a) {
      const double way = taps.tail(left).dot(gone_.col(a).head(left));
      square += way * way;
      longest = std::max(longest, std::abs(way));
    }
    return path_.control.by_axis ? longest : std::sqrt(square);
  }

  const Toolpath& path_;
  const Filter& filter_;
  int apart_;
  CommandDelays found_;
  AxisRow<0> start_{};             // where the command begins
  std::deque<AxisRow<0>> before_;  // the command, the newest sample first
  Eigen::MatrixXd gone_;
  double low_ = 0.0, high_ = unlimited;
  bool any_ = false;
};

}  // namespace

CommandDelays command_delays(const Toolpath& path, const Filter& filter, double sample_period,
                             const std::vector<int>& delays) {
  std::vector<int> now = delays;
  constexpr int most_rounds = 50;
  for (int round = 0;; ++round) {
    const CommandTiming timing(path, sample_period, now);
    DelaySink sink(path, filter, now);
    emit_commands(timing, 0, path.blocks() - 1, sink);
    CommandDelays found = sink.take();
    // A delay changes what comes after it, and nothing before it: joints settle in the order of the program.
    if (found.delays == now || !found.wrong.empty()) return found;
    now = found.delays;
    if (round < most_rounds) continue;
    found.wrong = "the delays of the in-position width do not settle";
    return found;
  }
}

bool corner_feeds_had(const Toolpath& path, const Toolpath& programmed, const std::vector<int>& delays, double step) {
  if (!(step > 0.0)) return true;
  const auto multiple = [&](double part) { return part >= 1.0 - snapped_part ? 0.0 : part / step; };
  for (std::size_t b = 0, p = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] != Joint::corner) continue;
    while (programmed.joint[p] != Joint::corner) ++p;
    const auto [first, second] = corner_feed_whole(programmed, p++);
    const double in = multiple(commanded_feed(path, b) / first), out = multiple(commanded_feed(path, b + 1) / second);
    if (delays[b] > 0 || !lowered_beside(path, b)) continue;
    const double whole = std::round(in);
    if (std::abs(in - whole) > snapped_part * whole || std::abs(out - whole) > snapped_part * whole) return false;
  }
  return true;
}

}  // namespace accdec
