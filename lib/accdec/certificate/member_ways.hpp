#pragma once

#include <algorithm>
#include <vector>

#include <accdec/certificate/member_limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/corner_feed.hpp>

// Internal to the room: how a member of a family may pass corners, for the check of proof::FamilyEnumeration.

namespace accdec {

/// The ways to pass each corner with one member: a delay, or `at_part` more than a multiple of the step of corner
/// feeds.
class Ways {
 public:
  static constexpr int at_part = 1 << 30;

  Ways(const Task& task, const Task& granted, const FamilyMember& member, const MemberLimits& limits)
      : task_(task),
        granted_(granted),
        limits_(limits),
        longest_(limits.longest_delay()),
        parts_(kind(DelayKind::corner_feed) ? corner_feed_multiples(task.settings->corner_feed_step) : 0),
        lead_(corner_feed_lead(member.order(), Response(task.machine, task.sample_period).order())),
        known_(task.corners.size(), std::vector<State>(static_cast<std::size_t>(longest_ + parts_) + 1)) {}

  bool kind(DelayKind wanted) const { return task_.settings->names(wanted); }
  bool any_delay() const {
    return task_.settings->delays.empty() || kind(DelayKind::dwell) || kind(DelayKind::timed_axis);
  }
  /// Whether a corner may be passed at a part of the feed.
  bool slows(std::size_t j) const { return parts_ > 0 && task_.corners[j].delay.value_or(0) == 0; }

  int longest() const { return longest_; }               ///< from here on, longer delays change nothing
  int largest_part() const { return at_part + parts_; }  ///< the cheapest of the parts
  double part_of(int way) const { return way > at_part ? (way - at_part) * task_.settings->corner_feed_step : 1.0; }
  double samples_of(int way) const { return way > at_part ? corner_feed_loss(part_of(way), lead_) : way; }
  int apart() const { return limits_.command_order(); }  ///< the delay of an exact stop

  bool holds(std::size_t j, int way) {
    State& state = known(j, way);
    if (state == State::unseen) {
      const bool broken = way > at_part ? limits_.broken_by_corner_feed(granted_.corners[j], part_of(way))
                                        : limits_.broken_by_blend(granted_.corners[j], std::min(way, longest_));
      state = broken ? State::shut : State::open;
    }
    return state == State::open;
  }
  /// The first of these delays that holds, if it is below `most`; -1: none.
  int first_held(std::size_t j, int first, int last, double most) {
    for (int d = first; d <= last && d < most; ++d) {
      if (holds(j, d)) return d;
      if (too_slow_from(j, d)) return -1;
    }
    return -1;
  }
  bool too_slow_from(std::size_t j, int delay) const { return limits_.too_slow_from(granted_.corners[j], delay); }
  void shut(std::size_t j, int way) { known(j, way) = State::shut; }

 private:
  enum class State : signed char { unseen, shut, open };
  State& known(std::size_t j, int way) {
    return known_[j][static_cast<std::size_t>(way > at_part ? longest_ + way - at_part : std::min(way, longest_))];
  }

  const Task& task_;
  const Task& granted_;
  const MemberLimits& limits_;
  int longest_, parts_, lead_;
  std::vector<std::vector<State>> known_;  ///< of each corner and way
};

}  // namespace accdec
