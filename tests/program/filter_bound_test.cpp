#include <filesystem>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/filter_bound.hpp>
#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/program.hpp>

#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

using test::period;

TEST(FilterBound, ExactStopsAreTheBoxcarsOfBothLegs) {
  // A boxcar of w taps lags by (w - 1)/2, and the other half of its length is left when its last tap begins.
  for (const double turn : {-0.9, 0.0, 0.7}) {
    EXPECT_NEAR(least_separation(1e-4, 1e-4, 1.0 / 100.0, 1.0 / 100.0, turn, 0.0), 99.0, 2e-3);
    EXPECT_NEAR(least_separation(1e-4, 2e-4, 1.0 / 30.0, 1.0 / 60.0, turn, 0.0), 0.5 * (29.0 + 59.0), 2e-3);
  }
}

TEST(FilterBound, EqualLegsAroundASymmetricCornerTakeTheBoxcarsOfTheClosedForm) {
  // eps = v tau/4 cos(theta/2) (1 - d T/tau)^2, Eq. (12), in continuous time: the samples make at most a sample of
  // difference each way.
  const double step = 1e-4;
  const int taps = 100;
  for (const double theta : {0.6, 1.2, 1.5707963267948966}) {
    for (const double share : {0.05, 0.2, 0.5}) {
      const double tau = taps * period, error = share * step / period * tau / 4.0 * std::cos(0.5 * theta);
      const double delay = taps * (1.0 - std::sqrt(share));
      EXPECT_NEAR(least_separation(step, step, 1.0 / taps, 1.0 / taps, std::cos(theta), error), delay, 1.0);
    }
  }
}

TEST(FilterBound, NoPairOfRandomFiltersIsCloser) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double closest = 1e300;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto filter = [&] {
      std::vector<double> taps(4 + random() % 30);
      const double ripple = unit(random);
      for (double& tap : taps) tap = 1.0 - ripple * unit(random);
      return Filter(taps);
    };
    const Filter in = filter(), out = filter();
    const double heading = 0.4 + 2.6 * unit(random), v1 = 0.05 + 0.1 * unit(random), v2 = 0.05 + 0.1 * unit(random);
    const Eigen::Vector2d first(1.0, 0.0), second(std::cos(heading), std::sin(heading));
    const Corner corner = make_corner(first, second, v1, v2);
    const int d = static_cast<int>(random() % 40);
    const double error = corner_error(Blend(in, out, corner, d, period));
    const auto largest = [](const Filter& f) { return *std::max_element(f.taps().begin(), f.taps().end()); };
    const double separation = d + out.mean_delay() - in.mean_delay();
    const double bound = least_separation(v1 * period, v2 * period, largest(in), largest(out), -first.dot(second),
                                          error * (1.0 + 1e-12) + 1e-15);
    EXPECT_LE(bound, separation + 1e-9) << "trial " << trial;
    closest = std::min(closest, separation - bound);
  }
  EXPECT_LT(closest, 1.0);
}

TEST(FilterBound, HoldsForTheProgramsMeasuredAgainstLinuxCNC) {
  Machine limits;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = 1.0;
    limits.axes.push_back(axis);
  }
  Task task;
  task.machine = limits;
  for (const auto& entry :
       std::filesystem::directory_iterator(accdec::test_support::source_folder() + "/problems/program/linuxcnc")) {
    if (entry.path().extension() != ".ngc") continue;
    LineSource source(entry.path());
    Toolpath path = read_toolpath(source, limits, {});
    {
      const ProgramResult result = run_program({"a", path, task}, boxcar(99));
      const double bound =
          filter_lower_bound(result.plan.path, program_machine(limits, path), task.sample_period).value();
      EXPECT_TRUE(result.verification.feasible) << entry.path();
      EXPECT_LE(bound, result.cycle_time + 1e-9) << entry.path();
      // A lone corner of legs along the axes leaves only the whole samples of its delay out.
      if (entry.path().filename().string().starts_with("corner")) {
        EXPECT_GE(bound, result.cycle_time - 1.01 * task.sample_period) << entry.path();
      }
    }
  }
}

// From rest to rest along L takes at least 2 sqrt(L/a), at a feed of sqrt(L a). At the programmed feed every filter
// takes longer than the block.
TEST(FilterBound, IsNoneForABlockTooShortForItsFeed) {
  Machine limits;
  Axis axis;
  axis.name = "x";
  axis.acceleration_max = 1.0;
  limits.axes.push_back(axis);
  const auto bound = [&](const char* feed) {
    return filter_lower_bound(test::path_of(fmt::format("F{}\nG1 X5\nM2\n", feed), limits), limits, 1e-3);
  };
  EXPECT_FALSE(bound("12000").has_value());  // 200 ms to start, 25 ms long
  EXPECT_FALSE(bound("4400").has_value());   // 73 and 68 ms
  EXPECT_NEAR(bound("4000").value(), 5.0 / (4000.0 / 60.0) + 4.0 / 60.0, 2e-3);
}

}  // namespace
}  // namespace accdec
