#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/design/supply_start.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"
#include "support/tries.hpp"

// Dry friction and the supply that axes share, against a simulation by plain loops.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using testing::plane_corner;
using testing::plane_task;

/// The most that a motion asks of its axes.
struct Loads {
  std::vector<double> force;  ///< N, of each axis
  double motoring = 0.0, braking = 0.0;
};

/// The command of each axis is a list of speeds, filtered tap by tap: rest, leg 1, d samples of nothing, leg 2, rest.
Loads simulated(const Task& task, const Filter& filter, int delay) {
  const Corner& corner = task.corners.front().geometry();
  const int room = filter.order() + 4, samples = 4 * room + delay;
  const double period = task.sample_period, still = 1e-9 * std::max(corner.feed_in, corner.feed_out);
  Loads loads;
  std::vector<double> total(static_cast<std::size_t>(samples), 0.0);
  for (std::size_t i = 0; i < task.machine.axes.size(); ++i) {
    const Axis& axis = task.machine.axes[i];
    const auto a = static_cast<Eigen::Index>(i);
    const auto command = [&](int k) {
      if (k >= room && k < 2 * room) return corner.feed_in * corner.direction_in[a];
      if (k >= 2 * room + delay && k < 3 * room + delay) return corner.feed_out * corner.direction_out[a];
      return 0.0;
    };
    double before = 0.0, largest = 0.0;
    for (int k = 0; k < samples; ++k) {
      double v = 0.0;
      for (int t = 0; t <= filter.order(); ++t) v += filter.tap(t) * command(k - t);
      double force = axis.mass * (v - before) / period + axis.damping * v;
      // Coulomb's law: full friction against a motion, none needed of an axis that stands and is not pushed.
      if (v > still) force += axis.coulomb;
      if (v < -still) force -= axis.coulomb;
      if (std::abs(v) <= still) {
        const double held = std::min(std::abs(force), axis.coulomb);
        force += force > 0.0 ? -held : held;
      }
      largest = std::max(largest, std::abs(force));
      total[static_cast<std::size_t>(k)] += force * v;
      before = v;
    }
    loads.force.push_back(largest);
  }
  loads.motoring = *std::max_element(total.begin(), total.end());
  loads.braking = -*std::min_element(total.begin(), total.end());
  return loads;
}

Task random_loads(std::mt19937& rng, bool reverses) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Axis axis;
  axis.mass = 15.0 + 30.0 * u(rng);
  axis.damping = 300.0 * u(rng);
  axis.force_max = 300.0 + 300.0 * u(rng);
  axis.coulomb = 20.0 + 60.0 * u(rng);
  axis.acceleration_max = 20.0;
  const double heading = reverses ? 10.0 + 70.0 * u(rng) : 0.0, angle = reverses ? 30.0 + 50.0 * u(rng) : 90.0;
  Task task = plane_task(axis, plane_corner("A", angle, heading, 0.1 + 0.15 * u(rng), 0.1 + 0.15 * u(rng)),
                         30e-6 + 100e-6 * u(rng));
  task.sample_period = 2e-3;
  return task;
}

DesignResult designed(const Task& task, double seconds) {
  DesignOptions options;
  options.time_limit = seconds;
  return design_task(task, options);
}

void expect_held(const Task& task, const DesignResult& result) {
  ASSERT_TRUE(result.has_design()) << result.message;
  const Loads loads = simulated(task, *result.filter, result.corners.front().delay);
  for (std::size_t a = 0; a < loads.force.size(); ++a)
    EXPECT_LE(loads.force[a], task.machine.axes[a].force_max * (1.0 + 2e-9));
  EXPECT_LE(loads.motoring, task.machine.power_total_max * (1.0 + 2e-9));
  EXPECT_LE(loads.braking, task.machine.regeneration_total_max * (1.0 + 2e-9));
  const ResultCheck check = verify_result(result, {});
  EXPECT_TRUE(check.accepted) << ::testing::PrintToString(check.reasons);
}

TEST(Loads, VerifierAndEvaluatorAgreeWithPlainLoops) {
  std::mt19937 rng(28);
  std::uniform_int_distribution<int> delays(0, 25);
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    Task task = random_loads(rng, i % 3 != 0);
    task.machine.power_total_max = 100.0, task.machine.regeneration_total_max = 50.0;
    const Filter filter = testing::random_filter(rng, 5 + i % 20);
    const int delay = delays(rng);
    const Loads expected = simulated(task, filter, delay);
    std::vector<LimitUse> verified;
    verify_by_simulation(task, filter, {delay}, &verified);
    const std::vector<LimitUse> evaluated =
        axis_utilisation(filter, task.corners.front().geometry(), delay, task.sample_period, task.machine, "A");
    for (const auto& uses : {verified, evaluated}) {
      int seen = 0;
      for (const LimitUse& use : uses) {
        const bool force = use.kind == LimitKind::force, motoring = use.kind == LimitKind::power_total;
        if (!force && !motoring && use.kind != LimitKind::regeneration_total) continue;
        const double value = force      ? expected.force[use.axis == "x" ? 0 : 1]
                             : motoring ? expected.motoring
                                        : expected.braking;
        EXPECT_NEAR(use.value, std::max(0.0, value), 1e-9 * (1.0 + use.value));
        ++seen;
      }
      EXPECT_EQ(seen, 4);
    }
  }
}

