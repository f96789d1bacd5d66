#include <cmath>

#include <gtest/gtest.h>

#include <accdec/motion/blend.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/program/plan/program_plan.hpp>
#include <accdec/program/write/program_report.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::path_of;
using test::random_program;

constexpr double period = 1e-3;

Machine machine(double ax, double ay) {
  Machine m;
  m.axes.push_back({"x", 0.5, ax});
  m.axes.push_back({"y", 0.5, ay});
  return m;
}

/// The motion of a program with a filter a leg, by definition: every leg's command, at rest before and after it,
/// convolved with its own taps; then the sum.
struct SumOfLegs {
  std::vector<std::vector<double>> position;  // [sample][axis]
  std::int64_t samples = 0;                   // up to the first from which nothing moves
};

SumOfLegs sum_of_legs(const Toolpath& path, const LegFilters& filters, const std::vector<int>& delays) {
  const Filter none({1.0});
  const test::Reference commands(path, none, period, delays);
  const std::size_t n = path.dimensions(),
                    length = commands.command.size() + static_cast<std::size_t>(filters.order_max()) + 4;
  SumOfLegs sum;
  sum.position.assign(length, std::vector<double>(path.point(0), path.point(0) + n));
  long begin = 0;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (!ends_leg(path, b) && b + 1 < path.blocks()) continue;
    // The leg's command: from `begin` to where its last joint is reached.
    const long end = static_cast<long>(commands.reached[b]);
    const Filter& filter = filters.of(b);
    for (std::size_t k = 0; k < length; ++k) {
      for (std::size_t a = 0; a < n; ++a) {
        for (int i = 0; i <= filter.order(); ++i) {
          const long j = std::clamp(static_cast<long>(k) - i, begin, end);
          sum.position[k][a] += filter.tap(i) * (commands.command[static_cast<std::size_t>(j)][a] -
                                                 commands.command[static_cast<std::size_t>(begin)][a]);
        }
      }
    }
    sum.samples = std::max<std::int64_t>(sum.samples, end + filter.order() + 1);
    begin = end;
  }
  return sum;
}

TEST(LegFilters, SimulationIsTheSumOfEveryLegsConvolution) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Toolpath path = path_of(random_program(seed, 150));
    std::mt19937 random(seed);
    const std::vector<Filter> family{boxcar(4), boxcar(31), blackman_sinc(40, 0.049), trapezoid(17, 5)};
    std::vector<std::uint16_t> of_block(path.blocks());
    std::vector<int> delays(path.blocks(), 0);
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      of_block[b] =
          b > 0 && !ends_leg(path, b - 1) ? of_block[b - 1] : static_cast<std::uint16_t>(random() % family.size());
      delays[b] = random() % 3 == 0 ? static_cast<int>(random() % 40) : 0;
    }
    delays.back() = 0;
    const LegFilters filters(family, of_block);
    const CommandTiming timing(path, period, delays);
    const SumOfLegs expected = sum_of_legs(path, filters, delays);
    double worst = 0.0;
    std::int64_t next = 1;
    SimulationOptions options;
    options.samples = [&](std::int64_t first, std::int64_t count, const double* const* position, const double* const*) {
      EXPECT_EQ(first, next);
      next += count;
      for (std::int64_t k = 0; k < count; ++k) {
        const auto sample = std::min(static_cast<std::size_t>(first + k), expected.position.size() - 1);
        for (std::size_t a = 0; a < path.dimensions(); ++a)
          worst = std::max(worst, std::abs(position[a][k] - expected.position[sample][a]));
      }
    };
    std::vector<double> errors(path.blocks(), 0.0), quick(path.blocks(), 0.0);
    const Simulation simulation = simulate_program(timing, filters, 0, path.blocks() - 1, errors, options);
    EXPECT_LT(worst, 1e-13) << "seed " << seed;
    EXPECT_EQ(simulation.samples, expected.samples);
    EXPECT_EQ(motion_samples(timing, filters), expected.samples);
    EXPECT_EQ(simulate_program(timing, filters, 0, path.blocks() - 1, quick).samples, expected.samples);
    for (std::size_t b = 0; b < path.blocks(); ++b) EXPECT_NEAR(quick[b], errors[b], 1e-13);
  }
}

