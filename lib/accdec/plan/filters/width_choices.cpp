#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/width_choices.hpp>

namespace accdec {
namespace {

/// Steps and widths closer than this part are one: no control tells them apart.
constexpr double same_width = 1e-6;

/// Joints of one step.
struct EqualSteps {
  double step = 0.0;
  std::vector<double> samples{};  // of all their delays after each wait
  std::vector<int> without{};     // how many have no delay after each wait
};

EqualSteps equal_steps(const ControlDelays& kinds, const Filter& filter, double step, const HeldJoint* first,
                       const HeldJoint* last) {
  const auto waits = static_cast<std::size_t>(filter.order()) + 1;
  EqualSteps equal{step, std::vector<double>(waits, 0.0), std::vector<int>(waits, 0)};
  for (const HeldJoint* joint = first; joint != last; ++joint) {
    for (std::size_t wait = 0; wait < waits; ++wait) {
      const auto delay = control_delay_after(kinds, filter, static_cast<int>(wait), joint->delay);
      if (delay) equal.samples[wait] += *delay;
      if (!delay) ++equal.without[wait];
    }
  }
  return equal;
}

}  // namespace

std::vector<WidthChoice> width_choices(ControlDelays kinds, const Filter& filter, std::vector<HeldJoint> joints) {
  if (joints.empty()) return {};
  std::ranges::sort(joints, {}, &HeldJoint::step);
  std::vector<EqualSteps> equal;
  struct Change {
    double width;
    std::size_t joints;
  };
  std::vector<Change> changes;
  for (std::size_t first = 0, last = 0; first < joints.size(); first = last) {
    while (last < joints.size() && joints[last].step <= joints[first].step * (1.0 + same_width)) ++last;
    const double step = joints[first].step;
    for (int d = 0; d < filter.order() && filter.remaining_moment(d) > 0.0; ++d)
      changes.push_back({step * filter.remaining_moment(d), equal.size()});
    equal.push_back(equal_steps(kinds, filter, step, joints.data() + first, joints.data() + last));
  }
  std::ranges::sort(changes, std::greater<>(), &Change::width);
  std::vector<std::size_t> waits(equal.size(), 0);
  double samples = 0.0;
  int without = 0;
  const auto add = [&](std::size_t at, int sign) {
    samples += sign * equal[at].samples[waits[at]], without += sign * equal[at].without[waits[at]];
  };
  for (std::size_t at = 0; at < equal.size(); ++at) add(at, 1);
  std::vector<WidthChoice> choices;
  const auto offer = [&](double low, double high) {
    choices.push_back({0.5 * (low + high), without > 0 ? unlimited : samples});
  };
  if (!changes.empty()) offer(changes.front().width, 2.0 * changes.front().width);
  for (std::size_t i = 0; i < changes.size();) {
    const double width = changes[i].width;
    for (; i < changes.size() && changes[i].width >= width * (1.0 - same_width); ++i) {
      const std::size_t at = changes[i].joints;
      add(at, -1), ++waits[at], add(at, 1);
    }
    offer(i < changes.size() ? changes[i].width : 0.0, width);
  }
  return choices;
}

}  // namespace accdec
