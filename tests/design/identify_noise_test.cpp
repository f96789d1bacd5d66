#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design/identify.hpp>

#include "simulated_log.hpp"

// Filters found in logs, and how sure the noise leaves them.

namespace accdec {
namespace {

using namespace accdec::testing;

/// The norm of the difference of x behind two filters, m, where a fit chooses start and way.
double way_between(const std::vector<double>& a, const std::vector<double>& b, const std::vector<Leg>& legs) {
  const std::vector<double> x = simulated(a, legs, 0.0, 1).position[0], like = simulated(b, legs, 0.0, 1).position[0];
  const auto mean = [](const std::vector<double>& of) {
    return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(of.size());
  };
  const double mean_x = mean(x), mean_like = mean(like);
  double both = 0.0, squares = 0.0, left = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    both += (x[k] - mean_x) * (like[k] - mean_like);
    squares += std::pow(like[k] - mean_like, 2);
  }
  for (std::size_t k = 0; k < x.size(); ++k)
    left += std::pow(x[k] - mean_x - both / squares * (like[k] - mean_like), 2);
  return std::sqrt(left);
}

/// By how many standard deviations two cascades differ in a log: the norm of the difference of their motions over the
/// noise.
void expect_neighbours_behind(int logs) {
  const double noise = 1e-6;
  const std::vector<double> a = taps_of({22, 22}), b = taps_of({23, 21});
  const double sigmas = way_between(a, b, straight_legs) / noise;
  double mean = 0.0;
  int right = 0;
  for (int seed = 1; seed <= logs; ++seed) {
    const Identification found = identify(simulated(a, straight_legs, noise, static_cast<unsigned>(seed)), task_of(),
                                          {.noise = noise, .sigmas = 8.0});
    right += found.fits.front().filter.lengths == std::vector<int>{22, 22} ? 1 : 0;
    for (const FittedFilter& fit : found.fits) {
      const bool averages = fit.family == SettingFamily::averages;
      if (averages && fit.filter.lengths == std::vector<int>{23, 21}) mean += fit.sigmas * fit.sigmas / logs;
    }
  }
  // The difference of both sums of squares has the mean sigmas^2 and the standard deviation 2 sigmas.
  EXPECT_NEAR(mean, sigmas * sigmas, 4.0 * 2.0 * sigmas / std::sqrt(static_cast<double>(logs)) + 0.1 * sigmas * sigmas);
  EXPECT_GE(right, logs * 8 / 10);
}

TEST(Identify, SaysHowFarNeighboursAreBehind) {
  expect_neighbours_behind(6);
}

TEST(IdentifyManyLogs, SayHowFarNeighboursAreBehind) {
  expect_neighbours_behind(20);
}

/// Pooled with y, which rests without any, the noise of x would be less by the root of two.
TEST(Identify, AnAxisThatRestsDoesNotCount) {
  const double noise = 1e-6;
  double mean = 0.0;
  constexpr int logs = 4;
  for (unsigned seed = 1; seed <= logs; ++seed) {
    const Identification found = identify(simulated(taps_of({22, 22}), straight_legs, {noise, 0.0}, seed), task_of());
    EXPECT_EQ(found.fits.front().family, SettingFamily::averages);
    mean += found.noise / logs;
  }
  // About 150 values a log: the mean of four is known to 3 %.
  EXPECT_NEAR(mean, noise, 0.1 * noise);
}

/// Two axes with the same motion and noises of 0.3 and 6 um: the sum of the squares of the way over each noise.
TEST(Identify, AxesCountByTheirNoise) {
  const std::vector<double> a = taps_of({22, 22}), b = taps_of({23, 21});
  const std::array<double, 2> noise{0.3e-6, 6e-6};
  const std::vector<Leg> legs{{0.02, 0.02, 200, 0}};
  const double way = way_between(a, b, legs), sigmas = std::hypot(way / noise[0], way / noise[1]);
  double mean = 0.0;
  constexpr int logs = 8;
  for (unsigned seed = 1; seed <= logs; ++seed) {
    const Identification found =
        identify(simulated(a, legs, noise, seed), task_of(), {.noise = {}, .sigmas = 3.0 * sigmas});
    EXPECT_EQ(found.fits.front().filter.lengths, (std::vector<int>{22, 22}));
    for (const FittedFilter& fit : found.fits) {
      const bool averages = fit.family == SettingFamily::averages && fit.filter.lengths == std::vector<int>{23, 21};
      if (averages) mean += fit.sigmas * fit.sigmas / logs;
    }
  }
  EXPECT_NEAR(mean, sigmas * sigmas, 4.0 * 2.0 * sigmas / std::sqrt(static_cast<double>(logs)) + 0.1 * sigmas * sigmas);
}

/// The taps of LinuxCNC's interpolator, 100 um a sample. The nearest of all Gaussians has ways 0.27 um off in two
/// samples of each ramp: squares of 0.29 um^2 together. Chance explains 4 + 4 sqrt(8) = 15.3 squares of the noise with
/// four taps. At 0.05 um the Gaussian leaves 118 of them, with a standard deviation of 2 sqrt(118) = 22. At 0.1 um it
/// leaves 29 +- 11, which is less in about one log of nine.
void expect_four_taps(int logs) {
  const std::vector<double> taps{1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12};
  for (const auto& [noise, least] : {std::pair(5e-8, logs), std::pair(1e-7, logs * 3 / 4)}) {
    int right = 0;
    for (int seed = 1; seed <= logs; ++seed) {
      const Identification found =
          identify(simulated(taps, straight_legs, noise, static_cast<unsigned>(seed)), task_of());
      if (found.fits.front().family != SettingFamily::taps) continue;
      ++right;
      // The true taps leave the noise, which some 110 values tell to 7 %.
      EXPECT_LT(found.noise, 1.2 * noise) << seed;
    }
    EXPECT_GE(right, least) << noise;
  }
}

TEST(Identify, NamesNoGaussianForFourTaps) {
  expect_four_taps(3);
}

TEST(IdentifyManyLogs, NameNoGaussianForFourTaps) {
  expect_four_taps(8);
}

/// Noise that is there only while the filter acts: ways of 43 taps change in 43 samples after the start and after the
/// stop. All figures of fit are that noise, whatever lies before, between and behind. A figure of 86 values is known to
/// 7.6 %, the mean of four to 3.8 %.
TEST(Identify, FitsAreJudgedWhereTheFilterActs) {
  const double noise = 1e-6;
  double mean = 0.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    MotionLog log = simulated(taps_of({22, 22}), straight_legs, 0.0, 1);
    std::mt19937 engine(seed);
    std::normal_distribution<double> error(0.0, noise);
    for (const std::size_t first : {40, 240}) {
      for (std::size_t k = first; k < first + 43; ++k) log.position[0][k] += error(engine);
    }
    mean += identify(log, task_of()).fits.front().rms / 4.0;
  }
  EXPECT_NEAR(mean, noise, 3.0 * 0.038 * noise);
}

