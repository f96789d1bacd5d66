#include <random>

#include <gtest/gtest.h>

#include <accdec/task/check_delays.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/verify.hpp>

#include "support/convolution.hpp"
#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;
using testing::random_filter;

// The simulation adds up what each of the command's four changes does; here every sample of the command is convolved.
TEST(Simulation, IsThePlainConvolution) {
  std::mt19937 rng(7);
  for (int order : {0, 1, 2, 5, 17, 60, 200}) {
    for (int delay : {0, 1, order / 2, order, order + 1, order + 5}) {
      const Filter filter = random_filter(rng, order);
      const Corner corner = plane_corner("A", 30.0 + 0.5 * order, 20.0, 0.1, 0.07).geometry();
      const SampledMotion m = simulate_corner(filter, corner, delay, 1e-3);
      const test::Convolution plain(filter, filter, corner, delay, 1e-3);
      for (int k = 0; k <= order + delay + 2; ++k) {
        const int row = m.corner + k;
        // A velocity of 0.1 m/s is rounded at 1e-17; positions add up some hundred of them.
        EXPECT_LT((m.velocity.row(row).transpose() - plain.velocity(k)).norm(), 1e-15)
            << order << " " << delay << " " << k;
        EXPECT_LT((m.position.row(row).transpose() - plain.position(k)).norm(), 1e-15);
      }
      EXPECT_EQ(m.velocity.row(m.start).norm(), 0.0);
      EXPECT_EQ(m.velocity.bottomRows(1).norm(), 0.0);
      EXPECT_NEAR(m.velocity.row(m.cruise_in).norm(), 0.1, 1e-16);
      EXPECT_NEAR(m.velocity.row(m.cruise_out).norm(), 0.07, 1e-16);
    }
  }
}

// Every worst value is found again where the verifier says it was reached, and a larger one nowhere else.
TEST(Simulation, ValuesStandWhereTheyAreSaidToBe) {
  std::mt19937 rng(8);
  for (int i = 0; i < 50; ++i) {
    const Task task = testing::random_task(rng, 2);
    const Filter filter = random_filter(rng, 12);
    const std::vector<int> delays{i % 14, 3};
    std::vector<LimitUse> uses;
    verify_by_simulation(task, filter, delays, &uses);
    for (LimitUse use : uses) {
      const double there = value_where(task, filter, delays, use);
      EXPECT_NEAR(std::max(0.0, there), use.value,
                  1e-12 * use.value + (use.kind == LimitKind::corner_error ? position_floor : 0.0))
          << describe(use);
      if (use.kind == LimitKind::vibration) continue;
      use.sample = 1'000'000;
      EXPECT_TRUE(std::isnan(value_where(task, filter, delays, use)));
    }
  }
}

TEST(NoDelays, AreClaimedOnlyWhereEveryOneBreaksALimit) {
  Axis axis;
  axis.acceleration_max = 1.0;
  const Filter five({1.0, 1.0, 1.0, 1.0, 1.0});
  // From rest to 0.1 m/s in five samples of 20 ms is 1 m/s^2, which just holds; in samples of 19 ms it does not.
  Task task = plane_task(axis, plane_corner("A", 90.0, 0.0, 0.1, 0.1), 1e-3);
  task.sample_period = 20e-3;
  EXPECT_NE(check_no_delays(task, five), "");
  task.sample_period = 19e-3;
  EXPECT_EQ(check_no_delays(task, five), "");
  // Without delay the corner is cut by v T E|i - 2| cos 45 = 0.1 * 0.02 * 1.2 * 0.707 = 1.7 mm.
  task.sample_period = 20e-3;
  task.corners[0].delay = 0;
  EXPECT_EQ(check_no_delays(task, five), "");
  task.corners[0].error_max = 2e-3;
  EXPECT_NE(check_no_delays(task, five), "");
  task.machine.modes.push_back({10.0, 10.0, 1e-6});  // five samples of 20 ms are one period of 10 Hz: |H| = 0
  EXPECT_NE(check_no_delays(task, five), "");
  task.machine.modes.back() = {5.0, 5.0, 0.5};  // half a period: |H| = 1 / (5 sin(pi/10)) = 0.65
  EXPECT_EQ(check_no_delays(task, five), "");
}

}  // namespace
}  // namespace accdec
