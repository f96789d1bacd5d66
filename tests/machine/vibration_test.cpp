#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/machine.hpp>
#include <accdec/machine/velocity_changes.hpp>

#include "support/random_case.hpp"

namespace accdec {
namespace {

using test::integer;
using test::Random;
using test::random_filter;
using test::uniform;

using std::numbers::pi;
constexpr double fast_period = 1e-3;

double plain_response(const Filter& filter, double f) {
  std::complex<long double> sum = 0;
  for (int i = 0; i <= filter.order(); ++i) {
    const long double x = 2.0L * std::numbers::pi_v<long double> * f * i * fast_period;
    sum += static_cast<long double>(filter.tap(i)) * std::complex<long double>(std::cos(x), -std::sin(x));
  }
  return static_cast<double>(std::abs(sum));
}

// Dirichlet kernel: |sin((N + 1) x/2) / ((N + 1) sin(x/2))|, x = 2 pi f T.
TEST(Vibration, BoxcarIsTheDirichletKernel) {
  for (double f : {1.0, 12.5, 24.39, 99.0, 250.0, 499.0}) {
    const double x = 2 * pi * f * fast_period;
    EXPECT_NEAR(residual_vibration(boxcar(40), f, fast_period), std::abs(std::sin(20.5 * x) / (41 * std::sin(x / 2))),
                1e-14);
  }
  EXPECT_NEAR(residual_vibration(boxcar(39), 25.0, fast_period), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(residual_vibration(s_curve(20), 0.0, fast_period), 1.0);
}

// ZV shaper: taps 1/2 at 0 and n leave an undamped mode at f = 1/(2 n T) at rest; |cos(pi f n T)| elsewhere.
TEST(Vibration, ZvShaperLeavesNoResidual) {
  for (int n : {1, 5, 13}) {
    std::vector<double> taps(static_cast<std::size_t>(n) + 1, 0.0);
    taps.front() = taps.back() = 1;
    const Filter zv(taps);
    EXPECT_NEAR(residual_vibration(zv, 1 / (2 * n * fast_period), fast_period), 0.0, 1e-15);
    EXPECT_NEAR(residual_vibration(zv, 17.0, fast_period), std::abs(std::cos(pi * 17.0 * n * fast_period)), 1e-14);
  }
}

// The meaning of "residual": an undamped mode driven by the filtered velocity command rings on, after the start, with
// |H(f)| times the amplitude of an unfiltered step. Sampled exactly: the modal coordinate e^{jwt}-demodulated is the
// sum of the steps.
TEST(Vibration, ResidualIsTheAmplitudeAnUndampedModeKeeps) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Filter filter = random_filter(random, 30);
    const double f = uniform(random, 2, 200), w = 2 * pi * f;
    // x'' + w^2 x = -V' dot: each step of speed dV adds -dV/w sin(w t) to x. Position and speed just after the last
    // step:
    double x = 0, v = 0;
    for (int k = 1; k <= filter.order() + 1; ++k) {
      v -= filter.cumulative(k) - filter.cumulative(k - 1);
      const double c = std::cos(w * fast_period), s = std::sin(w * fast_period);
      const double next_x = c * x + s / w * v, next_v = -w * s * x + c * v;
      x = next_x;
      v = next_v;
    }
    EXPECT_NEAR(std::hypot(w * x, v), residual_vibration(filter, f, fast_period), 1e-12);
  }
}

TEST(Vibration, WorstFrequencyOfABandEqualsADenseGrid) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Filter filter = random_filter(random, 60);
    Machine machine;
    Mode mode;
    mode.frequency_low = uniform(random, 1, 400);
    mode.frequency_high = mode.frequency_low + (i % 4 == 0 ? 0.0 : test::log_uniform(random, 0.01, 400));
    mode.residual_max = 0.05;
    machine.modes = {mode};
    const LimitUse use = vibration_utilisation(filter, fast_period, machine).at(0);
    EXPECT_EQ(use.kind, LimitKind::vibration);
    EXPECT_EQ(use.event, Event::none);
    EXPECT_GE(use.frequency, mode.frequency_low);
    EXPECT_LE(use.frequency, mode.frequency_high);
    EXPECT_NEAR(use.value, plain_response(filter, use.frequency), 1e-13);
    EXPECT_DOUBLE_EQ(use.utilisation, use.value / 0.05);
    double worst = 0.0;
    const int n = 2000;
    for (int j = 0; j <= n; ++j) {
      const double f = mode.frequency_low + (mode.frequency_high - mode.frequency_low) * j / n;
      worst = std::max(worst, residual_vibration(filter, f, fast_period));
    }
    // From above and from below: |dH/df| <= 2 pi N T, and at an inner maximum the grid is short by second order only.
    EXPECT_GE(use.value, worst - 1e-12);
    const double cell = (mode.frequency_high - mode.frequency_low) / n;
    EXPECT_LE(use.value, worst + 0.5 * cell * 2 * pi * filter.order() * fast_period + 1e-12);
  }
}