/// Rounded to 1 um at 100 um a sample, rest and constant speed are exact. Rounding is noise of 1 um / sqrt(12), and 86
/// samples of a ramp show 7 % of it. Free taps can repeat it.
TEST(Identify, RoundingIsNoise) {
  const double step = 1e-6, least = step / std::sqrt(12.0);
  for (const std::vector<int>& lengths : std::vector<std::vector<int>>{{12, 9}, {22, 22}, {30, 4}}) {
    for (const double feed : {0.1, 0.05, 0.0973}) {
      const std::vector<Leg> legs{{200 * feed * period, 0.0, 200, 0}};
      MotionLog log = simulated(taps_of(lengths), legs, 0.0, 1);
      for (double& at : log.position[0]) at = step * std::round(at / step);
      const Identification found = identify(log, task_of());
      EXPECT_EQ(found.fits.front().filter.lengths, lengths) << feed;
      EXPECT_NEAR(found.rounding, least, 1e-3 * least);
      EXPECT_GE(found.noise, found.rounding);
      EXPECT_LT(found.noise, 1.3 * least);
    }
  }
  // Steps of an exact log, 100 um / 20: no rounding.
  EXPECT_EQ(identify(simulated(taps_of({20}), straight_legs, 0.0, 1), task_of()).rounding, 0.0);
}

/// One and two numbers more lower the logarithm of the likelihood by log(n) / 2 each. Noise alone explains a number by
/// more than log(n) = 4.7 of its squares in 3 % of all logs; several shapers are tried.
void expect_the_simplest(int logs) {
  for (const auto& [length, noise] : {std::pair(1, 5e-6), std::pair(3, 5e-6), std::pair(7, 5e-6)}) {
    int right = 0;
    for (int seed = 1; seed <= logs; ++seed) {
      const Identification found =
          identify(simulated(taps_of({length}), straight_legs, noise, static_cast<unsigned>(seed)), task_of());
      right += found.fits.front().filter.lengths == std::vector<int>{length} ? 1 : 0;
    }
    EXPECT_GE(right, logs - 1) << length;
  }
}

TEST(Identify, NamesTheSimplestOfShortFilters) {
  expect_the_simplest(3);
}

TEST(IdentifyManyLogs, NameTheSimplestOfShortFilters) {
  expect_the_simplest(8);
}

/// An endless pole in front of a smoothing, whose family ends where 1e-4 of the step is left. Taps have no such end,
/// and a log without noise shows it.
TEST(Identify, APoleWithoutNoiseIsNotTaps) {
  Task task = task_of();
  task.machine.prefilter_taps = {1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12};
  for (const double constant : {4.0, 7.4, 12.0}) {
    std::vector<double> taps(303, 0.0);
    for (std::size_t i = 0; i < 300; ++i) {
      const double tap = std::exp(-static_cast<double>(i) / constant) * (1.0 - std::exp(-1.0 / constant));
      for (std::size_t j = 0; j < 4; ++j) taps[i + j] += tap * task.machine.prefilter_taps[j];
    }
    const FittedFilter best = identify(simulated(taps, {{0.02, -0.01, 200, 0}}, 0.0, 1), task).fits.front();
    EXPECT_EQ(best.family, SettingFamily::one_pole) << constant;
    EXPECT_NEAR(best.time_constant, constant * period, 0.01 * constant * period);
  }
}

}  // namespace
}  // namespace accdec
