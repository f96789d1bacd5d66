// Multipliers of the bound for any motion, checked by code that did not seek them, beside closed forms and plans.

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plan/verify/motion_proof.hpp>

#include "../program/reference.hpp"

namespace accdec::motion_proof_test {
namespace {

using test::machine_of;
using test::path_of;
constexpr double T = 1e-3;

/// Multipliers K = (2 s - 1)/A, whose slope is p: what is left is 2 (L/A)/h + h/2.
MotionProof of_one_leg(double acceleration, bool jerk, std::size_t axes) {
  const std::vector<double> none(axes, 0.0);
  const auto row = [&](double x) {
    std::vector<double> values = none;
    values[0] = x;
    return values;
  };
  MotionProof proof;
  MotionProof::Leg& leg = proof.legs.emplace_back();
  leg.time = 1.0;
  leg.shares = {0.0, 1.0};
  leg.acceleration = {row(-1.0 / acceleration), row(1.0 / acceleration)};
  if (jerk) leg.jerk = {none, none};
  leg.way = {row(2.0 / acceleration)};
  return proof;
}

TEST(MotionProof, OfOneLegIsTheClosedForm) {
  for (const double jerk : {unlimited, 50.0}) {
    Machine machine = machine_of(0.5, jerk);
    for (Axis& axis : machine.axes) axis.velocity_max = 10.0;
    const Toolpath path = path_of("F600000 G61.1\nG1 X20 Y0\nM2\n", machine);
    // 2 sqrt(L/A), but for the periods after the last sample. The bisection stops 10^-5 of the guess below.
    const double later = jerk < unlimited ? 2.0 * T : T, closed = 2.0 * std::sqrt(0.02 / 0.5) - later;
    const double proved = proved_time(path, machine, T, {of_one_leg(0.5, jerk < unlimited, path.dimensions())});
    EXPECT_LE(proved, closed);
    EXPECT_GE(proved, closed - 1.1e-5);
  }
}

std::string zigzag(const char* tolerance, double length, int corners) {
  std::string text = fmt::format("G64 P{} F6000\n", tolerance);
  for (int i = 1; i <= corners; ++i) text += fmt::format("G1 X{:.3f} Y{}\n", length * i, i % 2 == 0 ? 0 : 3);
  return text + "M2\n";
}

struct Case {
  std::string program;
  double jerk;
  bool close = true;  // beside rapid moves multipliers allow all that the axes can do
};
const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {zigzag("0.5", 4.0, 8), unlimited},
      {zigzag("0.5", 4.0, 8), 50.0},
      {zigzag("0.05", 0.4, 20), 50.0},
      {"G64 P0.5 F6000\nG1 X50\nG1 Y50\nG4 P0.1\nG1 X0\nM2\n", 50.0},
      {"G17 G64 P0.05 F6000\nG1 X30\nG1 Y30\nG3 X10 Y30 I-10\nG1 X0 Y0\nM2\n", unlimited},
      {"G17 G64 P0.05 F6000\nG1 X30\nG0 X30 Y20\nG1 X0 Y0 F3000\nM2\n", 20.0, false}};
  return all;
}

TEST(MotionProof, IsCloseToTheBoundAndBelowPlans) {
  for (const auto& [program, jerk, close] : cases()) {
    const Machine machine = machine_of(1.0, jerk);
    const Toolpath path = path_of(program, machine);
    const AnyMotionBound bound = any_motion_bound(path, machine, T, Deadline(60.0));
    ASSERT_FALSE(bound.proofs.empty()) << program;
    const double proved = proved_time(path, machine, T, bound.proofs);
    EXPECT_GE(proved, (close ? 0.97 : 0.5) * bound.time) << program;
    const ProfilePlan plan = plan_profiles(path, machine, T);
    ASSERT_TRUE(plan.holds()) << program;
    EXPECT_LE(proved, static_cast<double>(plan.check.samples) * T) << program;
  }
}

// Whatever the multipliers are, no motion is faster than what they prove.
TEST(MotionProof, OfChangedMultipliersIsBelowPlans) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const auto& [program, jerk, close] : cases()) {
    const Machine machine = machine_of(1.0, jerk);
    const Toolpath path = path_of(program, machine);
    const ProfilePlan plan = plan_profiles(path, machine, T);
    const std::vector<MotionProof> found = any_motion_bound(path, machine, T, Deadline(60.0)).proofs;
    double best = 0.0;
    for (int i = 0; i < 8; ++i) {
      std::vector<MotionProof> changed = found;
      const double by = i % 4 == 0 ? 1e-3 : 0.1;
      for (MotionProof& proof : changed) {
        for (std::size_t leg = 0; leg < proof.legs.size(); ++leg) {
          MotionProof::Leg& of = proof.legs[leg];
          of.time *= std::exp(by * normal(random));
          for (auto* table : {&of.acceleration, &of.jerk, &of.way}) {
            for (auto& row : *table)
              for (double& value : row) value *= 1.0 + by * normal(random);
          }
          if (leg == 0) continue;
          of.acceleration.front() = proof.legs[leg - 1].acceleration.back();
          if (!of.jerk.empty()) of.jerk.front() = proof.legs[leg - 1].jerk.back();
        }
      }
      best = std::max(best, proved_time(path, machine, T, changed));
    }
    EXPECT_LE(best, static_cast<double>(plan.check.samples) * T) << program;
    EXPECT_GT(best, 0.0) << program;
  }
}

TEST(MotionProof, RefusesMultipliersThatAreNotOfTheProgram) {
  const Machine machine = machine_of(1.0, 50.0);
  const Toolpath path = path_of(zigzag("0.5", 4.0, 8), machine);
  const std::vector<MotionProof> found = any_motion_bound(path, machine, T, Deadline(60.0)).proofs;
  ASSERT_EQ(found.size(), 1u);
  ASSERT_GT(found[0].legs.size(), 1u);
  const auto refused = [&](const auto& change) {
    std::vector<MotionProof> changed = found;
    change(changed[0]);
    EXPECT_THROW(proved_time(path, machine, T, changed), std::invalid_argument);
  };
  refused([](MotionProof& p) { p.legs[1].acceleration.front()[0] += 1e-3; });
  refused([](MotionProof& p) { p.legs[1].jerk.front()[0] += 1e-3; });
  refused([](MotionProof& p) { p.legs[0].shares[1] = 0.0; });
  refused([](MotionProof& p) { p.legs[0].way.pop_back(); });
  refused([](MotionProof& p) { p.legs[0].acceleration[0].pop_back(); });
  refused([](MotionProof& p) { p.legs[0].way[0][0] = std::nan(""); });
  refused([](MotionProof& p) { p.legs.back().last = 8; });
  refused([](MotionProof& p) { p.legs.pop_back(); });
  refused([](MotionProof& p) { p.first = 1; });
  std::vector<MotionProof> twice{found[0], found[0]};
  EXPECT_THROW(proved_time(path, machine, T, twice), std::invalid_argument);
}

}  // namespace
}  // namespace accdec::motion_proof_test
