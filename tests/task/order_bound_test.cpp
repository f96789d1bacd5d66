#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/task/order_bound.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;

TEST(OrderBound, AccelerationOnlyIsTheBoxcar) {
  for (const double limit : {3.4, 5.0, 6.0, 7.3, 15.0}) {
    Axis axis;
    axis.acceleration_max = limit;
    const Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
    EXPECT_EQ(order_lower_bound(task, 1000) + 1, static_cast<int>(std::ceil(0.1 / (limit * 1e-3) - 1e-9)));
  }
}

TEST(OrderBound, ForceWithFrictionIsTheDiscreteExponential) {
  // m (V_k - V_{k-1})/T + c V_k = F has the solution V_k = (F/c)(1 - r^k), r = 1/(1 + c T/m).
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 840.0;
  axis.force_max = 465.0;
  const double feed = 0.33;
  const Task task = plane_task(axis, plane_corner("A", 90, 0, feed, feed), 1e-4);
  const double r = 1.0 / (1.0 + axis.damping * 1e-3 / axis.mass);
  const int samples = static_cast<int>(std::ceil(std::log(1.0 - feed * axis.damping / axis.force_max) / std::log(r)));
  EXPECT_EQ(order_lower_bound(task, 1000) + 1, samples);
  const std::vector<double> taps = saturating_start(task, 1000);
  double v = 0.0;
  for (int k = 1; k < samples; ++k) {
    v += feed * taps[static_cast<std::size_t>(k - 1)];
    EXPECT_NEAR(v, axis.force_max / axis.damping * (1.0 - std::pow(r, k)), 1e-12);
  }
}

TEST(OrderBound, ForceThenPowerApproachesTheContinuousTime) {
  // tau = m V*/F + m (v^2 - V*^2)/(2 P), V* = P/F, without friction; the sampled start converges to it as T shrinks.
  Axis axis;
  axis.mass = 34.0;
  axis.force_max = 465.0;
  axis.power_max = 140.0;
  const double feed = 0.5, knee = axis.power_max / axis.force_max;
  const double tau =
      axis.mass * knee / axis.force_max + axis.mass * (feed * feed - knee * knee) / (2.0 * axis.power_max);
  Task task = plane_task(axis, plane_corner("A", 90, 0, feed, feed), 1e-4);
  for (const double period : {1e-3, 1e-4, 1e-5}) {
    task.sample_period = period;
    // The sampled power F[k] V[k] charges the speed at the end of each sample: later by less than one sample per
    // knee-to-feed ratio.
    EXPECT_NEAR(order_lower_bound(task, 100000) * period, tau, 3.0 * period);
  }
}

TEST(OrderBound, FastestStartHoldsItsLimits) {
  std::mt19937 rng(23);
  int checked = 0;
  for (int round = 0; round < 300; ++round) {
    Task task = testing::random_task(rng, 1);
    const std::vector<double> taps = saturating_start(task, 2000);
    if (taps.empty()) continue;
    const Corner& corner = task.corners[0].geometry();
    // Only the start: leg 2 is left out by giving it hardly any speed.
    const Corner start = make_corner(corner.direction_in, corner.direction_in, corner.feed_in, 1e-9);
    for (Axis& axis : task.machine.axes) axis.jerk_max = axis.regeneration_max = unlimited;
    for (const LimitUse& use : axis_utilisation(Filter(taps), start, 10000, task.sample_period, task.machine)) {
      if (use.event != Event::start) continue;
      EXPECT_LE(use.utilisation, 1.0 + 1e-9) << to_string(use.kind);
    }
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace accdec
