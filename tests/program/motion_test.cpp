#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/feeds/stretched.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/direct.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::path_of;
using test::period;
using test::random_program;

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

SumOfLegs sum_of_legs(const Toolpath& path, const BlockFilters& filters, const std::vector<int>& delays) {
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

TEST(DirectMotion, IsTheSumOfEveryLegsConvolution) {
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
    const BlockFilters filters{family, of_block};
    const SumOfLegs expected = sum_of_legs(path, filters, delays);
    const DirectMotion motion = direct_motion(path, period, delays, filters);
    EXPECT_EQ(motion.samples, expected.samples);
    double worst = 0.0;
    for (std::size_t k = 0; k < std::min(expected.position.size(), motion.position[0].size()); ++k) {
      for (std::size_t a = 0; a < path.dimensions(); ++a)
        worst = std::max(worst, std::abs(motion.position[a][k] - expected.position[k][a]));
    }
    EXPECT_LT(worst, 1e-13) << "seed " << seed;
  }
}

// Every step of an even motion is the same, also the last: in double, 300 000 times 0.1 s is 0.16 us too little.
TEST(Motion, TheLastStepOfManyBlocksIsNoLonger) {
  constexpr std::size_t blocks = 300'000;
  Toolpath path;
  path.axes = {0};
  for (std::size_t i = 0; i <= blocks; ++i) path.points.push_back(static_cast<double>(i));
  path.duration.assign(blocks, 0.1);
  path.tolerance.assign(blocks, unlimited);
  path.joint.assign(blocks, Joint::straight);
  path.joint.back() = Joint::stop;
  const std::vector<int> delays(blocks, 0);
  const DirectMotion motion = direct_motion(path, 1.0, delays, {{Filter({1.0})}, {}});
  ASSERT_GE(motion.velocity[0].size(), blocks / 10 + 1);
  EXPECT_NEAR(motion.velocity[0][1], 10.0, 1e-9);
  EXPECT_NEAR(motion.velocity[0][blocks / 10], 10.0, 1e-9);
}

// Controllers are sent the motion that was simulated and judged, by another summation of the same commands.
TEST(Motion, OfACommandIsTheDirectOne) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Plan plan;
    plan.path = path_of("G4 P0.5\n" + random_program(seed, 300) + "G4 P0.7\nG1 X1 Y1\nG4 P0.02\n");
    std::mt19937 random(seed);
    FilteredCommand command{seed % 2 == 0 ? trapezoid(40, 10) : boxcar(7), std::vector<int>(plan.path.blocks(), 0)};
    for (int& delay : command.delays) delay = random() % 3 == 0 ? static_cast<int>(random() % 50) : 0;
    command.delays.back() = 0;
    const DirectMotion direct = direct_motion(plan.path, period, command.delays, {{command.filter}, {}});
    plan.motion = command;
    Motion motion(plan, period);
    std::int64_t next = 0;
    double worst = 0.0, fastest = 0.0;
    for (Sample sample; motion.next(sample); ++next) {
      ASSERT_EQ(sample.number, next);
      const auto k = std::min(static_cast<std::size_t>(direct.kept(next)), direct.position[0].size() - 1);
      for (std::size_t a = 0; a < plan.path.dimensions(); ++a) {
        worst = std::max(worst, std::abs(sample.position[a] - direct.position[a][k]));
        fastest = std::max(fastest, std::abs(sample.velocity[a] - direct.velocity[a][k]));
      }
    }
    EXPECT_LT(static_cast<std::int64_t>(direct.position[0].size()), direct.samples - 1000)
        << "long rests are cut short";
    EXPECT_EQ(next, direct.samples + 1) << "the start is sample 0, the last is at rest";
    EXPECT_LT(worst, 1e-12);
    EXPECT_LT(fastest, 1e-9);
  }
}

