#include <cmath>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate/simulate.hpp>

#include "reference.hpp"

namespace accdec {
namespace {

using test::path_of;
using test::period;
using test::random_program;
using test::Reference;

std::vector<int> random_delays(const Toolpath& path, int largest, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> delays(path.blocks(), 0);
  for (int& d : delays) d = random() % 3 == 0 ? static_cast<int>(random() % static_cast<unsigned>(largest + 1)) : 0;
  delays.back() = 0;
  return delays;
}

TEST(Simulation, EqualsConvolutionOfTheCommandByDefinition) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Toolpath path = path_of((seed % 4 == 0 ? "G4 P0.345\n" : "") + random_program(seed, 300) +
                                  (seed % 3 == 0 ? "G4 P0.0567\nG4 P1.2\n" : ""));
    const Filter filter = seed % 3 == 0   ? boxcar(25)
                          : seed % 3 == 1 ? blackman_sinc(40, 0.049)
                                          : Filter({0.1, 3.0, 0.0, 1.0, 0.5, 0.0});
    const std::vector<int> delays = random_delays(path, filter.order() + 3, seed);
    const Reference reference(path, filter, period, delays);
    const CommandTiming timing(path, period, delays);
    std::vector<double> errors(path.blocks(), 0.0);

    const Simulation quick = simulate_program(timing, filter, 0, path.blocks() - 1, errors);
    // The time model is exact: as many samples as the stream has.
    EXPECT_EQ(timing.command_samples(), static_cast<std::int64_t>(reference.command.size()) - 1);
    EXPECT_EQ(quick.samples, timing.command_samples() + filter.order() + 1);
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      const double expected = reference.error(path, filter.order(), b);
      // The search downhill may stop in a second minimum, but only if that holds the bound.
      EXPECT_GE(errors[b], expected - 1e-13) << "seed " << seed << " joint " << b;
      if (expected > path.tolerance[b] || errors[b] > path.tolerance[b]) {
        EXPECT_NEAR(errors[b], expected, 1e-13) << "seed " << seed << " joint " << b;
      }
    }

    SimulationOptions whole;
    whole.whole_windows = true;
    std::vector<double> least(path.blocks(), 0.0);
    simulate_program(timing, filter, 0, path.blocks() - 1, least, whole);
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      EXPECT_NEAR(least[b], reference.error(path, filter.order(), b), 1e-13) << "seed " << seed << " joint " << b;
    }

    std::int64_t next = 1;
    double worst = 0.0;
    SimulationOptions options;
    options.samples = [&](std::int64_t first, std::int64_t count, const double* const* position, const double* const*) {
      EXPECT_EQ(first, next);
      next += count;
      for (std::int64_t k = 0; k < count; ++k) {
        const auto sample = std::min(static_cast<std::size_t>(first + k), reference.position.size() - 1);
        for (std::size_t a = 0; a < path.dimensions(); ++a) {
          worst = std::max(worst, std::abs(position[a][k] - reference.position[sample][a]));
        }
      }
    };
    simulate_program(timing, filter, 0, path.blocks() - 1, errors, options);
    EXPECT_LT(worst, 1e-13) << "seed " << seed;
    EXPECT_GE(next, quick.samples);
  }
}

TEST(Simulation, AgreesWithTheBlendOfALoneCorner) {
  const Toolpath path = path_of("G64 P1\nG1 F6000 X50\nX80 Y40\n");
  const Filter filter = blackman_sinc(40, 0.049);
  for (const int d : {0, 5, 15, 40}) {
    const std::vector<int> delays{d, 0};
    const CommandTiming timing(path, period, delays);
    std::vector<double> errors(2, 0.0);
    const Simulation result = simulate_program(timing, filter, 0, 1, errors);
    const Corner corner = make_corner(Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(3.0, 4.0), 0.1, 0.1);
    EXPECT_NEAR(errors[0], corner_error(Blend(filter, corner, d, period)), 1e-15);
    EXPECT_EQ(result.samples, 500 + d + 500 + 41);
  }
}

TEST(Simulation, WatchesTheLimitsOfEveryAxis) {
  // Long legs: the limits of the program are those of its one corner and its ends.
  Machine machine;
  for (const char* name : {"x", "y"}) {
    machine.axes.push_back({name, 0.2, 5.0, 400.0, 50.0, 300.0, 400.0, 60.0, 50.0});
  }
  const Toolpath path = path_of("G64 P1\nG1 F6000 X50\nX20 Y40\n", machine);
  const Filter filter = trapezoid(30, 8);
  const std::vector<int> delays{7, 0};
  const CommandTiming timing(path, period, delays);
  std::vector<double> errors(2, 0.0);
  const Simulation result = simulate_program(timing, filter, 0, 1, errors, {&machine, false, {}});
  const Corner corner = make_corner(Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(-3.0, 4.0), 0.1, 0.1);
  const std::vector<LimitUse> expected = axis_utilisation(filter, corner, 7, period, machine);
  ASSERT_EQ(result.limits.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(result.limits[i].kind, expected[i].kind);
    EXPECT_EQ(result.limits[i].axis, expected[i].axis);
    EXPECT_NEAR(result.limits[i].value, expected[i].value, 1e-9 * expected[i].bound);
  }
}

}  // namespace
}  // namespace accdec