TEST(Vibration, EveryModeInOrder) {
  Machine machine;
  machine.modes = {{38, 46, 0.05}, {100, 100, 0.0}, {0.001, 0.001, 1.0}};
  const auto uses = vibration_utilisation(boxcar(9), fast_period, machine);
  ASSERT_EQ(uses.size(), 3u);
  EXPECT_DOUBLE_EQ(uses[0].frequency, 38);  // falls towards its zero at 100 Hz
  EXPECT_EQ(uses[1].bound, 0.0);
  EXPECT_NEAR(uses[1].value, 0.0, 1e-15);
  EXPECT_LE(uses[2].utilisation, 1.0);
}

TEST(Vibration, RefusesBadBands) {
  for (const Mode& bad :
       {Mode{0, 10, 0.1}, Mode{-5, 10, 0.1}, Mode{20, 10, 0.1}, Mode{1, HUGE_VAL, 0.1}, Mode{std::nan(""), 2, 1}}) {
    Machine machine;
    machine.modes = {bad};
    EXPECT_THROW(vibration_utilisation(boxcar(3), fast_period, machine), std::invalid_argument);
  }
}

// Wide bands and long filters: 1 .. 500 Hz with 401 taps holds some 200 maxima; the first side lobe of a boxcar is the
// largest above its first zero.
TEST(Vibration, FirstSideLobeOfALongBoxcar) {
  const int order = 400;
  Machine machine;
  const double zero = 1 / ((order + 1) * fast_period);
  machine.modes = {{zero, 500, 1}};
  const LimitUse use = vibration_utilisation(boxcar(order), fast_period, machine).at(0);
  // For large N the lobe is that of sin(x)/x: 0.217234 at x = 4.493409.
  EXPECT_NEAR(use.value, 0.217234, 2e-5);
  EXPECT_NEAR(use.frequency / zero, 4.493409 / pi, 1e-4);
}

// Also maxima that share an eighth of the response's shortest fast_period with a minimum.
TEST(Vibration, FindsMaximaBesideAMinimum) {
  Random random(9);
  for (int i = 0; i < 400; ++i) {
    const int order = integer(random, 2, 24);
    const Filter filter = random_filter(random, order);
    Machine machine;
    const double low = uniform(random, 5.0, 60.0), width = uniform(random, 1.0, 60.0);
    machine.modes = {{low, low + width, 0.05}};
    const LimitUse use = vibration_utilisation(filter, fast_period, machine).front();
    constexpr int points = 5000;
    double largest = 0.0;
    for (int k = 0; k <= points; ++k) largest = std::max(largest, plain_response(filter, low + width * k / points));
    // A grid of 5000 points over at most 1.5 periods of degree 24 misses less than (2 pi 24 T h)^2/8 of the square.
    EXPECT_GE(use.value, largest * (1.0 - 1e-12)) << order << " taps, " << low << " + " << width;
    EXPECT_LE(use.value, largest + 1e-5);
  }
}

// Singer and Seering's ZV shaper of a damped mode: K = exp(-pi z/sqrt(1 - z^2)), impulses 1/(1 + K) and K/(1 + K) half
// a damped period apart. Nothing is left.
TEST(DampedVibration, ZvShaperOfADampedModeLeavesNothing) {
  for (const double z : {0.02, 0.1, 0.5}) {
    const int n = 12;
    const double f = 1.0 / (2.0 * n * fast_period) / std::sqrt(1.0 - z * z);
    const double k = std::exp(-pi * z / std::sqrt(1.0 - z * z));
    std::vector<double> taps(n + 1, 0.0);
    taps.front() = 1.0 / (1.0 + k), taps.back() = k / (1.0 + k);
    EXPECT_NEAR(residual_vibration(Filter(taps), f, fast_period, z), 0.0, 1e-14);
    EXPECT_GT(residual_vibration(Filter(taps), f, fast_period), 0.5 * (1.0 - k) / (1.0 + k));
  }
}