TEST(LegFilters, CornerErrorIsThatOfTheBlendOfBothFilters) {
  const Toolpath path = path_of("G64 P1\nG1 F6000 X50\nX80 Y40\n");
  const Filter in = boxcar(20), out = blackman_sinc(40, 0.049);
  const Corner corner = make_corner(Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(3.0, 4.0), 0.1, 0.1);
  for (const int d : {0, 5, 15, 20}) {
    const std::vector<int> delays{d, 0};
    std::vector<double> errors(2, 0.0);
    simulate_program(CommandTiming(path, period, delays), LegFilters({in, out}, {0, 1}), 0, 1, errors);
    EXPECT_NEAR(errors[0], corner_error(Blend(in, out, corner, d, period)), 1e-15);
  }
}

TEST(LegFilters, LegsAlongTheAxesTakeTheBoxcarsOfTheirOwnLimits) {
  // 100 mm/s: 20 samples at 5 m/s^2 along x, 50 at 2 m/s^2 along y. Exact stops: every leg costs its own filter's
  // order.
  const Machine limits = machine(5.0, 2.0);
  Toolpath path = path_of("G61.1 G1 F6000 X50\nY50\nX0\nY0\n", limits);
  Task task;
  task.machine = limits;
  const ProgramResult one = run_program("a", path, boxcar(49), task),
                      legs = run_program("a", path, boxcar(49), task, true);
  EXPECT_TRUE(one.verification.feasible);
  EXPECT_TRUE(legs.verification.feasible);
  EXPECT_EQ(one.plan.simulation.samples, 4 * 500 + 3 * 49 + 50);
  EXPECT_EQ(legs.plan.simulation.samples, 4 * 500 + (19 + 49 + 19) + 50);
  EXPECT_EQ(legs.legs.of(0).order(), 19);
  EXPECT_EQ(legs.legs.of(1).order(), 49);
  EXPECT_NEAR(legs.cycle_time_one_filter, one.cycle_time, 1e-12);
  for (const LimitUse& use : legs.plan.simulation.limits) {
    EXPECT_NEAR(use.utilisation, use.kind == LimitKind::acceleration ? 1.0 : 0.2, 1e-9);
  }
}

TEST(LegFilters, ALegAlongTheDiagonalTakesTheShorterBoxcarItsAxesAllow) {
  const Machine limits = machine(1.0, 1.0);
  Toolpath path = path_of("G61.1 G1 F6000 X30 Y30\nX60 Y0\n", limits);
  Task task;
  task.machine = limits;
  const ProgramResult legs = run_program("a", path, boxcar(99), task, true);
  // 100 mm/s / sqrt(2) an axis at 1 m/s^2: 70.7, so 71 samples of 1 ms; legs of 424.26 samples. Y reverses at full
  // acceleration, so that the last sample of the stop and the first of the start may not fall together: one more than
  // an exact stop.
  EXPECT_EQ(legs.plan.simulation.samples, 425 + 71 + 425 + 71);
}