// A trajectory ends with a sample at rest, too: its number is the count of samples, whatever the plan.
TEST(Motion, OfATrajectoryEndsAtRest) {
  Task task;
  task.machine = machine(1.0, 1.0);
  const ProgramResult result = run_profiles({"a", path_of("G64 P0.05\nG1 F6000 X30\nY30\n", task.machine), task});
  ASSERT_TRUE(result.verification.feasible) << result.message;
  Motion motion(result.plan, period);
  Sample sample, last;
  while (motion.next(sample)) last = sample;
  EXPECT_EQ(last.number, result.check.samples);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(last.velocity[a], 0.0);
    EXPECT_NEAR(last.position[a], 0.03, 1e-15);
  }
}

/// m, from a sample to the nearest of blocks first .. last.
double off_blocks(const Toolpath& path, const Sample& sample, std::size_t first, std::size_t last) {
  double nearest = unlimited;
  for (std::size_t b = first; b <= std::min(last, path.blocks() - 1); ++b) {
    const double *from = path.point(b), *to = path.point(b + 1);
    double along = 0.0, length2 = 0.0, square = 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a) {
      along += (sample.position[a] - from[a]) * (to[a] - from[a]);
      length2 += (to[a] - from[a]) * (to[a] - from[a]);
    }
    const double part = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a)
      square += std::pow(from[a] + part * (to[a] - from[a]) - sample.position[a], 2);
    nearest = std::min(nearest, std::sqrt(square));
  }
  return nearest;
}

// Between exact stops every sample is on its leg, and the other legs are elsewhere.
TEST(Motion, OfASampleNamesTheBlocksThatItMayBeOn) {
  Task task;
  task.machine = machine(1.0, 1.0);
  const Toolpath path = path_of("G4 P0.2\nG61.1 F6000\nG1 X30\nY20\nX10\nG4 P0.3\nY5\nX40\n", task.machine);
  const ProgramResult fixed = run_program({"a", path, task}, trapezoid(40, 10)),
                      profiles = run_profiles({"a", path, task});
  Plan sampled = profiles.plan;
  FreeMotion free;
  Motion motion(profiles.plan, period);
  Sample sample;
  motion.next(sample);
  for (std::size_t block = 0; motion.next(sample);) {
    while (off_blocks(path, sample, block, block) > 1e-9 && block + 1 < path.blocks()) ++block;
    free.position.insert(free.position.end(), sample.position.begin(),
                         sample.position.begin() + static_cast<std::ptrdiff_t>(path.dimensions()));
    free.block.push_back(static_cast<std::uint32_t>(block));
  }
  sampled.motion = Trajectory{{}, Filter({1.0}), free};
  for (const Plan& plan : {fixed.plan, profiles.plan, sampled}) {
    ASSERT_FALSE(plan.empty());
    const std::size_t most = plan.command() != nullptr ? 1 : 3;  // a trajectory names one more on either side
    Motion all(plan, period);
    std::pair<std::size_t, std::size_t> blocks;
    while (all.next(sample)) {
      blocks = all.blocks();
      ASSERT_LT(off_blocks(plan.path, sample, blocks.first, blocks.second), 1e-9) << "sample " << sample.number;
      ASSERT_LE(blocks.second - blocks.first, most) << "sample " << sample.number;
    }
    EXPECT_GE(blocks.second, plan.path.blocks() - 1);
  }
}

TEST(Stretched, KeepsTheShape) {
  for (const int count : {3, 17, 40, 64}) {
    const Filter box = stretched(boxcar(39), count);
    ASSERT_EQ(box.order(), count - 1);
    for (int i = 0; i < count; ++i) EXPECT_NEAR(box.tap(i), 1.0 / count, 1e-15);
    const Filter smooth = stretched(blackman_sinc(40, 0.049), count);
    for (int i = 0; i < count; ++i) EXPECT_NEAR(smooth.tap(i), smooth.tap(count - 1 - i), 1e-14);
    EXPECT_NEAR(smooth.mean_delay() + 0.5, count / 41.0 * 20.5, 1e-12);
  }
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
