#include <cstdio>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/design/covered_part.hpp>
#include <accdec/family.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

// Designs behind a response, and their proofs.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using testing::plane_corner;
using testing::plane_task;

Task everyday() {
  Axis axis;
  axis.acceleration_max = 6.0, axis.jerk_max = 500.0;
  return plane_task(axis, plane_corner("A", 95.0, 0.0, 0.1, 0.1), 50e-6);
}

Task with_force(Task task, double force) {
  for (Axis& axis : task.machine.axes) axis.mass = 30.0, axis.damping = 100.0, axis.force_max = force;
  return task;
}

/// Without limits of the command: forces alone.
Task of_forces(double force) {
  Task task = with_force(everyday(), force);
  for (Axis& axis : task.machine.axes) axis.acceleration_max = axis.jerk_max = unlimited;
  return task;
}

Task with_gain(Task task, double gain) {
  for (Axis& axis : task.machine.axes) axis.servo_gain = gain;
  return task;
}

Task with_taps(Task task, const std::vector<double>& taps) {
  for (Axis& axis : task.machine.axes) axis.response_taps = taps;
  return task;
}

DesignResult proved(const Task& task) {
  DesignOptions options;
  options.time_limit = 120.0;
  DesignResult result = design_task(task, options);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  const ResultCheck check = verify_result(result, {});
  EXPECT_TRUE(check.accepted) << ::testing::PrintToString(check.reasons);
  return result;
}

/// 50 ms at a gain of 200 1/s, where the ideal servo needs 42 ms. A simulation of the loop in Python agrees
/// (tests/python/test_response.py).
TEST(DesignBehindAServo, IsProvedAndLongerThanWithoutIt) {
  const DesignResult behind = proved(with_gain(everyday(), 200.0)), ideal = proved(everyday());
  EXPECT_NEAR(behind.objective(), 0.050, 1e-9);
  EXPECT_LT(ideal.objective(), behind.objective() - 0.5e-3);
  EXPECT_LE(behind.corners[0].corner_error, 50e-6 * (1.0 + 1e-9));
}

TEST(DesignBehindAServo, AProofOfAnotherGainIsNone) {
  DesignResult behind = proved(with_gain(everyday(), 200.0));
  behind.task = with_gain(everyday(), 5000.0);
  EXPECT_FALSE(check_certificate(behind.task, behind).accepted);
  behind.task = everyday();
  EXPECT_FALSE(check_certificate(behind.task, behind).accepted);
  behind.task = with_gain(everyday(), 200.0);
  behind.task.machine.axes[1].servo_gain = 300.0;
  EXPECT_THAT(check_certificate(behind.task, behind).reason, HasSubstr("respond differently"));
}

/// A response that only delays changes no error and no force, and so no optimum.
TEST(DesignBehindAServo, ADelayAloneChangesNothing) {
  Task one = everyday(), several = everyday();
  several.corners.push_back(plane_corner("B", 60.0, 30.0, 0.12, 0.08));
  several.corners.back().error_max = 80e-6;
  several.corners.back().weight = 2.0;
  several.corners.push_back(plane_corner("C", 130.0, 200.0, 0.1, 0.1));
  several.corners.back().error_max = 20e-6;
  Task corners_of_forces = with_force(several, 190.0);
  for (Axis& axis : corners_of_forces.machine.axes) axis.acceleration_max = axis.jerk_max = unlimited;
  for (const Task& task : {one, several, of_forces(150.0), corners_of_forces}) {
    const double ideal = proved(task).objective();
    for (const std::vector<double>& taps : {std::vector{0.0, 0.0, 1.0}, std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 1}})
      EXPECT_NEAR(proved(with_taps(task, taps)).objective(), ideal, 1e-9);
  }
}

/// With several corners, too, the proof is of the response: a slower servo costs more.
TEST(DesignBehindAServo, SeveralCornersAreProved) {
  Task task = everyday();
  task.corners.push_back(plane_corner("B", 60.0, 30.0, 0.12, 0.08));
  task.corners.back().error_max = 80e-6;
  double before = 0.0;
  for (const double gain : {1000.0, 250.0}) {
    const double objective = proved(with_gain(task, gain)).objective();
    EXPECT_GT(objective, before);
    before = objective;
  }
}