TEST(LegFilters, APlanWithThemHoldsEveryBoundAndIsNeverLonger) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Machine limits;
    for (const char* name : {"x", "y", "z"}) limits.axes.push_back({name, 0.2, 4.0});
    const Toolpath path = path_of(random_program(seed, 200), limits);
    Task task;
    task.machine = limits;
    const ProgramResult result = run_program("a", path, boxcar(30), task, true);
    EXPECT_TRUE(result.verification.feasible) << result.message;
    EXPECT_LE(result.cycle_time, result.cycle_time_one_filter);
    const SumOfLegs motion = sum_of_legs(result.path, result.legs, result.plan.delays);
    EXPECT_EQ(result.plan.simulation.samples, motion.samples);
    double acceleration = 0.0;
    for (std::size_t k = 2; k < motion.position.size(); ++k) {
      for (std::size_t a = 0; a < path.dimensions(); ++a) {
        const double change = motion.position[k][a] - 2.0 * motion.position[k - 1][a] + motion.position[k - 2][a];
        acceleration = std::max(acceleration, std::abs(change) / (period * period));
      }
    }
    EXPECT_LE(acceleration, 4.0 * (1.0 + 1e-6));
    for (std::size_t b = 0; b + 1 < result.path.blocks(); ++b) {
      // Some sample passes within the tolerance, or the path between samples does.
      double best = 1e300;
      const double* corner = result.path.point(b + 1);
      for (std::size_t k = 1; k < motion.position.size(); ++k) {
        double ab2 = 0.0, dot = 0.0, end2 = 0.0, s2 = 0.0;
        const auto &p = motion.position[k - 1], &q = motion.position[k];
        for (std::size_t a = 0; a < path.dimensions(); ++a) {
          ab2 += (q[a] - p[a]) * (q[a] - p[a]);
          dot += (corner[a] - p[a]) * (q[a] - p[a]);
          end2 += (q[a] - corner[a]) * (q[a] - corner[a]);
        }
        const double t = ab2 > 0.0 ? std::clamp(dot / ab2, 0.0, 1.0) : 0.0;
        for (std::size_t a = 0; a < path.dimensions(); ++a) s2 += std::pow(p[a] + t * (q[a] - p[a]) - corner[a], 2);
        best = std::min(best, ends_leg(result.path, b) ? end2 : s2);
      }
      EXPECT_LE(std::sqrt(best), result.path.tolerance[b] * (1.0 + 1e-9) + 1e-12);
    }
  }
}

TEST(LegFilters, StretchingKeepsTheShape) {
  for (const int count : {3, 17, 40, 64}) {
    const Filter box = stretched(boxcar(39), count);
    ASSERT_EQ(box.order(), count - 1);
    for (int i = 0; i < count; ++i) EXPECT_NEAR(box.tap(i), 1.0 / count, 1e-15);
    const Filter smooth = stretched(blackman_sinc(40, 0.049), count);
    for (int i = 0; i < count; ++i) EXPECT_NEAR(smooth.tap(i), smooth.tap(count - 1 - i), 1e-14);
    EXPECT_NEAR(smooth.mean_delay() + 0.5, count / 41.0 * 20.5, 1e-12);
  }
}

TEST(LegFilters, LengthsThatWouldRingAreNotTaken) {
  // A boxcar of 50 taps has a zero at 20 Hz; no shorter one holds the bound there.
  Machine limits = machine(1.0, 1.0);
  limits.modes.push_back({20.0, 20.0, 0.01});
  Toolpath path = path_of("G61.1 G1 F600 X10\nY10\n", limits);
  Task task;
  task.machine = limits;
  const ProgramResult result = run_program("a", path, boxcar(49), task, true);
  EXPECT_TRUE(result.verification.feasible) << result.message;
  for (const Filter& filter : result.legs.filters()) EXPECT_LE(residual_vibration(filter, 20.0, period), 0.01);
}

TEST(Plan, RoundedCoordinatesCostNoSample) {
  // 10 mm at 100 mm/s, written with a length 3e-9 of itself too long.
  Toolpath path = path_of("G64 P1\nG1 F6000 X10.00000003\nY10.00000003\n");
  const double before = path.duration[0];
  snap_durations(path, boxcar(9), period, {});
  EXPECT_EQ(path.duration[0], 0.1);
  EXPECT_LT(path.duration[0], before);
  Machine limits = machine(1.0, unlimited);  // at its limit along x already: the higher feed would break it
  Toolpath full = path_of("G64 P1\nG1 F6000 X10.00000003\nY10.00000003\n");
  snap_durations(full, boxcar(99), period, limits);
  EXPECT_EQ(full.duration[0], before);
}

}  // namespace
}  // namespace accdec
