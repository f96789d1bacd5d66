#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design/identify.hpp>

#include "simulated_log.hpp"

// Logs that several moves explain, and logs whose samples lie between those of the control.

namespace accdec {
namespace {

using namespace accdec::testing;

const FittedFilter* listed(const Identification& found, const std::vector<int>& lengths) {
  const auto fit = std::ranges::find_if(found.fits, [&](const FittedFilter& one) {
    return one.family == SettingFamily::averages && one.filter.lengths == lengths;
  });
  return fit == found.fits.end() ? nullptr : &*fit;
}

/// m, root of the mean square of the difference of the log and a fit's move behind its averages, by the definition.
double difference(const MotionLog& log, const FittedFilter& fit) {
  const LoggedMove& move = fit.moves.front();
  const MotionLog like = simulated(taps_of(fit.filter.lengths), {{move.way[0], move.way[1], move.samples, 0}}, 0.0, 1);
  double squares = 0.0;
  long count = 0;
  for (std::size_t k = 0; k < log.samples(); ++k) {
    // The simulation begins to move in the sample behind its 39th.
    const long at = static_cast<long>(k) + 39 - move.first;
    const long last = static_cast<long>(like.samples()) - 1;
    squares += std::pow(log.position[0][k] - like.position[0][static_cast<std::size_t>(std::clamp(at, 0L, last))], 2);
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(count));
}

/// Averages and a move are factors of one product. A move of 15 behind 40 and 10 is one of 40 behind 15 and 10, and one
/// of 10 behind 40 and 15. One sample of 0.1 um tells nothing of them; neighbours are far behind.
TEST(IdentifyReadings, AMoveMayBeShorterThanAnAverage) {
  const double noise = 1e-7;
  const std::vector<std::pair<std::vector<int>, int>> all{{{40, 10}, 15}, {{15, 10}, 40}, {{40, 15}, 10}};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const MotionLog log = simulated(taps_of({40, 10}), {{0.0045, 0.0, 15, 0}}, {noise, 0.0}, seed);
    const Identification found = identify(log, task_of());
    for (const auto& [lengths, samples] : all) {
      const FittedFilter* fit = listed(found, lengths);
      ASSERT_NE(fit, nullptr) << lengths[0] << " " << lengths[1];
      EXPECT_EQ(fit->moves.front().samples, samples);
      EXPECT_NEAR(fit->moves.front().way[0], 0.0045, 1e-6);
      EXPECT_GT(fit->likelihood, 0.25);
      EXPECT_NEAR(fit->likelihood, found.fits.front().likelihood, 1e-3);
    }
    // The longest move stands first.
    EXPECT_EQ(found.fits.front().filter.lengths, (std::vector<int>{15, 10}));
    for (const FittedFilter& fit : found.fits) {
      if (fit.family != SettingFamily::averages || fit.moves.front().last_step < 1.0 ||
          fit.moves.front().first_step < 1.0)
        continue;
      EXPECT_LT(difference(log, fit), 1.5 * noise) << fit.filter.lengths[0];
    }
  }
}

/// 4.5 mm in 15 samples are 300 mm/s; in 10 samples, 450 mm/s; in 40, 112.5 mm/s.
TEST(IdentifyReadings, TheFeedTellsThemApart) {
  const MotionLog log = simulated(taps_of({40, 10}), {{0.0045, 0.0, 15, 0}}, {1e-7, 0.0}, 1);
  for (const auto& [feed, lengths] : {std::pair(0.3, std::vector{40, 10}), std::pair(0.1125, std::vector{15, 10})}) {
    const Identification found = identify(log, task_of(), {.feed = feed});
    EXPECT_EQ(found.fits.front().filter.lengths, lengths);
    for (const FittedFilter& fit : found.fits) EXPECT_NEAR(fit.moves.front().feed(period), feed, 0.07 * feed);
  }
  EXPECT_THROW(identify(log, task_of(), {.feed = 0.2}), std::invalid_argument);
  Task task = task_of();
  task.machine.axes = {Axis{.name = "x", .velocity_max = 0.35}};
  const Identification limited = identify(log, task);
  EXPECT_NE(listed(limited, {40, 10}), nullptr);
  EXPECT_NE(listed(limited, {15, 10}), nullptr);
  EXPECT_EQ(listed(limited, {40, 15}), nullptr);
}

/// An average of 22 is one of 11 with impulses 11 samples apart: one fit with two names. Its move of 60 may be an
/// average, and a move of 11 with such impulses is one of 22. All move alike. With more numbers a share is less.
TEST(IdentifyReadings, TheSameMotionIsAsLikelyByAnyName) {
  const MotionLog log = simulated(taps_of({22}), {{0.006, 0.0, 60, 0}}, {1e-6, 0.0}, 1);
  const Identification found = identify(log, task_of());
  const FittedFilter& best = found.fits.front();
  EXPECT_EQ(best.filter.lengths, std::vector<int>{22});
  const auto is_zv = [](const FittedFilter& fit, int length) {
    return fit.family == SettingFamily::shaper && fit.filter.lengths == std::vector<int>{length} &&
           fit.filter.pairs == 1 && fit.filter.pair_delay == 11.0;
  };
  EXPECT_TRUE(std::ranges::any_of(best.aliases, [&](const FittedFilter& fit) { return is_zv(fit, 11); }));
  EXPECT_TRUE(std::ranges::none_of(found.fits, [&](const FittedFilter& fit) { return is_zv(fit, 11); }));
  const auto other = std::ranges::find_if(found.fits, [&](const FittedFilter& fit) { return is_zv(fit, 60); });
  ASSERT_NE(other, found.fits.end());
  EXPECT_NEAR(other->sigmas, 0.0, 0.05);
  EXPECT_LT(other->likelihood, 0.1 * best.likelihood);
  const FittedFilter* exchanged = listed(found, {60});
  ASSERT_NE(exchanged, nullptr);
  EXPECT_NEAR(exchanged->likelihood, best.likelihood, 1e-3);
}

/// 15 samples and 0.4 of one: no average has that length, so the log tells the move from the averages.
TEST(IdentifyReadings, AShortMoveWithAShorterLastStep) {
  const std::vector<Leg> legs{{0.0045, 0.0, 15, 0}, {0.00012, 0.0, 1, 0}};
  const Identification found = identify(simulated(taps_of({40, 10}), legs, {1e-8, 0.0}, 1), task_of());
  EXPECT_EQ(found.fits.front().filter.lengths, (std::vector<int>{40, 10}));
  EXPECT_EQ(found.fits.front().moves.front().samples, 16);
  EXPECT_NEAR(found.fits.front().moves.front().last_step, 0.4, 0.01);
}

/// Positions between two samples of the control: the log's clock is later by a part of a sample.
MotionLog later(const MotionLog& log, double part) {
  MotionLog between = log;
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    for (std::size_t k = 0; k + 1 < log.samples(); ++k)
      between.position[a][k] = (1.0 - part) * log.position[a][k] + part * log.position[a][k + 1];
  }
  return between;
}