/// Forces of the motion are linear in the taps. A proof of another force is none.
TEST(DesignBehindAServo, ForcesAreProved) {
  for (const double gain : {1000.0, 200.0}) {
    DesignResult result = proved(with_gain(of_forces(150.0), gain));
    for (Axis& axis : result.task.machine.axes) axis.force_max = 300.0;
    EXPECT_FALSE(check_certificate(result.task, result).accepted);
  }
  Task friction = with_gain(of_forces(190.0), 200.0);
  for (Axis& axis : friction.machine.axes) axis.coulomb = 40.0;
  friction.corners[0] = plane_corner("A", 60.0, 20.0, 0.1, 0.1);  // x reverses
  friction.corners[0].error_max = 50e-6;
  proved(friction);
}

TEST(DesignBehindAServo, TheLimitsWithoutAProofAreNamed) {
  Task task = with_gain(of_forces(150.0), 200.0);
  task.machine.axes[1].power_max = 12.0;
  task.corners[0].speed_min = 0.01;
  EXPECT_EQ(left_out(task), "");
  task.machine.axes[1].coulomb = 10.0;
  EXPECT_EQ(left_out(task), "power of axes with dry friction");
  task.machine.power_total_max = 20.0;
  EXPECT_EQ(left_out(task), "power of axes with dry friction, the supply that the axes share");
}

/// Loads that are not convex: the motion's responses are split in place of the command's. A proof of a power that binds
/// is none of twice that power, and a response that only delays changes no optimum.
TEST(DesignBehindAServo, PowerRegenerationAndSmallestSpeedAreProved) {
  const auto limited = [](LimitKind kind, double room) {
    Task task = of_forces(150.0);
    task.sample_period = 4e-3;
    task.design.order_max = 40;
    for (Axis& axis : task.machine.axes) {
      if (kind == LimitKind::power) axis.power_max = 6.0 * room;
      if (kind == LimitKind::regeneration) axis.regeneration_max = 4.0 * room;
    }
    if (kind == LimitKind::speed_min)
      task.corners[0] = plane_corner("A", 130.0, 0.0, 0.1, 0.1), task.corners[0].error_max = 200e-6,
      task.corners[0].speed_min = 0.04;
    return task;
  };
  for (const LimitKind kind : {LimitKind::power, LimitKind::regeneration, LimitKind::speed_min}) {
    DesignResult result = proved(with_gain(limited(kind, 1.0), 200.0));
    result.task = with_gain(limited(kind, 2.0), 200.0);
    if (kind != LimitKind::speed_min) {
      EXPECT_FALSE(check_certificate(result.task, result).accepted) << to_string(kind);
    }
    EXPECT_NEAR(proved(with_taps(limited(kind, 1.0), {0.0, 0.0, 1.0})).objective(),
                proved(limited(kind, 1.0)).objective(), 1e-9);
  }
}

/// Powers and the control's smoothing: no longer than the best averages of a control.
TEST(DesignBehindAServo, LoadsAndSmoothingGiveVerifiedDesigns) {
  Task loads = with_gain(with_force(everyday(), 150.0), 200.0), smoothed = everyday();
  for (Axis& axis : loads.machine.axes) axis.power_max = 12.0;
  smoothed.machine.prefilter_taps = {0.25, 0.5, 0.25};
  for (const Task& task : {loads, smoothed}) {
    DesignOptions options;
    options.time_limit = 20.0;
    const DesignResult result = design_task(task, options);
    ASSERT_TRUE(result.has_design()) << result.message;
    EXPECT_TRUE(result.lower_bound && *result.lower_bound <= result.objective() * (1.0 + 1e-9));
    const ResultCheck check = verify_result(result, {});
    EXPECT_TRUE(check.accepted) << ::testing::PrintToString(check.reasons);
    // The best two averages of a control would have been an answer, too.
    const FamilyResult averages = best_member(task, *find_family("trapezoid"));
    ASSERT_TRUE(averages.result.has_design());
    EXPECT_LE(result.objective(), averages.result.objective() + 1e-9);
  }
}

