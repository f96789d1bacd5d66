// Bounds by kernels beside plans, closed forms and motions that are made here.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/kernel_bound.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "../program/reference.hpp"

namespace accdec::kernel_bound_test {
namespace {

double kernels(const Toolpath& path, const Machine& machine, double wider = 0.0) {
  double work = 3e6;
  return kernel_bound(path, machine, wider, 0, path.blocks() - 1, work, [] { return true; });
}

/// From rest to rest in L at constant accelerations: 2 sqrt(L/a). One axis to and fro n times: n times that.
TEST(KernelBound, OfAnAxisThatGoesBackAndForthIsTheClosedForm) {
  const Machine machine = test::machine_of(1.0, unlimited, 10.0);
  for (const int ways : {2, 3, 9}) {
    std::string text = "G64 P0.000001 F600000\n";
    for (int i = 0; i < ways; ++i) text += fmt::format("G1 X{}\n", i % 2 == 0 ? 1.0 : 0.0);
    const double bound = kernels(test::path_of(text + "M2\n", machine), machine), closed = ways * 2.0 * std::sqrt(1e-3);
    EXPECT_LE(bound, closed) << ways;
    EXPECT_GE(bound, 0.985 * closed) << ways;
  }
}

/// A motion within A and J, every axis by itself, that swings its acceleration at random. It comes to rest in the end,
/// and the joints of its program are places that it passes.
struct RandomMotion {
  std::vector<std::array<double, 3>> joints;
  double time = 0.0, fastest = 0.0;

  RandomMotion(unsigned seed, double acceleration, double jerk) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    constexpr double dt = 1e-4;
    const double pull = 15.0 + 60.0 * unit(random), joint = 20.0 + 40.0 * unit(random);
    std::array<double, 3> x{}, v{}, a{}, goal{};
    joints.push_back(x);
    for (int i = 0; i < 12'000; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (unit(random) < pull * dt) goal[k] = (v[k] > 0.0 ? -1.0 : 1.0) * (unit(random) < 0.7 ? acceleration : 0.0);
      }
      move(x, v, a, goal, jerk, dt);
      if (unit(random) < joint * dt) joints.push_back(x);
    }
    // To rest: towards the acceleration from which the velocity ends with it.
    for (int i = 0; i < 200'000 && !at_rest(v, a); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double left = v[k] + 0.5 * a[k] * std::abs(a[k]) / jerk;
        goal[k] = std::abs(left) < 1e-7 ? 0.0 : left > 0.0 ? -acceleration : acceleration;
      }
      move(x, v, a, goal, jerk, dt);
    }
    joints.push_back(x);
  }
  static bool at_rest(const std::array<double, 3>& v, const std::array<double, 3>& a) {
    double most = 0.0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max({most, std::abs(v[k]) / 1e-4, std::abs(a[k]) / 1e-2});
    return most < 1.0;
  }
  void move(std::array<double, 3>& x, std::array<double, 3>& v, std::array<double, 3>& a,
            const std::array<double, 3>& goal, double jerk, double dt) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double change = std::clamp(goal[k] - a[k], -jerk * dt, jerk * dt);
      x[k] += v[k] * dt + 0.5 * a[k] * dt * dt + change * dt * dt / 6.0;
      v[k] += (a[k] + 0.5 * change) * dt;
      a[k] += change;
    }
    time += dt;
    fastest = std::max(fastest, std::hypot(v[0], v[1], v[2]));
  }
};

TEST(KernelBound, OfRandomMotionsIsNotAboveTheirTimes) {
  double closest = 0.0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const double jerk = seed % 3 == 0 ? 1e6 : 50.0;
    const RandomMotion motion(seed, 1.0, jerk);
    const Machine machine = test::machine_of(1.0, seed % 3 == 0 ? unlimited : jerk, 10.0, 3);
    std::string text = fmt::format("G64 P0.001 F{:.6f}\n", 6e4 * motion.fastest * (1.0 + 1e-6));
    for (const std::array<double, 3>& p : motion.joints)
      text += fmt::format("G1 X{:.7f} Y{:.7f} Z{:.7f}\n", 1e3 * p[0], 1e3 * p[1], 1e3 * p[2]);
    const Toolpath path = test::path_of(text + "M2\n", machine);
    const double bound = kernels(path, machine);
    // It ends at 1e-4 m/s and 1e-2 m/s^2, which rest in less than 10 ms more.
    EXPECT_LE(bound, motion.time + 0.01) << seed;
    closest = std::max(closest, bound / motion.time);
  }
  EXPECT_GE(closest, 0.5);
}

TEST(KernelBound, IsNotAbovePlansOfFineChordsAndCloseToThem) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double sum = 0.0, plans = 0.0;
  for (int i = 0; i < 40; ++i) {
    const bool jerk = i % 2 == 1;
    Machine machine = test::machine_of(i % 3 == 0 ? 5.0 : 1.0, jerk ? 50.0 : unlimited, 0.3, i % 5 == 4 ? 3 : 2);
    machine.axes[1].acceleration_max *= 0.5;
    std::string text = fmt::format("G91 G64 P{} F{}\n", std::pow(10.0, -2.0 + 0.7 * unit(random)), i % 4 ? 6000 : 1500);
    for (int b = 0; b < 40; ++b) {
      text += fmt::format("G1 X{:.6f} Y{:.6f}", unit(random), unit(random));
      text += machine.axes.size() == 3 ? fmt::format(" Z{:.6f}\n", unit(random)) : "\n";
    }
    const Toolpath path = test::path_of(text + "M2\n", machine);
    const ProfilePlan plan = plan_profiles(path, machine, 1e-3);
    ASSERT_TRUE(plan.holds()) << text;
    const SplineSlack slack = spline_slack(machine, 1e-3);
    const double bound = kernels(path, machine, slack.wider) - slack.saved,
                 time = 1e-3 * static_cast<double>(plan.check.samples);
    EXPECT_LE(bound, time) << text;
    sum += bound, plans += time;
  }
  EXPECT_GE(sum, 0.6 * plans);
}

}  // namespace
}  // namespace accdec::kernel_bound_test
