#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/result/verify_control_delays.hpp>

namespace accdec {
namespace {

constexpr double width_rounding = 1e-7, way_rounding = 1e-9;  // of itself; m

class ControlDelayCheck {
 public:
  ControlDelayCheck(const ProgramResult& result, const Task& task, const Filter& filter, const DirectMotion& motion,
                    const std::function<void(std::string)>& wrong)
      : result_(result),
        task_(task),
        filter_(filter),
        motion_(motion),
        wrong_(wrong),
        path_(result.plan.path),
        command_(*result.plan.command()) {}

  /// Each delay is one that the task's control has, and the in-position width gives it.
  void check() const {
    if (!result_.settings || task_.settings->delays.empty()) return;
    const ChosenSettings& chosen = result_.settings->chosen;
    if (chosen.delays.size() != path_.blocks()) return wrong_("settings.delays must name a kind for every block");
    bool in_position = false;
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      const bool passed = !ends_leg(path_, b) && command_.delays[b] == 0;
      if (passed && chosen.delays[b] != DelayKind::continuous)
        wrong_(fmt::format("line {}: settings.delays names {} where the control runs on", path_.line[b],
                           to_string(chosen.delays[b])));
      if (passed || path_.joint[b] == Joint::stop) continue;
      check_kind(b, chosen.delays[b]);
      in_position = in_position || chosen.delays[b] == DelayKind::in_position;
    }
    if (in_position != chosen.width.has_value())
      wrong_("an in-position width must be recorded with joints that are in-position, and only then");
  }

 private:
  void check_kind(std::size_t b, DelayKind kind) const {
    const auto allowed = control_of(*task_.settings, 0.0).kinds;
    const int delay = command_.delays[b];
    const int apart = filter_.last_nonzero_tap() - filter_.first_nonzero_tap();
    if (std::find(allowed.begin(), allowed.end(), kind) == allowed.end())
      wrong_(fmt::format("line {}: the control has no delay of kind {}", path_.line[b], to_string(kind)));
    if ((kind == DelayKind::continuous && delay != 0) ||
        (kind == DelayKind::exact_stop && (delay < apart || delay > apart + 2)))
      wrong_(fmt::format("line {}: a delay of {} samples is not {}", path_.line[b], delay, to_string(kind)));
    if (kind == DelayKind::corner_feed && (delay != 0 || !lowered(b)))
      wrong_(fmt::format("line {}: no lower feed passes this corner without a delay", path_.line[b]));
    if (kind != DelayKind::in_position || !result_.settings->chosen.width) return;
    const WidthInterval& width = *result_.settings->chosen.width;
    double before = unlimited;
    for (int d = 0; d < delay; ++d) before = std::min(before, distance(b, d));
    if (distance(b, delay) > width.low * (1.0 + width_rounding) + way_rounding ||
        before < width.high * (1.0 - width_rounding) - way_rounding)
      wrong_(fmt::format("line {}: in-position widths from {:.9g} to {:.9g} m do not give a delay of {} samples",
                         path_.line[b], width.low, width.high, delay));
  }

  /// Whether a part of the lines that meet at the end of block b is faster than it is there.
  bool lowered(std::size_t b) const {
    std::size_t first = b, last = b + 1;
    while (first > 0 && path_.line[first - 1] == path_.line[b]) --first;
    while (last + 1 < path_.blocks() && path_.line[last + 1] == path_.line[b + 1]) ++last;
    for (std::size_t i = first; i <= last; ++i) {
      if (feed_of(i) > feed_of(i <= b ? b : b + 1)) return true;
    }
    return false;
  }
  double feed_of(std::size_t b) const {
    double square = 0.0;
    for (std::size_t a = 0; a < path_.dimensions(); ++a)
      square += std::pow((path_.point(b + 1)[a] - path_.point(b)[a]) / path_.duration[b], 2);
    return std::sqrt(square);
  }

  /// m, of the motion from the end of block b, d samples after the command has reached it.
  double distance(std::size_t b, int d) const {
    // An order later the motion has come to rest.
    const auto k = static_cast<std::size_t>(motion_.windows[b].first + std::min(d, filter_.order() + 1));
    double square = 0.0;
    for (std::size_t a = 0; a < path_.dimensions(); ++a)
      square += std::pow(motion_.position[a][k] - path_.point(b + 1)[a], 2);
    return std::sqrt(square);
  }

  const ProgramResult& result_;
  const Task& task_;
  const Filter& filter_;
  const DirectMotion& motion_;
  const std::function<void(std::string)>& wrong_;
  const Toolpath& path_;
  const FilteredCommand& command_;
};

}  // namespace

void check_control_delays(const ProgramResult& result, const Task& task, const Filter& filter,
                          const DirectMotion& motion, const std::function<void(std::string)>& wrong) {
  ControlDelayCheck(result, task, filter, motion, wrong).check();
}

}  // namespace accdec
