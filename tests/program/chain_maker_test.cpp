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

std::string relief(long blocks) {
  std::ostringstream text;
  GenerateOptions options;
  options.blocks = blocks;
  options.feed = 6000.0;
  generate_program(GeneratedProgram::relief, options, text);
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
  const Toolpath path = path_of(relief(51'000), m);
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

}  // namespace
}  // namespace accdec