/// At a square corner along the axes nothing reverses: each axis starts or stops, and friction is linear.
TEST(Loads, DryFrictionOfAxesThatKeepTheirDirectionIsProved) {
  std::mt19937 rng(7);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const Task task = random_loads(rng, false);
    const DesignResult result = designed(task, 60.0);
    EXPECT_EQ(result.status, Status::optimal) << result.message;
    expect_held(task, result);
  }
}

/// Friction holds a start back by Fc: frictionless otherwise, the shortest start of an exact stop has
/// ceil(m v / ((F - Fc) T)) taps.
TEST(Loads, AnExactStopTakesTheForceThatFrictionLeaves) {
  for (const double coulomb : {0.0, 40.0, 200.0}) {
    Axis axis;
    axis.mass = 34.0, axis.force_max = 465.0, axis.coulomb = coulomb;
    Task task = plane_task(axis, plane_corner("A", 90.0, 0.0, 0.3, 0.3), 0.0);
    const DesignResult result = designed(task, 60.0);
    EXPECT_EQ(result.status, Status::optimal) << result.message;
    EXPECT_EQ(result.filter->order() + 1, static_cast<int>(std::ceil(34.0 * 0.3 / ((465.0 - coulomb) * 1e-3))));
    expect_held(task, result);
  }
}

TEST(Loads, DryFrictionOfAxesThatReverseIsProved) {
  std::mt19937 rng(9);
  for (int i = 0; i < test_support::tries(12); ++i) {
    SCOPED_TRACE(i);
    const Task task = random_loads(rng, true);
    const DesignResult result = designed(task, 60.0);
    EXPECT_EQ(result.status, Status::optimal) << result.message;
    expect_held(task, result);
  }
}

/// At 45 degrees two axes of "70 W" give 140 W back; a shared supply of 100 W allows that only to a slower stop.
TEST(Loads, ASharedSupplyHoldsAndSaysWhatIsNotProved) {
  Axis axis;
  axis.mass = 30.0, axis.damping = 100.0, axis.acceleration_max = 8.0;
  for (const double total : {20.0, 45.0}) {
    Task task = plane_task(axis, plane_corner("A", 90.0, 45.0, 0.25, 0.25), 80e-6);
    task.sample_period = 2e-3;
    const DesignResult without = designed(task, 20.0);
    task.machine.regeneration_total_max = total, task.machine.power_total_max = 2.0 * total;
    const DesignResult result = designed(task, 20.0);
    expect_held(task, result);
    EXPECT_GT(result.objective(), without.objective());
    EXPECT_EQ(result.status, Status::feasible);
    EXPECT_THAT(result.message, HasSubstr("supply"));
    ASSERT_TRUE(result.lower_bound);
  }
}

/// One axis alone takes all that a leg along it takes. So starts and stops are those of its own bound, and the design
/// with a shared supply is hardly longer than the proved one with that bound.
TEST(Loads, ASharedSupplyIsAsFastAsThatOfAnAxis) {
  Axis axis;
  axis.mass = 34.0, axis.damping = 40.0, axis.force_max = 465.0;
  Task alone = plane_task(axis, plane_corner("A", 120.0, 0.0, 0.4, 0.4), 150e-6);
  for (const double period : {2e-3, 1e-3}) {
    SCOPED_TRACE(period);
    alone.sample_period = period;
    Task shared = alone;
    shared.machine.regeneration_total_max = 70.0;
    for (Axis& each : alone.machine.axes) each.regeneration_max = 70.0;
    const DesignResult proved = designed(alone, 60.0);
    ASSERT_EQ(proved.status, Status::optimal);
    for (Axis& each : shared.machine.axes) each.regeneration_max = unlimited;
    const auto found = supply_start(shared, {}, 60.0);
    ASSERT_TRUE(found);
    expect_held(shared, *found);
    EXPECT_TRUE(verify_result(*found).accepted);
    EXPECT_LT(found->objective(), 1.03 * proved.objective());
  }
}

/// A supply that never binds changes nothing, and the proof without it is one.
TEST(Loads, ASupplyThatDoesNotBindIsProved) {
  Axis axis;
  axis.mass = 30.0, axis.acceleration_max = 6.0, axis.jerk_max = 500.0;
  Task task = plane_task(axis, plane_corner("A", 95.0, 0.0, 0.1, 0.1), 50e-6);
  const double plain = designed(task, 30.0).objective();
  task.machine.power_total_max = task.machine.regeneration_total_max = 1e4;
  const DesignResult result = designed(task, 30.0);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_NEAR(result.objective(), plain, 1e-12);
  expect_held(task, result);
}