/// Amplitude of x'' = -2 z w x' - w^2 x at its end, over that of one hit. The taps hit it; Runge-Kutta of order 4 with
/// 50 steps a sample. From position and speed, as the next peak of a damped vibration is lower than its envelope.
double integrated(const Filter& filter, double f, double z) {
  const double w = 2.0 * pi * f, damped = w * std::sqrt(1.0 - z * z), h = fast_period / 50;
  double x = 0.0, v = 0.0;
  const auto pull = [&](double at, double speed) { return -2.0 * z * w * speed - w * w * at; };
  for (int i = 0; i <= filter.order(); ++i) {
    for (int step = 0; i > 0 && step < 50; ++step) {
      const double a1 = pull(x, v), v2 = v + 0.5 * h * a1, a2 = pull(x + 0.5 * h * v, v2);
      const double v3 = v + 0.5 * h * a2, a3 = pull(x + 0.5 * h * v2, v3), v4 = v + h * a3;
      const double a4 = pull(x + h * v3, v4);
      x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    v += filter.tap(i);
  }
  return std::hypot(damped * x, v + z * w * x);
}

TEST(DampedVibration, IsTheEnvelopeOfAnIntegratedOscillator) {
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    const Filter filter = random_filter(random, 40);
    const double f = uniform(random, 5, 120), z = uniform(random, 0.0, 0.3);
    EXPECT_NEAR(residual_vibration(filter, f, fast_period, z), integrated(filter, f, z), 1e-6) << f << " Hz, " << z;
  }
}

// Free vibration falls by exp(-z w T) a sample: zero taps are time in which it does.
TEST(DampedVibration, DiesAwayInTheTimeOfZeroTaps) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const Filter filter = random_filter(random, 30);
    std::vector<double> taps(filter.taps().begin(), filter.taps().end());
    taps.resize(taps.size() + 4, 0.0);
    const double f = uniform(random, 5, 120), z = uniform(random, 0.05, 0.3);
    const double expected =
        std::exp(-z * 2.0 * pi * f * 4 * fast_period) * residual_vibration(filter, f, fast_period, z);
    EXPECT_NEAR(residual_vibration(Filter(taps), f, fast_period, z), expected, 1e-13);
  }
}

TEST(DampedVibration, TheWorstOfARectangleIsThatOfADenseGrid) {
  Random random(4);
  for (int i = 0; i < 60; ++i) {
    const Filter filter = random_filter(random, 50);
    Mode mode{uniform(random, 5, 100), 0.0, 0.05, uniform(random, 0.0, 0.1), 0.0};
    mode.frequency_high = mode.frequency_low * uniform(random, 1.0, 2.0);
    mode.damping_high = mode.damping_low + (i % 3 == 0 ? 0.0 : uniform(random, 0.0, 0.2));
    Machine machine;
    machine.modes = {mode};
    const LimitUse use = vibration_utilisation(filter, fast_period, machine).at(0);
    EXPECT_NEAR(use.value, residual_vibration(filter, use.frequency, fast_period, use.damping), 1e-12);
    double worst = 0.0;
    constexpr int n = 200;
    for (int j = 0; j <= n; ++j) {
      for (int l = 0; l <= 40; ++l) {
        const double f = mode.frequency_low + (mode.frequency_high - mode.frequency_low) * j / n;
        const double z = mode.damping_low + (mode.damping_high - mode.damping_low) * l / 40;
        worst = std::max(worst, residual_vibration(filter, f, fast_period, z));
      }
    }
    EXPECT_GE(use.value, worst - 1e-10);
    // Between grid points |dE/df| <= 2 pi N T and |dE/dz| <= 2 pi f N T; at an inner maximum it is second order.
    EXPECT_LE(use.value, worst + 0.02);
    EXPECT_GE(use.frequency, mode.frequency_low);
    EXPECT_LE(use.frequency, mode.frequency_high);
    EXPECT_GE(use.damping, mode.damping_low);
    EXPECT_LE(use.damping, mode.damping_high);
  }
}