/// The delays of a given filter, and the proof that no smaller ones hold.
TEST(DesignBehindAServo, DelaysOfAGivenFilterAreTheSmallest) {
  Task task = with_gain(everyday(), 200.0);
  task.filter = FilterSpec{.kind = Shape::trapezoid, .order = 30, .ramp = 12};
  const DesignResult result = proved(task);
  DesignResult longer = result;
  longer.corners[0].delay += 1;
  EXPECT_FALSE(verify_result(longer, {}).accepted);
}

/// Every shorter delay, simulated, breaks a limit, and the checker sees a longer one.
TEST(DesignBehindAServo, DelaysOfAGivenFilterAreProvedForAnyAxes) {
  Task differ = with_gain(everyday(), 200.0), swings = with_taps(everyday(), {0.7, 0.6, -0.2, -0.1});
  differ.machine.axes[1].servo_gain = 140.0;
  for (Task task : {differ, swings}) {
    task.filter = FilterSpec{.kind = Shape::trapezoid, .order = 30, .ramp = 12};
    const DesignResult result = proved(task);
    ASSERT_TRUE(result.has_design());
    for (int d = 0; d < result.corners[0].delay; ++d)
      EXPECT_FALSE(verify_by_simulation(task, *result.filter, {d}).feasible) << d;
    DesignResult longer = result;
    longer.corners[0].delay += 1;
    EXPECT_FALSE(verify_result(longer, {}).accepted);
  }
}

/// A nonlinear solver knows the response: as fast as the proved optimum but for a few samples.
TEST(DesignBehindAServo, NonlinearSolversDesignBehindIt) {
  Task smoothed = with_gain(everyday(), 200.0);
  smoothed.machine.prefilter_taps = {0.25, 0.5, 0.25};
  for (const Task& task : {with_gain(everyday(), 200.0), smoothed}) {
    DesignOptions nonlinear;
    nonlinear.method = Method::nlp, nonlinear.time_limit = 60.0;
    const DesignResult local = design_task(task, nonlinear);
    ASSERT_EQ(local.status, Status::feasible) << local.message;
    EXPECT_TRUE(verify_result(local, {}).accepted);
    DesignOptions exact;
    exact.time_limit = 30.0;
    const DesignResult best = design_task(task, exact);
    EXPECT_GE(local.objective(), *best.lower_bound - 1e-9);
    EXPECT_LE(local.objective(), best.objective() + 3e-3);
  }
}

/// Without a servo, 150 N take 30 kg with this friction to 0.1 m/s in ln(15 / 14) 0.3 s = 20.7 ms. The command may end
/// when the servo asks for no more force: Kv m (v - v') + c v' = F at v' = 0.0763 m/s. That takes 15.7 ms, order 15.
/// The search begins near it, not at the first order.
TEST(DesignBehindAServo, NonlinearSolversBeginNearTheSmallestOrder) {
  std::vector<int> orders;
  DesignOptions options;
  options.method = Method::nlp, options.time_limit = 60.0;
  options.progress = [&](const std::string& line) {
    if (int order = 0; std::sscanf(line.c_str(), "N = %d: ", &order) == 1) orders.push_back(order);
  };
  const DesignResult result = design_task(with_gain(of_forces(150.0), 200.0), options);
  EXPECT_TRUE(verify_result(result, {}).accepted);
  EXPECT_EQ(result.filter->order(), 15);
  EXPECT_THAT(orders, ::testing::Each(::testing::AllOf(::testing::Ge(13), ::testing::Le(20))));
}

