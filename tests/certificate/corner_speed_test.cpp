#include <cmath>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/certificate/corner_speed_check.hpp>
#include <accdec/design.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

/// A right angle along the axes at 0.1 m/s under an acceleration of 5 m/s^2, sampled so finely that it is nearly
/// continuous.
Task right_angle(double speed_min, double error_max) {
  Axis axis;
  axis.acceleration_max = 5.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), error_max);
  task.sample_period = 2e-5;
  task.corners[0].speed_min = speed_min;
  return task;
}

// In continuous time, both legs have speed s / sqrt 2 where they are equal. Each gains it over s^2 / (4 a). Across the
// bisector this is sqrt(1/2) (s^2 / (4 a) + s^2 / (4 a)).
TEST(CornerSpeed, RightAngleAgainstTheClosedForm) {
  const double speed = 0.02, error = std::sqrt(0.5) * speed * speed / (2.0 * 5.0);
  for (const double part : {0.5, 0.9, 0.97}) {
    EXPECT_EQ(contradictions(right_angle(speed, part * error)).size(), 1u) << part;
    EXPECT_NE(too_fast_for_its_error(right_angle(speed, part * error)), "") << part;
  }
  for (const double part : {1.03, 1.5, 4.0}) {
    EXPECT_TRUE(contradictions(right_angle(speed, part * error)).empty()) << part;
    EXPECT_EQ(too_fast_for_its_error(right_angle(speed, part * error)), "") << part;
  }
}

// The same with twenty million taps from rest to the feed, which nobody can add one by one for every speed. The jerk
// limit lets the acceleration rise in a few samples.
TEST(CornerSpeed, OfMillionsOfTapsIsTheClosedFormToo) {
  const double speed = 0.02, error = std::sqrt(0.5) * speed * speed / (2.0 * 5.0);
  for (const double part : {0.9, 1.1}) {
    Task task = right_angle(speed, part * error);
    task.sample_period = 1e-9;
    for (Axis& axis : task.machine.axes) axis.jerk_max = 1e9;
    EXPECT_EQ(contradictions(task).size(), part < 1.0 ? 1u : 0u) << part;
    EXPECT_EQ(too_fast_for_its_error(task) != "", part < 1.0) << part;
  }
}

/// The task with every limit that the bound looks at as tight as this filter and delay leave it.
void tighten_to(Task& task, const Filter& filter, int delay) {
  const DesignResult result = assess(task, filter, {delay}, false);
  for (const LimitUse& use : result.limits) {
    const double value = use.value;
    for (Axis& axis : task.machine.axes) {
      if (axis.name != use.axis) continue;
      if (use.kind == LimitKind::acceleration) axis.acceleration_max = std::min(axis.acceleration_max, value);
      if (use.kind == LimitKind::jerk) axis.jerk_max = std::min(axis.jerk_max, value);
      if (use.kind == LimitKind::force) axis.force_max = std::min(axis.force_max, value);
    }
    if (use.kind == LimitKind::corner_error) task.corners[0].error_max = value;
    if (use.kind == LimitKind::speed_min) task.corners[0].speed_min = value;
  }
}

// A motion that a filter reaches in simulation is no contradiction.
TEST(CornerSpeed, NothingThatAFilterDoesIsImpossible) {
  std::mt19937 rng(16);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int bounded = 0;
  for (int trial = 0; trial < 1200; ++trial) {
    Task task = testing::random_task(rng, 1);
    task.machine.modes.clear();
    for (Axis& axis : task.machine.axes) axis = Axis{.name = axis.name, .mass = axis.mass, .damping = axis.damping};
    for (Axis& axis : task.machine.axes) {
      axis.acceleration_max = 1e6;
      if (u(rng) < 0.5) axis.jerk_max = 1e9;
      if (u(rng) < 0.3) axis.force_max = 1e9;
    }
    task.corners[0].error_max = 1.0;
    task.corners[0].speed_min = 1e-6;
    // Now and then one at its limits: constant taps, or a ramp of them.
    const int order = 1 + static_cast<int>(12.0 * u(rng));
    std::vector<double> taps(static_cast<std::size_t>(order) + 1, 1.0);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      if (trial % 3 == 1) taps[i] = std::min(static_cast<double>(i) + 1.0, static_cast<double>(taps.size() - i));
      if (trial % 3 == 2) taps[i] = 0.05 + u(rng);
    }
    const int delay = static_cast<int>(u(rng) * order);
    tighten_to(task, Filter(taps), delay);
    if (!(task.corners[0].speed_min > 1e-6)) continue;
    ++bounded;
    EXPECT_TRUE(contradictions(task).empty()) << trial;
    EXPECT_EQ(too_fast_for_its_error(task), "") << trial;
  }
  EXPECT_GT(bounded, 400);
}

TEST(CornerSpeed, InfeasibleWithACertificate) {
  const DesignResult result = design_task(right_angle(0.02, 20e-6));
  ASSERT_EQ(result.status, Status::infeasible);
  EXPECT_NE(result.message.find("smallest speed A and corner error A"), std::string::npos) << result.message;
  ASSERT_TRUE(std::holds_alternative<proof::CornerSpeed>(result.certificate->proof));
  EXPECT_TRUE(verify_result(result).accepted);
  const auto refused = [&](const std::function<void(DesignResult&)>& forge) {
    DesignResult forged = result;
    forge(forged);
    return !verify_result(forged).accepted;
  };
  EXPECT_TRUE(refused([](DesignResult& r) { r.task.corners[0].speed_min = 0.01; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.task.corners[0].error_max = 40e-6; }));
  EXPECT_TRUE(refused([](DesignResult& r) {
    for (Axis& axis : r.task.machine.axes) axis.acceleration_max = 50.0;
  }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.status = Status::optimal; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.lower_bound = 1.0; }));
  EXPECT_TRUE(refused(
      [](DesignResult& r) { r.certificate = std::make_shared<Certificate>(Certificate{proof::ConstantFeed{}}); }));
}

}  // namespace
}  // namespace accdec
