#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include <accdec/gcode/generate.hpp>
#include <accdec/plan/trajectory/chain_maker.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/simulate/profile_motion.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::machine_of;
using test::path_of;
using test::random_program;

std::string generated(GeneratedProgram kind, long blocks) {
  std::ostringstream text;
  GenerateOptions options;
  options.blocks = blocks;
  options.feed = 6000.0;
  generate_program(kind, options, text);
  return std::move(text).str();
}

TEST(ChainMaker, AChainMadeAgainIsAsOneMadeFirst) {
  const Machine m = machine_of(1.0, 50.0, 0.2, 3);
  const Toolpath path = path_of(random_program(7, 200) + "M2\n", m);
  const AvailableAcceleration available(m, 1e-3, LastFilter(20, 1e-3));
  ChainMaker again(path, available);
  ProfileShares shares(path.blocks());
  for (int round = 0; round < 4; ++round) {
    for (std::size_t p = static_cast<std::size_t>(round); p < shares.acceleration.size(); p += 7) {
      shares.acceleration[p] *= 0.8F;
      shares.speed[p / 2] *= 0.9F;
    }
    const ProfileChain& chain = again.make(shares);
    ChainMaker fresh(path, available);
    const ProfileChain& first = fresh.make(shares);
    EXPECT_EQ(chain.speed, first.speed);
    EXPECT_EQ(chain.speed_max, first.speed_max);
    EXPECT_EQ(chain.stretch, first.stretch);
    EXPECT_EQ(chain.coast, first.coast);
    EXPECT_EQ(chain.ramp, first.ramp);
    EXPECT_EQ(chain.peak, first.peak);
  }
}

// Programs of more than 50 000 blocks are made again as a whole while many of their parts break a limit.
TEST(ChainMaker, LongProgramsHoldByDifferencesOfTheirSamples) {
  const Machine m = machine_of(10.0, 1000.0, 0.5, 3);
  constexpr double period = 1e-3;
  const Toolpath path = path_of(generated(GeneratedProgram::relief, 51'000), m);
  ASSERT_GT(path.blocks(), 50'000U);
  const ProfilePlan plan = plan_profiles(path, m, period);
  EXPECT_TRUE(plan.holds());
  ProfileMotion motion(path, plan.chain, period, plan.last);
  double worst = 0.0;
  std::array<std::array<long double, 3>, 4> x{};
  for (auto& row : x) std::copy_n(path.point(0), 3, row.begin());
  std::int64_t samples = 1;
  for (; motion.next(); ++samples) {
    std::rotate(x.begin(), x.begin() + 3, x.end());
    std::copy_n(motion.position(), 3, x[0].begin());
    for (std::size_t a = 0; a < 3; ++a) {
      const long double second = x[0][a] - 2 * x[1][a] + x[2][a];
      const long double third = x[0][a] - 3 * x[1][a] + 3 * x[2][a] - x[3][a];
      worst = std::max(worst, static_cast<double>(std::abs(second) / (period * period) / m.axes[a].acceleration_max));
      worst = std::max(worst, static_cast<double>(std::abs(third) / std::pow(period, 3) / m.axes[a].jerk_max));
    }
  }
  EXPECT_EQ(samples, plan.check.samples);
  // 8 half units of positions below 1 m, over T^3.
  EXPECT_LE(worst, 1.0 + 1e-8 + 8.0 * 1.2e-16 / std::pow(period, 3) / 1000.0);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(motion.position()[a], path.point(path.blocks())[a], 1e-12);
}

// All samples behind the part stay the same. On moves of two samples, one leg has no room for a change of speed.
TEST(ChainMaker, AShortPartOfARasterEndsWholeSamplesLater) {
  const Machine m = machine_of(1.0, 50.0, 0.2, 3);
  constexpr double period = 1e-3;
  const Toolpath path = path_of(generated(GeneratedProgram::raster, 3000), m);
  const AvailableAcceleration available(m, period, LastFilter(20, period));
  ChainMaker maker(path, available);
  ProfileShares shares(path.blocks());
  std::vector<double> phases(path.blocks());
  ProfileMotion motion(path, maker.make(shares), period, available.last().filter());
  motion.note_phases(phases);
  while (motion.next()) {
  }
  constexpr std::size_t reach = 12;  // legs, about 0.03 s
  int remade = 0, tried = 0;
  for (std::size_t b = 2 * reach; b + 2 * reach < path.blocks(); b += 3 * reach, ++tried) {
    const ProfileChain before = maker.chain();
    shares.speed[b] *= 0.97F;
    if (!maker.remake(shares, b - reach, b + reach, phases)) continue;
    ++remade;
    const ProfileChain& after = maker.chain();
    const double later = chain_time(after, b - reach, b + reach + 1) - chain_time(before, b - reach, b + reach + 1);
    EXPECT_NEAR(later / period, std::round(later / period), 1e-6);
    EXPECT_GE(later, -1e-9 * period);
    EXPECT_EQ(after.speed[b - reach], before.speed[b - reach]);
    EXPECT_EQ(after.speed[b + reach + 1], before.speed[b + reach + 1]);
    EXPECT_LE(after.speed[b], 0.97001 * before.speed_max[b]);
  }
  EXPECT_GT(tried, 20);
  EXPECT_EQ(remade, tried);
}

}  // namespace
}  // namespace accdec
