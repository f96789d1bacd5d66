// Times from plane to plane beside closed forms and plans.

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/plane_bound.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

using test::machine_of;

/// Legs with corners so close that the motion at one still shows at the next.
std::string random_zigzag(std::mt19937& random, int legs, double shortest_mm, double tolerance_mm) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::string text = fmt::format("G91 G64 P{} F6000\n", tolerance_mm);
  double heading = 2.0 * std::numbers::pi * unit(random);
  for (int i = 0; i < legs; ++i) {
    const double length = shortest_mm + 4.0 * unit(random);
    text += fmt::format("G1 X{:.9f} Y{:.9f}\n", length * std::cos(heading), length * std::sin(heading));
    heading += (unit(random) < 0.5 ? -1.0 : 1.0) * (0.8 + 1.6 * unit(random));
  }
  return text + "M2\n";
}

TEST(PlaneBound, OfOneLegIsTheClosedForm) {
  const Machine m = machine_of(1.0);
  PlaneLeg leg;
  leg.tube.direction[0] = 1.0;
  leg.tube.pace[0] = 10.0;
  leg.tube.feed = 0.1;
  leg.tube.radius = 1e-4;
  const auto time = [&](double length) {
    leg.way = 10.0 * length;
    return PlaneBound(m, 2, [] { return true; }).time({leg});
  };
  // From rest to rest, with and without reaching the feed: L/F + F/a, 2 sqrt(L/a).
  EXPECT_NEAR(time(0.05), 0.6, 6e-3);
  EXPECT_LE(time(0.05), 0.6 + 1e-6);
  EXPECT_NEAR(time(0.004), 2.0 * std::sqrt(0.004), 2e-3);
  EXPECT_LE(time(0.004), 2.0 * std::sqrt(0.004) + 1e-6);
}

TEST(PlaneBound, IsNoneWhereNoPlaneSeparatesTheTolerances) {
  const Machine m = machine_of(1.0);
  PlaneLeg leg;
  leg.tube.direction[0] = 1.0;
  leg.tube.pace[0] = 10.0;
  leg.tube.feed = 0.1;
  leg.way = 0.01;
  leg.tolerance = 0.01;
  EXPECT_LT(PlaneBound(m, 2, [] { return true; }).time({leg, leg}), 0.0);
}

TEST(PlaneBound, IsNotAbovePlansOfRandomZigzags) {
  std::mt19937 random(5);
  for (int i = 0; i < 4; ++i) {
    const Machine m = machine_of(i % 2 == 0 ? 1.0 : 3.0, i % 3 == 1 ? 50.0 : unlimited);
    const std::string zigzag = random_zigzag(random, 5, 3.0, i % 2 == 0 ? 0.5 : 0.05);
    const Toolpath path = test::path_of(zigzag, m);
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds()) << zigzag;
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    const double bound = any_motion_bound(path, m, 1e-3, 60.0).time;
    EXPECT_LE(bound, time * (1.0 + 1e-8)) << zigzag;
  }
}

}  // namespace
}  // namespace accdec
