#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/certificate/constant_feed.hpp>
#include <accdec/design.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

/// A task that holds: 0.1 m/s on both legs along x and y, friction 100 N s/m, so 10 N and 1 W at feed.
Task task_at_feed() {
  Axis axis;
  axis.mass = 30.0;
  axis.damping = 100.0;
  axis.force_max = 100.0;
  axis.power_max = 50.0;
  return testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), 50e-6);
}

TEST(ConstantFeed, WhatHoldsIsNotBroken) {
  EXPECT_EQ(broken_at_constant_feed(task_at_feed()), "");
}

// On either side of each limit, by hand: 0.1 m/s, 10 N, 1 W.
TEST(ConstantFeed, EitherSideOfEveryLimit) {
  const auto broken = [](const std::function<void(Task&, double)>& set, double value) {
    Task task = task_at_feed();
    set(task, value);
    return broken_at_constant_feed(task) != "";
  };
  const auto velocity = [](Task& t, double x) { t.machine.axes[0].velocity_max = x; };
  const auto force = [](Task& t, double x) { t.machine.axes[0].force_max = x; };
  const auto power = [](Task& t, double x) { t.machine.axes[0].power_max = x; };
  const auto speed = [](Task& t, double x) { t.corners[0].speed_min = x; };
  EXPECT_TRUE(broken(velocity, 0.0999));
  EXPECT_FALSE(broken(velocity, 0.1001));
  EXPECT_TRUE(broken(force, 9.99));
  EXPECT_FALSE(broken(force, 10.01));
  EXPECT_TRUE(broken(power, 0.999));
  EXPECT_FALSE(broken(power, 1.001));
  EXPECT_TRUE(broken(speed, 0.1001));
  EXPECT_FALSE(broken(speed, 0.0999));
}

// Legs at 45 degrees, 0.1 m/s: the axes lag by 0.1/sqrt(2) (1 - g)/Kv, or by the mean of the taps.
TEST(ConstantFeed, ServosThatDifferLeaveTheLine) {
  const auto broken = [](const std::function<void(Axis&)>& set, double contour) {
    Task task = task_at_feed();
    task.corners[0] = testing::plane_corner("A", 90, 45, 0.1, 0.1);
    task.corners[0].contour_max = contour;
    task.machine.axes[0].servo_gain = 100.0, task.machine.axes[0].velocity_feedforward = 0.5;
    set(task.machine.axes[1]);
    return broken_at_constant_feed(task) != "";
  };
  const auto ideal = [](Axis&) {};
  const auto slower = [](Axis& axis) { axis.servo_gain = 50.0; };
  const auto taps = [](Axis& axis) { axis.response_taps = {0.25, 0.25, 0.5}; };
  const auto same = [](Axis& axis) { axis.response_taps = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}; };
  for (const auto& [set, lag] :
       {std::pair<std::function<void(Axis&)>, double>{ideal, 0.0}, {slower, 0.02}, {taps, 1.25e-3}}) {
    const double off = 0.1 * std::abs(0.005 - lag) / 2.0;
    EXPECT_TRUE(broken(set, 0.9999 * off)) << lag;
    EXPECT_FALSE(broken(set, 1.0001 * off)) << lag;
  }
  EXPECT_FALSE(broken(same, 1e-9));
}

// At 1 ms the sample rate is 1000 Hz: there every filter has a response of 1.
TEST(ConstantFeed, BandsAcrossTheSampleRate) {
  const auto broken = [](double low, double high, double residual) {
    Task task = task_at_feed();
    Mode mode;
    mode.frequency_low = low;
    mode.frequency_high = high;
    mode.residual_max = residual;
    task.machine.modes.push_back(mode);
    return broken_at_constant_feed(task) != "";
  };
  EXPECT_TRUE(broken(990.0, 1010.0, 0.1));
  EXPECT_TRUE(broken(1000.0, 1000.0, 0.1));
  EXPECT_TRUE(broken(1990.0, 2000.0, 0.1));
  EXPECT_TRUE(broken(10.0, 5010.0, 0.1));
  EXPECT_FALSE(broken(990.0, 1010.0, 1.0));
  EXPECT_FALSE(broken(10.0, 999.0, 0.1));
  EXPECT_FALSE(broken(1001.0, 1999.0, 0.1));
}

// Nothing else may stand in an infeasible result, however true the infeasibility.
TEST(ConstantFeed, NonsenseBesideATrueInfeasibility) {
  Task task = task_at_feed();
  task.machine.axes[0].force_max = 9.0;
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::infeasible);
  EXPECT_TRUE(verify_result(result).accepted);
  const auto refused = [&](const std::function<void(DesignResult&)>& forge) {
    DesignResult forged = result;
    forge(forged);
    return !verify_result(forged).accepted;
  };
  EXPECT_TRUE(refused([](DesignResult& r) { r.lower_bound = 1.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.gap = 0.5; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.cycle_time = 1.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.filter = Filter({0.5, 0.5}); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.corners.resize(1); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.limits.resize(1); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.verification.feasible = true; }));
}

}  // namespace
}  // namespace accdec