/// Blends of a mode of an axis are rows at given delays: as fast as the proved optimum but for a few samples.
TEST(DesignOfModes, NonlinearSolversKnowWhatBlendsLeave) {
  Task task = everyday();
  task.machine.modes = {{38.0, 46.0, 1.0, 0.02, 0.1, 0, 20e-6}};
  task.corners[0] = plane_corner("A", 95.0, 25.0, 0.1, 0.1);
  task.corners[0].error_max = 50e-6;
  const DesignResult best = proved(task);
  DesignOptions nonlinear;
  nonlinear.method = Method::nlp, nonlinear.time_limit = 60.0;
  const DesignResult local = design_task(task, nonlinear);
  ASSERT_EQ(local.status, Status::feasible) << local.message;
  EXPECT_TRUE(verify_result(local, {}).accepted);
  EXPECT_GE(local.objective(), best.objective() - 1e-9);
  EXPECT_LE(local.objective(), best.objective() + 3e-3);
}

/// Settings and families for axes that differ: every member is simulated in another way here.
TEST(DesignBehindAServo, SettingsForAxesThatDifferAreTheBestOfTheirFamily) {
  Task task = with_gain(everyday(), 200.0);
  task.machine.axes[1].servo_gain = 140.0;
  task.settings =
      ControllerSettings{.families = {SettingFamily::averages}, .stages = {SettableStage{}, SettableStage{}}};
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  EXPECT_THAT(result.message, HasSubstr("respond differently"));
  EXPECT_TRUE(verify_result(result, {}).accepted);
  double least = 1.0;
  for (int first = 1; first <= 40; ++first) {
    for (int second = 1; second <= first; ++second) {
      const FilterSpec spec{.kind = Shape::averages, .lengths = {first, second}};
      const Filter filter = make_filter(spec);
      if (!verify_by_simulation(task, filter, {filter.order() + 300}).feasible) continue;
      for (int d = 0; 1e-3 * (filter.order() + 1 + d) < least - 1e-9; ++d) {
        if (verify_by_simulation(task, filter, {d}).feasible) least = 1e-3 * (filter.order() + 1 + d);
      }
    }
  }
  EXPECT_NEAR(result.objective(), least, 1e-9);
  task.settings.reset();
  EXPECT_NEAR(best_member(task, *find_family("trapezoid")).result.objective(), least, 1e-9);
}

/// Nearest sample of x' = Kv (s - x), each axis with its gain, to the corner: midpoint rule, steps of T/50.
double nearest_of_loops(const Task& task, const Filter& filter, int delay) {
  const Corner& corner = task.corners[0].geometry();
  const double T = task.sample_period, h = T / 50.0;
  constexpr int lead = 400;
  std::vector<std::vector<double>> at(2);
  for (std::size_t a = 0; a < 2; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    const double gain = task.machine.axes[a].servo_gain, in = corner.feed_in * corner.direction_in[i];
    const double out = corner.feed_out * corner.direction_out[i];
    double s = -lead * T * in, x = s - in / gain;  // evenly into the corner
    s -= in * T * filter.mean_delay(), x -= in * T * filter.mean_delay();
    for (int k = 1; k < 2 * lead; ++k) {
      const double v = in * filter.remaining(k - lead) + out * filter.cumulative(k - lead - delay);
      for (int step = 0; step < 50; ++step) {
        const double now = s + step * h * v, half = x + 0.5 * h * gain * (now - x);
        x += h * gain * (now + 0.5 * h * v - half);
      }
      s += T * v;
      at[a].push_back(x);
    }
  }
  double least = 1.0;
  for (std::size_t k = 0; k < at[0].size(); ++k) least = std::min(least, std::hypot(at[0][k], at[1][k]));
  return least;
}