MotionLog with_noise(MotionLog log, double noise, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> error(0.0, noise);
  for (std::vector<double>& at : log.position) {
    for (double& x : at) x += error(engine);
  }
  return log;
}

TEST(IdentifyReadings, TheLogMayLieBetweenSamplesOfTheControl) {
  for (const std::vector<int>& lengths : std::vector<std::vector<int>>{{24}, {22, 22}, {30, 4}, {19, 12, 5}}) {
    for (const double part : {0.25, 0.37, 0.7}) {
      const MotionLog log = later(simulated(taps_of(lengths), straight_legs, {0.0, 0.0}, 1), part);
      const Identification found = identify(with_noise(log, 2e-8, 3), task_of());
      EXPECT_EQ(found.fits.front().filter.lengths, lengths) << part;
      EXPECT_NEAR(found.fits.front().moves.front().first_step, part, 0.02);
      EXPECT_NEAR(found.fits.front().moves.front().last_step, 1.0 - part, 0.02);
      EXPECT_NEAR(found.fits.front().moves.front().feed(period), 0.1, 1e-4);
    }
  }
  const MotionLog turning = later(simulated(taps_of({22, 22}), corner, {0.0, 0.0}, 1), 0.37);
  const FittedFilter best = identify(with_noise(turning, 2e-8, 3), task_of()).fits.front();
  EXPECT_EQ(best.filter.lengths, (std::vector<int>{22, 22}));
  EXPECT_NEAR(delay_between(best.moves[0], best.moves[1]), 12.0, 0.05);
}

/// At 1 um of noise the part cannot be told from a third average of two samples: whichever stands first, the truth is
/// listed with its share.
TEST(IdentifyReadings, NoiseLeavesTheTruthAmongThoseListed) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const MotionLog log = later(simulated(taps_of({26, 14}), straight_legs, {0.0, 0.0}, 1), 0.5);
    const Identification found = identify(with_noise(log, 1e-6, seed), task_of());
    const FittedFilter* truth = listed(found, {26, 14});
    ASSERT_NE(truth, nullptr) << seed;
    EXPECT_GT(truth->likelihood, 0.01) << seed;
  }
}

}  // namespace
}  // namespace accdec
