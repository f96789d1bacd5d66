// Times by weights beside closed forms, motions that are made here, and plans.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/envelope_system.hpp>
#include <accdec/bounds/weight_search.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec::weight_bound_test {
namespace {

using test::machine_of;
double largest(const WeightedSection& section) {
  double work = 1e9;
  return largest_weighted_time(section, work, [] { return true; });
}

/// Along x to `length` and back, by turns.
WeightedSection to_and_fro(int ways, double length, double feed, double acceleration, double jerk, double guess) {
  WeightedSection section;
  section.axes = {{10.0, acceleration, jerk}};
  for (int i = 0; i < ways; ++i) {
    WeightedSection::Leg& leg = section.legs.emplace_back();
    leg.way[0] = i % 2 == 0 ? length : -length;
    leg.radius = leg.tolerance = 1e-9;
    leg.feed = feed;
    leg.guess = guess;
    leg.reach = feed / acceleration + acceleration / std::min(jerk, 1e9);
  }
  section.legs.back().tolerance = 0.0;
  return section;
}

TEST(WeightBound, OfOneAxisIsTheClosedForm) {
  const auto beside = [](int ways, double length, double feed, double acceleration, double jerk, double closed) {
    for (const double guess : {0.8, 1.2}) {
      const double found = largest(to_and_fro(ways, length, feed, acceleration, jerk, guess * closed)) / ways;
      EXPECT_LE(found, closed * (1.0 + 1e-9)) << closed;
      EXPECT_GE(found, 0.98 * closed) << closed;
    }
  };
  // L/F + F/a; 2 sqrt(L/a) for every way.
  beside(1, 0.05, 0.1, 1.0, unlimited, 0.6);
  beside(1, 0.001, 10.0, 1.0, unlimited, 2.0 * std::sqrt(1e-3));
  beside(9, 0.001, 10.0, 1.0, unlimited, 2.0 * std::sqrt(1e-3));
}

/// A motion within A and J, every axis by itself, from rest to rest; its joints are near places that it passes.
struct RandomMotion {
  WeightedSection section;
  std::vector<double> times;  // s, of every leg
  double time = 0.0;
  using Point = std::array<double, 2>;

  RandomMotion(std::mt19937& random, double acceleration, double jerk) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    constexpr double dt = 2e-4;
    Point x{}, v{}, a{}, goal{};
    const auto move = [&] {
      for (std::size_t k = 0; k < 2; ++k) {
        const double change = std::clamp(goal[k] - a[k], -jerk * dt, jerk * dt);
        x[k] += v[k] * dt + 0.5 * a[k] * dt * dt + change * dt * dt / 6.0;
        v[k] += (a[k] + 0.5 * change) * dt;
        a[k] += change;
      }
      places_.push_back(x);
      fastest_ = std::max(fastest_, std::hypot(v[0], v[1]));
    };
    places_.push_back(x);
    const double pull = 10.0 + 40.0 * unit(random), turns = 10.0 + 20.0 * unit(random);
    for (int i = 0; i < 3000; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        if (unit(random) < pull * dt) goal[k] = (v[k] > 0.0 ? -1.0 : 1.0) * (unit(random) < 0.8 ? acceleration : 0.0);
      }
      move();
      if (unit(random) < turns * dt && places_.size() > passes_.back() + 20) passes_.push_back(places_.size() - 1);
    }
    for (int i = 0; i < 200'000 && std::hypot(v[0], v[1]) + 0.01 * std::hypot(a[0], a[1]) > 3e-4; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const double left = v[k] + 0.5 * a[k] * std::abs(a[k]) / jerk;
        goal[k] = std::abs(left) < 1e-7 ? 0.0 : left > 0.0 ? -acceleration : acceleration;
      }
      move();
    }
    passes_.push_back(places_.size() - 1);
    time = dt * static_cast<double>(places_.size() - 1);
    section.axes.assign(2, {10.0, acceleration, jerk < 1e5 ? jerk : unlimited});
    make_legs(random, dt);
  }

 private:
  /// Joints are off by as much as their tolerance; tubes are as wide as the motion needs.
  void make_legs(std::mt19937& random, double dt) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Point from = places_[0];
    for (std::size_t i = 1; i < passes_.size(); ++i) {
      Point to = places_[passes_[i]];
      const double off = i + 1 < passes_.size() ? 1e-4 * unit(random) : 0.0, angle = 6.28 * unit(random);
      to[0] += off * std::cos(angle), to[1] += off * std::sin(angle);
      WeightedSection::Leg& leg = section.legs.emplace_back();
      leg.way[0] = to[0] - from[0], leg.way[1] = to[1] - from[1];
      leg.tolerance = off + 1e-12;
      leg.feed = fastest_;
      for (std::size_t k = passes_[i - 1]; k <= passes_[i]; ++k)
        leg.radius = std::max(leg.radius, beside(k, from, leg));
      times.push_back(dt * static_cast<double>(passes_[i] - passes_[i - 1]));
      leg.guess = times.back() * (0.7 + 0.6 * unit(random));
      leg.reach = 0.3;
      from = to;
    }
    section.legs.back().tolerance = 0.0;
  }
  double beside(std::size_t k, const Point& from, const WeightedSection::Leg& leg) const {
    const double x = places_[k][0] - from[0], y = places_[k][1] - from[1];
    const double length2 = leg.way[0] * leg.way[0] + leg.way[1] * leg.way[1];
    const double along = length2 > 0.0 ? std::clamp((x * leg.way[0] + y * leg.way[1]) / length2, 0.0, 1.0) : 0.0;
    return std::hypot(x - along * leg.way[0], y - along * leg.way[1]);
  }

  std::vector<Point> places_;
  std::vector<std::size_t> passes_{0};
  double fastest_ = 0.0;
};