TEST(DesignBehindAServo, AxesThatDifferAreDesignedAndVerified) {
  for (const double other : {120.0, 260.0, 800.0}) {
    Task task = with_gain(everyday(), 200.0);
    task.machine.axes[1].servo_gain = other;
    task.corners[0] = plane_corner("A", 95.0, 25.0, 0.1, 0.1);
    task.corners[0].error_max = 50e-6;
    DesignOptions options;
    options.time_limit = 20.0;
    const DesignResult result = design_task(task, options);
    ASSERT_EQ(result.status, Status::feasible) << result.message;
    EXPECT_FALSE(result.lower_bound);
    EXPECT_THAT(result.message, HasSubstr("not proved"));
    const ResultCheck check = verify_result(result, {});
    EXPECT_TRUE(check.accepted) << ::testing::PrintToString(check.reasons);
    const double error = nearest_of_loops(task, *result.filter, result.corners[0].delay);
    EXPECT_NEAR(result.corners[0].corner_error, error, 1e-7);
    EXPECT_LE(error, 50e-6 + 1e-7);
    const Task slowest = with_gain(task, std::min(200.0, other));
    EXPECT_LE(result.objective(), design_task(slowest, options).objective() + 10e-3) << other;
  }
  // At 100 mm/s and 45 degrees the lags differ by 0.1 (1/120 - 1/200) cos(45 deg) m along the axes.
  Task bent = with_gain(everyday(), 200.0);
  bent.machine.axes[1].servo_gain = 120.0;
  bent.corners[0] = plane_corner("A", 95.0, 45.0, 0.1, 0.1);
  const double off = 0.1 * (1.0 / 120.0 - 1.0 / 200.0) / 2.0;
  bent.corners[0].contour_max = 0.99 * off;
  EXPECT_THAT(design_task(bent).message, HasSubstr(fmt::format("leave the line of a leg by {:.4g} um", 1e6 * off)));
  const DesignResult undershoots = design_task(with_taps(everyday(), {1.3, -0.3}));
  EXPECT_EQ(undershoots.status, Status::feasible) << undershoots.message;
  EXPECT_TRUE(verify_result(undershoots, {}).accepted);
}

/// A long Hann holds limits that no short filter does: the lags of both axes leave the legs. A gap this wide asks for
/// any design.
TEST(DesignBehindAServo, AxesThatDifferBeginWithAStandardShape) {
  Axis axis;
  axis.mass = 34.0, axis.damping = 400.0, axis.force_max = 465.0, axis.servo_gain = 100.0;
  constexpr double feed = 1.85 / 60.0;
  Task task = plane_task(axis, plane_corner("A", 90.0, 45.0, feed, feed), 150e-6);
  task.machine.axes[1].servo_gain = 60.0, task.machine.axes[1].velocity_feedforward = 0.5;
  task.corners[0].contour_max = 30e-6;
  const DesignResult hann = assess(task, make_filter({.kind = Shape::hann, .order = 240}), {200}, false);
  ASSERT_TRUE(hann.has_design()) << hann.message;
  DesignOptions options;
  options.time_limit = 1000.0, options.exact.gap = 1.0;
  const DesignResult result = design_task(task, options);
  ASSERT_EQ(result.status, Status::feasible) << result.message;
  EXPECT_TRUE(verify_result(result, {}).accepted);
  EXPECT_LE(result.objective(), hann.objective());
}

/// From 0 to 0.1 m/s under a jerk of 500 m/s^3 takes 2 sqrt(0.1/500) s, that is 28 ms: few taps cannot.
TEST(DesignBehindAServo, LimitsWithoutADesignAreNamedWhateverIsProved) {
  DesignOptions options;
  options.time_limit = 60.0;
  Task differ = with_gain(everyday(), 200.0);
  differ.machine.axes[1].servo_gain = 180.0;
  differ.design.order_max = 5;
  const DesignResult unproved = design_task(differ, options);
  EXPECT_EQ(unproved.status, Status::failed);
  EXPECT_THAT(unproved.message, HasSubstr("limits in conflict (by search, not proved): "));
  EXPECT_THAT(unproved.message, HasSubstr("jerk"));
  Task supply = with_force(everyday(), 1e5);
  supply.machine.power_total_max = 1e6;
  supply.design.order_max = 5;
  const DesignResult proved_in_part = design_task(supply, options);
  EXPECT_EQ(proved_in_part.status, Status::infeasible);
  EXPECT_THAT(proved_in_part.message, HasSubstr("jerk"));
}

}  // namespace
}  // namespace accdec
