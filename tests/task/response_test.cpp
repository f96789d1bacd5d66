#include <cmath>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/verify.hpp>

// The motion behind a servo: the simulation integrates the following error, the formulas convolve taps.

namespace accdec {
namespace {

Task one_corner(double gain, double feedforward, double angle = 95.0) {
  Task task;
  task.sample_period = 1e-3;
  task.machine.axes.resize(2);
  for (Axis& axis : task.machine.axes) axis.servo_gain = gain, axis.velocity_feedforward = feedforward;
  task.machine.axes[0].name = "x", task.machine.axes[1].name = "y";
  TaskCorner corner("A", PlanarLegs{angle * M_PI / 180.0, 0.3, Turn::left}, 0.1, 0.07);
  corner.error_max = 50e-6;
  task.corners.push_back(corner);
  return task;
}

const CornerResult measured(const Task& task, const Filter& filter, int delay) {
  std::vector<CornerResult> corners;
  verify_by_simulation(task, filter, {delay}, nullptr, &corners);
  return corners.front();
}

TEST(ResponseOfTheServo, SimulationAndConvolvedFilterAgree) {
  const Filter filter = trapezoid(30, 9);
  for (const double gain : {30.0, 200.0, 2000.0}) {
    for (const double feedforward : {0.0, 0.7}) {
      for (const double angle : {40.0, 95.0, 150.0}) {
        Task task = one_corner(gain, feedforward, angle);
        task.machine.prefilter_taps = {0.25, 0.5, 0.25};
        const FilterBehind behind(filter, task.machine, task.sample_period);
        for (const int delay : {0, 5, 25, 60}) {
          const Blend blend(behind.motion(), task.corners[0].geometry(), delay, task.sample_period);
          const CornerMeasures expected = measure(blend);
          const CornerResult found = measured(task, filter, delay);
          EXPECT_NEAR(found.corner_error, expected.corner_error, 1e-12);
          EXPECT_NEAR(found.polyline_error, expected.polyline_error, 1e-12);
          EXPECT_NEAR(found.contour_deviation, expected.contour_deviation, 1e-11);
          EXPECT_NEAR(found.speed_min, expected.speed_min, 1e-10);
        }
      }
    }
  }
}

/// At constant feed the motion is v (1 - g)/Kv behind the command.
TEST(ResponseOfTheServo, FollowsAsFarBehindAsTheGainSays) {
  const Task task = one_corner(200.0, 0.4);
  const SampledResponse sampled =
      simulate_response(boxcar(9), task.corners[0].geometry(), 10, task.sample_period, task.machine);
  const auto row = sampled.command.cruise_in;
  const double behind = (sampled.command.position.row(row) - sampled.motion().position.row(row)).norm();
  EXPECT_NEAR(behind, 0.1 * 0.6 / 200.0, 1e-15);
}

/// At constant feed the axes lag v_x/Kx and v_y/Ky: across a leg at 45 degrees that is v (1/Kx - 1/Ky)/2. It counts far
/// before the corner on leg 1, and far behind it on leg 2, although the other leg is nearer at the corner.
TEST(ResponseOfTheServo, StraightLegsLeaveTheirLinesIfServosDiffer) {
  const double off = 0.1 * (1.0 / 30.0 - 1.0 / 300.0) / 2.0, eighth = M_PI / 4.0, turn = 155.0 * M_PI / 180.0;
  for (const bool leg_2 : {false, true}) {
    Task task = one_corner(30.0, 0.0);
    task.machine.axes[1].servo_gain = 300.0;
    const PlanarLegs legs{M_PI - turn, leg_2 ? eighth - turn : eighth, Turn::left};
    task.corners[0] = leg_2 ? TaskCorner("A", legs, 0.025, 0.1) : TaskCorner("A", legs, 0.1, 0.025);
    const Filter filter = trapezoid(9, 1);
    EXPECT_NEAR(measured(task, filter, 0).contour_deviation, off, 1e-11) << leg_2;
    const FilterBehind behind(filter, task.machine, task.sample_period);
    EXPECT_NEAR(measure(behind, task.corners[0].geometry(), 0, task.sample_period).contour_deviation, off, 1e-11);
    for (const double part : {0.99, 1.01}) {
      task.corners[0].contour_max = part * off;
      EXPECT_EQ(verify_by_simulation(task, filter, {0}).feasible, part > 1.0);
    }
  }
}

/// The limits of velocity, acceleration and jerk are of the command, force and power of the motion.
TEST(ResponseOfTheServo, LoadsAreOfTheMotion) {
  Task task = one_corner(200.0, 0.0), ideal = task;
  for (Task* one : {&task, &ideal}) {
    for (Axis& axis : one->machine.axes) {
      axis.acceleration_max = 6.0, axis.jerk_max = 500.0, axis.mass = 30.0, axis.force_max = 100.0;
      if (one == &ideal) axis.servo_gain = unlimited;
    }
  }
  std::vector<LimitUse> behind, plain;
  const Filter filter = boxcar(20);
  verify_by_simulation(task, filter, {10}, &behind);
  verify_by_simulation(ideal, filter, {10}, &plain);
  ASSERT_EQ(behind.size(), plain.size());
  const FilterBehind motion(filter, task.machine, task.sample_period);
  double largest = 0.0;
  for (int i = 0; i <= motion.motion().order(); ++i) largest = std::max(largest, motion.motion().tap(i));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain[i].kind == LimitKind::acceleration || plain[i].kind == LimitKind::jerk) {
      EXPECT_NEAR(behind[i].value, plain[i].value, 1e-9 * plain[i].value);
    }
    if (plain[i].kind == LimitKind::force) {
      EXPECT_LT(behind[i].value, plain[i].value);
      EXPECT_LE(behind[i].value, 30.0 * (0.1 + 0.07) * largest / 1e-3 * (1.0 + 1e-9));
    }
  }
}

/// Behind a servo the rest of a stop falls as a^k: how long it is farther away than the tolerance is a logarithm.
TEST(ResponseOfTheServo, SettlesWhenTheTailIsWithinTheTolerance) {
  const Task task = one_corner(100.0, 0.0);
  const CornerResult found = measured(task, boxcar(0), 400);
  // Following error 0.07/100 m at the end of the command; a = exp(-0.1) a sample.
  const int samples = static_cast<int>(std::ceil(std::log(0.07 / 100.0 / 50e-6) / 0.1));
  EXPECT_NEAR(found.settling_time, samples * 1e-3, 1e-3 + 1e-12);
  Task ideal = task;
  for (Axis& axis : ideal.machine.axes) axis.servo_gain = unlimited;
  EXPECT_EQ(measured(ideal, boxcar(0), 400).settling_time, 0.0);
}

TEST(ResponseOfTheServo, SmallestDelayIsThatOfTheSimulation) {
  const Filter filter = trapezoid(24, 7);
  for (const double gain : {60.0, 200.0, 900.0}) {
    Task task = one_corner(gain, 0.2);
    for (Axis& axis : task.machine.axes) axis.acceleration_max = 9.0;
    const auto delays = delays_by_formula(filter, task, unlimited);
    ASSERT_TRUE(delays);
    EXPECT_LE(measured(task, filter, delays->front()).corner_error, 50e-6 * (1.0 + 1e-9));
    ASSERT_GT(delays->front(), 0);
    EXPECT_GT(measured(task, filter, delays->front() - 1).corner_error, 50e-6);
  }
}

}  // namespace
}  // namespace accdec
