#include <algorithm>
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/design/explain_solve.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::degrees;
using testing::plane_corner;
using testing::plane_task;

const Gain* gain_of(const Explanation& e, const std::string& name) {
  const auto found = std::find_if(e.gains.begin(), e.gains.end(), [&](const Gain& g) { return g.room.name == name; });
  return found == e.gains.end() ? nullptr : &*found;
}

const Remedy* remedy_of(const Explanation& e, const std::string& name) {
  const auto found =
      std::find_if(e.remedies.begin(), e.remedies.end(), [&](const Remedy& r) { return r.room.name == name; });
  return found == e.remedies.end() ? nullptr : &*found;
}

/// Straight on along x at 0.1 m/s, T = 1 ms: ceil(v/(a T)) taps and no delay are the optimum.
Task straight(double acceleration) {
  Axis axis;
  axis.acceleration_max = acceleration;
  Task task = plane_task(axis, plane_corner("A", 180, 0, 0.1, 0.1), std::nullopt);
  task.design.order_max = 80;
  return task;
}

double boxcar_time(double acceleration) {
  return 1e-3 * std::ceil(0.1 / (acceleration * 1e-3) - 1e-9);
}

TEST(Explain, AccelerationGainsWhatTheBoxcarDoes) {
  for (const double a : {3.0, 6.1, 9.99, 45.0}) {
    SCOPED_TRACE(a);
    const Explanation e = explain_task(straight(a));
    ASSERT_TRUE(e.base_proved);
    EXPECT_NEAR(e.base.objective(), boxcar_time(a), 1e-12);
    const Gain* x = gain_of(e, "acceleration x");
    ASSERT_NE(x, nullptr);
    EXPECT_NEAR(x->gain, boxcar_time(a) - boxcar_time(1.1 * a), 1e-12);
    EXPECT_TRUE(x->proved());
    EXPECT_NEAR(gain_of(e, "acceleration of all axes")->gain, x->gain, 1e-12);
    // The axis that stands still gains nothing.
    EXPECT_EQ(gain_of(e, "acceleration y")->gain, 0.0);
    EXPECT_TRUE(gain_of(e, "acceleration y")->proved());
    EXPECT_GE(e.gains.front().gain, x->gain - 1e-12);
  }
}

TEST(Explain, TheShareIsTheOptions) {
  ExplainOptions options;
  options.share = 0.5;
  const Explanation e = explain_task(straight(3.0), options);
  EXPECT_NEAR(gain_of(e, "acceleration x")->gain, boxcar_time(3.0) - boxcar_time(4.5), 1e-12);
  for (const double share : {0.0, 1.0, -0.1, std::nan("")}) {
    options.share = share;
    EXPECT_THROW(explain_task(straight(3.0), options), std::invalid_argument);
  }
}

// v = 20 a T exactly: every tap of the boxcar is at the bound, which a'[k] = v b_{k-1}/T reaches at k = 1 .. 20 of
// start and stop; straight on at equal feeds the blend has no acceleration.
TEST(Explain, SaysAtWhichSamplesALimitBinds) {
  const Explanation e = explain_task(straight(5.0));
  ASSERT_EQ(e.bindings.size(), 2U);
  std::vector<int> all(20);
  for (int k = 0; k < 20; ++k) all[static_cast<std::size_t>(k)] = k + 1;
  const Event events[] = {Event::start, Event::stop};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(e.bindings[i].kind, LimitKind::acceleration);
    EXPECT_EQ(e.bindings[i].axis, "x");
    EXPECT_EQ(e.bindings[i].event, events[i]);
    EXPECT_EQ(e.bindings[i].samples, all);
  }
}

// Corners with several limits: each row is what solving that one task by itself gives, whether it was solved or
// concluded from a larger room. The order is that of gains.
TEST(Explain, EveryGainIsThatOfSolvingAlone) {
  Axis axis;
  axis.acceleration_max = 9.0;
  axis.jerk_max = 1500.0;
  axis.mass = 30.0;
  axis.damping = 300.0;
  axis.force_max = 330.0;
  for (const double angle : {60.0, 90.0, 130.0}) {
    Task task = plane_task(axis, plane_corner("A", angle, 25, 0.12, 0.1), 40e-6);
    task.machine.axes[1].jerk_max = 1100.0;
    task.corners[0].speed_min = 0.005;
    task.design.order_max = 60;
    const Explanation e = explain_task(task);
    ASSERT_TRUE(e.base_proved) << e.base.message;
    for (const Gain& gain : e.gains) {
      SCOPED_TRACE(gain.room.name);
      Task alone = task;
      for (const Lever& lever : gain.room.levers)
        lever.set(alone, lever.kind == LimitKind::speed_min ? 0.9 * lever.value : 1.1 * lever.value);
      const DesignResult result = design_task(alone);
      ASSERT_EQ(result.status, Status::optimal);
      EXPECT_NEAR(gain.objective, result.objective(), 1e-12);
      EXPECT_NEAR(gain.gain, e.base.objective() - result.objective(), 1e-12);
      EXPECT_TRUE(gain.proved());
    }
    EXPECT_TRUE(std::is_sorted(e.gains.begin(), e.gains.end(),
                               [](const Gain& a, const Gain& b) { return a.gain > b.gain + 1e-12; }));
  }
}