TEST(WeightBound, OfRandomMotionsIsNotAboveTheirTimes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double closest = 0.0, closest_random = 0.0;
  for (int i = 0; i < 40; ++i) {
    const RandomMotion motion(random, 1.0, i % 2 == 0 ? 1e6 : 50.0);
    // It ends at 3e-4 m/s and 0.03 m/s^2, which rest in less than 10 ms more.
    const double found = largest(motion.section) / (motion.time + 0.01);
    EXPECT_LE(found, 1.0) << i;
    closest = std::max(closest, found);
    // Any weights are as good: these are the pace, and something at random.
    std::vector<std::vector<double>> shares(motion.section.legs.size(), {0.0, 0.2, 0.6, 1.0});
    MotionWeights weights(2, i % 2 == 1, shares);
    const double size = std::pow(10.0, -3.0 + unit(random));
    for (double& value : weights.value) value = size * unit(random);
    for (std::size_t leg = 0; leg < weights.legs(); ++leg) {
      const WeightedSection::Leg& of = motion.section.legs[leg];
      weights.value[weights.time(leg)] = motion.times[leg];
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t a = 0; a < 2; ++a) weights.value[weights.p(leg, k) + a] += of.way[a] / (of.feed * of.feed);
      }
    }
    const double by_any = weighted_time(motion.section, weights) / (motion.time + 0.01);
    EXPECT_LE(by_any, 1.0) << i;
    closest_random = std::max(closest_random, by_any);
  }
  EXPECT_GE(closest, 0.6);
  EXPECT_GE(closest_random, 0.1);
}

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

TEST(WeightBound, IsNotAbovePlansOfRandomZigzags) {
  std::mt19937 random(5);
  double closest = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Machine m = machine_of(i % 2 == 0 ? 1.0 : 3.0, i % 3 == 1 ? 50.0 : unlimited);
    const std::string zigzag = random_zigzag(random, 5, i < 4 ? 3.0 : 0.3, i % 2 == 0 ? 0.5 : 0.05);
    const Toolpath path = test::path_of(zigzag, m);
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds()) << zigzag;
    const double time = static_cast<double>(plan.check.samples) * 1e-3;
    const double bound = any_motion_bound(path, m, 1e-3, Deadline(60.0)).time;
    EXPECT_LE(bound, time * (1.0 + 1e-8)) << zigzag;
    closest = std::max(closest, bound / time);
  }
  EXPECT_GE(closest, 0.9);
}

// (3 1 0; 1 -2 4; 0 4 5) x = (5, 9, 23) has x = (1, 2, 3).
TEST(EnvelopeSystem, IsSolvedAlsoIfItIsIndefinite) {
  EnvelopeSystem system({0, 0, 1});
  system.clear();
  system.add(0, 0, 3.0), system.add(0, 1, 1.0), system.add(1, 1, -2.0), system.add(2, 1, 4.0), system.add(2, 2, 5.0);
  std::vector<double> x{5.0, 9.0, 23.0};
  system.solve(x);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(x[i], static_cast<double>(i + 1), 1e-12);
}

}  // namespace
}  // namespace accdec::weight_bound_test