TEST(Loads, DelaysOfAGivenFilterAreTheSmallest) {
  std::mt19937 rng(11);
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    Task task = random_loads(rng, true);
    task.machine.regeneration_total_max = 200.0;
    task.filter = FilterSpec{.kind = Shape::boxcar, .order = 45};
    const DesignResult result = designed(task, 30.0);
    if (!result.has_design()) continue;
    expect_held(task, result);
    if (result.corners.front().delay == 0) continue;
    std::vector<CornerResult> corners;
    const VerificationReport shorter =
        verify_by_simulation(task, *result.filter, {result.corners.front().delay - 1}, nullptr, &corners);
    EXPECT_FALSE(shorter.feasible);
  }
}

/// A proof with less friction than the task has is none.
TEST(Loads, AProofOfAnotherFrictionIsNone) {
  Axis axis;
  axis.mass = 34.0, axis.damping = 150.0, axis.force_max = 465.0, axis.coulomb = 150.0;
  Task task = plane_task(axis, plane_corner("A", 90.0, 0.0, 0.3, 0.3), 50e-6);
  DesignResult result = designed(task, 60.0);
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_TRUE(check_certificate(result.task, result).accepted);
  for (Axis& x : result.task.machine.axes) x.coulomb = 20.0;
  EXPECT_FALSE(check_certificate(result.task, result).accepted);
}

TEST(Loads, WholeCoefficientsHoldDryFriction) {
  Axis axis;
  axis.mass = 30.0, axis.acceleration_max = 6.0, axis.coulomb = 20.0, axis.force_max = 180.0;
  Task task = plane_task(axis, plane_corner("A", 95.0, 0.0, 0.1, 0.1), 50e-6);
  task.design.coefficient_bits = 16;
  const DesignResult result = design_task(task);
  ASSERT_TRUE(result.has_design() && result.quantisation) << result.message;
  for (const double tap : result.filter->taps()) EXPECT_EQ(tap * 65536.0, std::round(tap * 65536.0));
  EXPECT_TRUE(verify_by_simulation(task, *result.filter, {result.corners[0].delay}).feasible);
}

/// Behind a servo the force is the motion's, which needs fewer taps than a force of the command. A bound from rows of
/// the taps would be above a design that holds.
TEST(Loads, CurvesBehindAServoAreThoseOfTheMotion) {
  Axis axis;
  axis.mass = 34.0, axis.damping = 100.0, axis.servo_gain = 150.0;
  axis.force_speed = {{0.0, 465.0}, {0.06, 300.0}, {0.11, 150.0}}, axis.force_speed_max = 465.0;
  const Task task = plane_task(axis, plane_corner("A", 95.0, 0.0, 0.1, 0.1), 80e-6);
  DesignOptions options;
  options.time_limit = 5.0;
  const DesignResult result = design_task(task, options);
  ASSERT_TRUE(result.has_design()) << result.message;
  EXPECT_TRUE(verify_by_simulation(task, averages(std::vector{8, 2}), {14}).feasible);
  EXPECT_LE(result.lower_bound.value_or(0.0), 23e-3 * (1.0 + 1e-9));
  if (result.certificate) {
    const CheckReport report = check_certificate(task, result);
    EXPECT_TRUE(report.accepted) << report.reason;
  }
}

/// More force does not make a drive faster: the curve's speeds stay.
TEST(Loads, AdviceScalesForcesOfACurveNotItsSpeeds) {
  Axis axis;
  axis.mass = 40.0, axis.acceleration_max = 8.0;
  axis.force_speed = {{0.0, 200.0}, {0.06, 180.0}, {0.15, 90.0}}, axis.force_speed_max = 200.0;
  const Task task = plane_task(axis, plane_corner("A", 90.0, 30.0, 0.1, 0.1), 50e-6);
  const Explanation explained = explain_task(task);
  Task more = task;
  for (Axis& x : more.machine.axes)
    x.force_speed = {{0.0, 220.0}, {0.06, 198.0}, {0.15, 99.0}}, x.force_speed_max = 220.0;
  const double least = design_task(more).objective();
  const auto found = std::ranges::find_if(explained.gains,
                                          [](const Gain& gain) { return gain.room.name == "force speed of all axes"; });
  ASSERT_NE(found, explained.gains.end());
  EXPECT_NEAR(found->objective, least, 1e-12);

  Task fast = task;
  for (Axis& x : fast.machine.axes)
    x.mass = 10.0, x.force_speed = {{0.0, 100.0}, {0.08, 50.0}}, x.force_speed_max = 100.0;
  for (const Remedy& remedy : explain_task(fast).remedies) {
    if (remedy.room.name == "force speed of all axes") {
      EXPECT_EQ(remedy.help, Remedy::Help::no);
    }
  }
  EXPECT_NE(design_task(fast).message.find("the curve ends at 80 mm/s, corner A runs at"), std::string::npos)
      << design_task(fast).message;
}

}  // namespace
}  // namespace accdec