TEST(Explain, ZeroHasNoTenth) {
  Task task = straight(5.0);
  task.corners[0] = plane_corner("A", 90, 0, 0.1, 0.1);
  task.corners[0].error_max = 0.0;
  const Explanation e = explain_task(task);
  ASSERT_EQ(e.not_moved.size(), 1U);
  EXPECT_EQ(e.not_moved[0].key, "corner.A.error_max_um");
  EXPECT_EQ(gain_of(e, "corner error A"), nullptr);
}

// The order is too low for the acceleration: v = a (N + 1) T says what any one of the three must be.
TEST(Explain, SmallestChangesOfABoxcarThatIsTooShort) {
  Task task = straight(5.0);
  task.design.order_max = 15;  // 20 taps are needed
  const Explanation e = explain_task(task);
  EXPECT_EQ(e.base.status, Status::infeasible);
  EXPECT_TRUE(e.base_proved);
  EXPECT_TRUE(e.gains.empty());
  const Remedy* order = remedy_of(e, "highest order");
  ASSERT_NE(order, nullptr);
  EXPECT_EQ(order->values, std::vector<double>{19.0});
  EXPECT_TRUE(order->smallest);
  // To within a thousandth of the value and four digits.
  const auto expect_value = [&](const char* name, double exact, bool upper) {
    SCOPED_TRACE(name);
    const Remedy* remedy = remedy_of(e, name);
    ASSERT_NE(remedy, nullptr);
    ASSERT_EQ(remedy->help, Remedy::Help::yes);
    EXPECT_TRUE(remedy->smallest);
    const double beyond = (upper ? 1.0 : -1.0) * (remedy->values.front() - exact) / exact;
    EXPECT_GE(beyond, -1e-9);
    EXPECT_LE(beyond, 2.0 * remedy_tolerance);
    EXPECT_NEAR(remedy->objective, 0.016, 1e-12);
  };
  expect_value("acceleration x", 0.1 / 0.016, true);
  expect_value("feeds of corner A", 5.0 * 0.016, false);
  EXPECT_EQ(remedy_of(e, "acceleration y")->help, Remedy::Help::no);
}

// The feed is above what an axis may run: nothing but that limit and the feed helps.
TEST(Explain, SmallestChangeOfAVelocityLimit) {
  Axis axis;
  axis.velocity_max = 0.08;
  axis.acceleration_max = 10.0;
  Task task = plane_task(axis, plane_corner("A", 90, 30, 0.1, 0.1), 50e-6);
  task.design.order_max = 60;
  const Explanation e = explain_task(task);
  const double most = 0.1 * std::cos(degrees(30));  // of x on leg 1 and of y on leg 2
  const Remedy* both = remedy_of(e, "velocity of all axes");
  ASSERT_EQ(both->help, Remedy::Help::yes);
  EXPECT_GE(both->values.front(), most * (1.0 - 1e-9));
  EXPECT_LE(both->values.front(), most * (1.0 + 2.0 * remedy_tolerance));
  const Remedy* feeds = remedy_of(e, "feeds of corner A");
  EXPECT_LE(feeds->values.front(), 0.08 / std::cos(degrees(30)) * (1.0 + 1e-9));
  EXPECT_GE(feeds->values.front(), 0.08 / std::cos(degrees(30)) * (1.0 - 2.0 * remedy_tolerance));
  for (const char* name : {"velocity x", "velocity y", "acceleration of all axes", "corner error A", "highest order"})
    EXPECT_EQ(remedy_of(e, name)->help, Remedy::Help::no) << name;
}

