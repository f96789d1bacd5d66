// The least times of ways to and fro, beside motions that are integrated here.

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/bounds/swing_times.hpp>

#include "../program/reference.hpp"

namespace accdec::swing_times_test {
namespace {

constexpr double A = 1.0, J = 50.0, r = 2.0 * A / J;

/// The way of half a period of a trapezoidal acceleration, A at most and J steep, that lasts h: by summing up.
double way_of(double h) {
  constexpr int steps = 200'000;
  const double dt = 0.5 * h / steps;
  double v = 0.0, x = 0.0;
  // From the turn, where v = 0, to the middle of the way.
  for (int i = 0; i < steps; ++i) {
    const double a = std::min(A, J * (0.5 * h - (i + 0.5) * dt));
    x += (v + 0.5 * a * dt) * dt;
    v += a * dt;
  }
  return 2.0 * x;
}

TEST(SwingTimes, OfEqualWaysAreTheHalfPeriodOfTheFastestMotion) {
  const SwingTimes times(test::machine_of(A, J), 1);
  ASSERT_EQ(times.kinds(), SwingTimes::kinds_max);
  for (const double h : {0.6 * r, 0.75 * r, r, 1.3 * r, 2.0 * r, 5.0 * r}) {
    const double way = way_of(h);
    double best = 0.0;
    for (std::size_t kind = 0; kind < times.kinds(); ++kind) best = std::max(best, times.inside(0, kind, way));
    EXPECT_LE(best, h * (1.0 + 1e-9)) << h;
    EXPECT_GE(best, (h < r ? 0.95 : 0.9995) * h) << h;
    EXPECT_GE(best, 2.0 * std::sqrt(way / A)) << h;
  }
}

/// The least over h by trying many, for a second opinion.
double tried(double m, double way) {
  double least = unlimited;
  for (double h = 1e-6; h < 20.0; h *= 1.0002) {
    const double g = h < r ? J * h * h / 6.0 : 0.5 * A * h - A * r * r / (6.0 * h);
    least = std::min(least, h + m * (2.0 * way / h - g));
  }
  return least;
}

TEST(SwingTimes, AreTheLeastOverAllTimes) {
  for (const double m : {1.0, 1.35, 1.75}) {
    for (double way = 1e-7; way < 1.0; way *= 3.0) {
      const double least = SwingTimes::least(A, J, m / A, way);
      EXPECT_LE(least, tried(m / A, way) * (1.0 + 1e-9)) << m << " " << way;
      EXPECT_GE(least, tried(m / A, way) * (1.0 - 1e-4)) << m << " " << way;
    }
  }
}

/// Positions at the turns of a random motion within A and J, and its times there.
struct Turns {
  std::vector<double> time, place;
  explicit Turns(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double keep = 0.2 + 0.8 * unit(random), pull = 3.0 + 60.0 * unit(random);
    constexpr double dt = 1e-4;
    double x = 0.0, v = 0.0, a = 0.0, goal = A;
    for (int i = 0; i < 60'000; ++i) {
      // Swings the acceleration to and fro, as fast as the jerk allows or slower, against the velocity.
      if (unit(random) < pull * dt) goal = (v > 0.0 ? -A : A) * (unit(random) < keep ? 1.0 : unit(random));
      const double change = std::clamp(goal - a, -J * dt, J * dt), before = v;
      x += v * dt + 0.5 * a * dt * dt + change * dt * dt / 6.0;
      v += (a + 0.5 * change) * dt;
      a += change;
      if (before * v < 0.0) time.push_back(i * dt), place.push_back(x);
    }
  }
};

TEST(SwingTimes, OfRandomMotionsAreNotAboveTheirTimes) {
  const SwingTimes times(test::machine_of(A, J), 1);
  double closest = 0.0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Turns turns(seed);
    std::mt19937 random(seed);
    for (int part = 0; part < 40 && turns.time.size() > 4; ++part) {
      const std::size_t first = random() % (turns.time.size() - 3),
                        last = std::min(turns.time.size() - 1, first + 2 + random() % 30);
      for (std::size_t kind = 0; kind < times.kinds(); ++kind) {
        double sum = 0.0;
        for (std::size_t i = first; i < last; ++i) {
          const double way = std::abs(turns.place[i + 1] - turns.place[i]);
          if (way > 0.0) sum += i == first || i + 1 == last ? times.at_end(0, kind, way) : times.inside(0, kind, way);
        }
        const double took = turns.time[last] - turns.time[first];
        EXPECT_LE(sum, took + 2e-4) << seed << " " << first << " " << last;
        closest = std::max(closest, sum / took);
      }
    }
  }
  EXPECT_GE(closest, 0.7);
}

TEST(SwingTimes, WithoutAJerkLimitAreThoseOfConstantAccelerations) {
  const SwingTimes times(test::machine_of(2.0), 2);
  EXPECT_EQ(times.kinds(), 1U);
  EXPECT_DOUBLE_EQ(times.inside(1, 0, 0.02), 0.2);
  EXPECT_DOUBLE_EQ(times.at_end(1, 0, 0.01), 0.1);
}

}  // namespace
}  // namespace accdec::swing_times_test