/// Amplitude in m of the base-driven x'' = -2 z w x' - w^2 x - a behind a blend, from its velocities sample by sample.
double integrated_blend(const Filter& filter, double v1, double v2, int delay, double f, double z) {
  const double w = 2.0 * pi * f, damped = w * std::sqrt(1.0 - z * z), h = fast_period / 50;
  double x = 0.0, v = 0.0, before = v1;
  const auto pull = [&](double at, double speed) { return -2.0 * z * w * speed - w * w * at; };
  for (int k = 1; k <= filter.order() + 1 + delay; ++k) {
    for (int step = 0; step < 50; ++step) {
      const double a1 = pull(x, v), v2nd = v + 0.5 * h * a1, a2 = pull(x + 0.5 * h * v, v2nd);
      const double v3rd = v + 0.5 * h * a2, a3 = pull(x + 0.5 * h * v2nd, v3rd), v4th = v + h * a3;
      const double a4 = pull(x + h * v3rd, v4th);
      x += h / 6.0 * (v + 2.0 * v2nd + 2.0 * v3rd + v4th);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    const double now = v1 * filter.remaining(k) + v2 * filter.cumulative(k - delay);
    v -= now - before;
    before = now;
  }
  return std::hypot(x, (v + z * w * x) / damped);
}

TEST(ModesOfAxes, AmplitudeIsTheEnvelopeOfAnIntegratedOscillator) {
  Random random(8);
  for (int i = 0; i < 40; ++i) {
    const Filter filter = random_filter(random, 30);
    const double f = uniform(random, 5, 120), z = uniform(random, 0.0, 0.3), v1 = uniform(random, -0.2, 0.2),
                 v2 = uniform(random, -0.2, 0.2);
    const int delay = static_cast<int>(uniform(random, 0, 50));
    EXPECT_NEAR(residual_amplitude(filter, v1, v2, delay, f, fast_period, z),
                integrated_blend(filter, v1, v2, delay, f, z), 1e-9)
        << f << " Hz, " << z;
  }
}

TEST(ModesOfAxes, TheWorstOfARectangleIsThatOfADenseGrid) {
  Random random(9);
  for (int i = 0; i < 30; ++i) {
    const Filter filter = random_filter(random, 30);
    Mode mode{uniform(random, 5, 100), 0.0, 1.0, uniform(random, 0.0, 0.1), 0.0, 0, 1e-5};
    mode.frequency_high = mode.frequency_low * uniform(random, 1.0, 2.0);
    mode.damping_high = mode.damping_low + (i % 3 == 0 ? 0.0 : uniform(random, 0.0, 0.2));
    const double v1 = uniform(random, -0.2, 0.2), v2 = uniform(random, -0.2, 0.2);
    const int delay = static_cast<int>(uniform(random, 0, 40));
    const LimitUse use = residual_utilisation(filter, v1, v2, delay, fast_period, mode);
    double worst = 0.0;
    for (int j = 0; j <= 400; ++j) {
      for (int l = 0; l <= 20; ++l) {
        const double f = mode.frequency_low + (mode.frequency_high - mode.frequency_low) * j / 400;
        const double z = mode.damping_low + (mode.damping_high - mode.damping_low) * l / 20;
        worst = std::max(worst, residual_amplitude(filter, v1, v2, delay, f, fast_period, z));
      }
    }
    EXPECT_GE(use.value, worst * (1.0 - 1e-9));
    EXPECT_LE(use.value, worst * 1.05);
  }
}

/// The largest amplitude of a mode behind any of the changes, by a swing from sample to sample.
double swung(const std::vector<VelocityChange>& changes, double period, double f, double z) {
  const double w = 2.0 * std::numbers::pi * f, damped = w * std::sqrt(1.0 - z * z), fall = std::exp(-z * w * period);
  const double c = fall * std::cos(damped * period), s = fall * std::sin(damped * period);
  double x = 0.0, y = 0.0, most = 0.0;
  std::int64_t sample = 0;
  for (const VelocityChange& change : changes) {
    for (; sample < change.sample; ++sample) {
      const double before = x;
      x = c * x - s * y, y = s * before + c * y;
    }
    x += change.by;
    most = std::max(most, std::hypot(x, y) / damped);
  }
  return most;
}

// 2000 moves that overlap, 20 s: what a mode has forgotten does not count, and what is found is the worst.
TEST(ModesOfAxes, ManyChangesTogetherAreThoseOfASwing) {
  Random random(11);
  constexpr double period = 1e-3;
  for (const auto& [low, high] : {std::pair{0.0, 0.0}, std::pair{0.02, 0.02}, std::pair{0.01, 0.08}}) {
    std::vector<VelocityChange> changes;
    for (std::int64_t at = 0; at < 20'000; at += static_cast<std::int64_t>(uniform(random, 1, 20)))
      changes.push_back({at, uniform(random, -0.01, 0.01), true});
    const Filter none({1.0});
    const Mode mode{38.0, 40.0, 1.0, low, high, 0, 1e-5};
    const LimitUse use = residual_utilisation(none, changes, period, mode);
    EXPECT_NEAR(use.value, swung(changes, period, use.frequency, use.damping), 1e-9 * use.value);
    for (int i = 0; i < 300; ++i) {
      const double f = uniform(random, 38.0, 40.0), z = uniform(random, low, high);
      EXPECT_LE(swung(changes, period, f, z), use.value * (1.0 + 1e-9)) << f << " Hz, " << z;
    }
  }
}

TEST(DampedVibration, RefusesDampingOutOfRange) {
  for (const Mode& bad : {Mode{10, 10, 0.1, -0.1, 0.1}, Mode{10, 10, 0.1, 0.2, 0.1}, Mode{10, 10, 0.1, 0.0, 1.0}}) {
    Machine machine;
    machine.modes = {bad};
    EXPECT_THROW(vibration_utilisation(boxcar(3), fast_period, machine), std::invalid_argument);
  }
}

}  // namespace
}  // namespace accdec