// A given filter: the tolerance needs a delay that the task does not give. d = N + 1 has no error.
TEST(Explain, AGivenDelayThatIsTooSmall) {
  Task task = plane_task(Axis{}, plane_corner("A", 90, 0, 0.1, 0.1), 0.0);
  task.filter = FilterSpec{.kind = Shape::boxcar, .order = 9};
  task.corners[0].delay = 3;
  const Explanation e = explain_task(task);
  EXPECT_EQ(e.base.status, Status::infeasible);
  // Legs of ten taps just do not overlap at d = 9: leg 1's last step ends where leg 2's first begins.
  EXPECT_EQ(remedy_of(e, "delay A")->values, std::vector<double>{9.0});
  EXPECT_EQ(remedy_of(e, "highest order"), nullptr);
  // The error of the given delay, in closed form: 2 v T cos(theta/2) E[max(i - N/2 - d/2, 0)], Eq. (24) with a delay.
  double mean = 0.0;
  for (int i = 0; i <= 9; ++i) mean += 0.1 * std::max(i - 4.5 - 1.5, 0.0);
  const double error = 2.0 * 0.1 * 1e-3 * std::cos(degrees(45)) * mean;
  const Remedy* tolerance = remedy_of(e, "corner error A");
  ASSERT_EQ(tolerance->help, Remedy::Help::yes);
  EXPECT_GE(tolerance->values.front(), error * (1.0 - 1e-9));
  EXPECT_LE(tolerance->values.front(), error + remedy_tolerance * (1e-6 + error) + 1e-3 * error);
}

// Every question is a design: of more corners than a thousand all together are asked about, not each.
TEST(Explain, ManyCornersAreAskedAboutTogether) {
  Task task = straight(6.1);
  task.corners[0].error_max = 20e-6;
  const TaskCorner one = task.corners[0];
  for (std::size_t j = 1; j <= corners_apart_max; ++j) {
    task.corners.push_back(one);
    task.corners.back().name = "c" + std::to_string(j);
  }
  const Explanation e = explain_task(task);
  ASSERT_TRUE(e.base_proved);
  EXPECT_NE(gain_of(e, "corner error at all corners"), nullptr);
  EXPECT_NEAR(gain_of(e, "acceleration x")->gain, boxcar_time(6.1) - boxcar_time(6.71), 1e-12);
  for (const Gain& gain : e.gains)
    EXPECT_EQ(gain.room.name.find("corner error c"), std::string::npos) << gain.room.name;
}

TEST(Explain, CancelledItSaysSo) {
  std::atomic<bool> cancel{false};
  ExplainOptions options;
  options.design.cancel = &cancel;
  int told = 0;
  options.progress = [&](int done, int total) {
    EXPECT_GT(total, done);
    if (++told == 2) cancel = true;
  };
  Axis axis;
  axis.acceleration_max = 9.0;
  axis.jerk_max = 1500.0;
  Task task = plane_task(axis, plane_corner("A", 90, 25, 0.12, 0.1), 40e-6);
  task.design.order_max = 60;
  const Explanation e = explain_task(task, options);
  EXPECT_FALSE(e.complete);
  EXPECT_EQ(told, 2);
  EXPECT_TRUE(e.base.filter);
}

TEST(Explain, EndsWithItsTimeLimit) {
  Axis axis;
  axis.acceleration_max = 9.0;
  axis.jerk_max = 1500.0;
  Task task = plane_task(axis, plane_corner("A", 90, 25, 0.12, 0.1), 40e-6);
  ExplainOptions options;
  options.time_limit = 1e-9;
  const Explanation e = explain_task(task, options);
  EXPECT_FALSE(e.complete);
  EXPECT_TRUE(e.gains.empty());
  EXPECT_EQ(e.solves, 1);
}

/// Nothing can be proved of servos that differ: a search for each limit would take all of its time.
TEST(Explain, UnprovedDesignsShareTheTimeOfOne) {
  Task task = straight(6.0);
  task.machine.axes[0].servo_gain = 200.0, task.machine.axes[1].servo_gain = 150.0;
  ExplainOptions options;
  options.design.time_limit = 1.0;
  const Explanation e = explain_task(task, options);
  EXPECT_EQ(e.shared, 1.0);
  EXPECT_FALSE(e.base_proved);
  EXPECT_TRUE(e.base.has_design());
  EXPECT_EQ(explain_task(straight(6.0), options).shared, 0.0);
}

/// A design is given so much longer by the clock as other programs take from it.
TEST(Explain, ALoadedMachineGivesADesignLonger) {
  EXPECT_EQ(slowdown(4.0, 2.0), 2.0);
  EXPECT_EQ(slowdown(4.0, 7.0), 1.0) << "several threads";
  EXPECT_EQ(slowdown(100.0, 1.0), 8.0) << "a machine that hardly goes on";
  EXPECT_EQ(slowdown(0.1, 0.01), 1.0) << "too short to say";
}

}  // namespace
}  // namespace accdec
