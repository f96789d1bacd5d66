#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design/find_modes.hpp>

// Logs of oscillators with known frequency and damping, integrated exactly from sample to sample, with noise.

namespace accdec {
namespace {

struct Known {
  double frequency, damping, gain;
};

enum class Push { jolts, sweep, noise };

constexpr double log_period = 1.0 / 3200.0;  // s, of the accelerometers that printers have

/// Accelerations of oscillators on a common base. @param noise  of the accelerometer, part of the root mean square
std::vector<double> logged(const std::vector<Known>& known, Push excitation, double seconds, double noise,
                           unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto count = static_cast<std::size_t>(seconds / log_period);
  std::vector<double> push(count, 0.0), sum(count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) * log_period, rate = 130.0 / seconds;
    if (excitation == Push::jolts && k % 3200 == 100) push[k] = 1.0;
    if (excitation == Push::noise) push[k] = normal(engine);
    // From 5 to 135 Hz; the amplitude rises with the frequency, as in the test of printers.
    if (excitation == Push::sweep)
      push[k] = (5.0 + rate * t) * std::sin(2.0 * std::numbers::pi * (5.0 * t + 0.5 * rate * t * t));
  }
  for (const Known& mode : known) {
    const double w = 2.0 * std::numbers::pi * mode.frequency, damped = w * std::sqrt(1.0 - mode.damping * mode.damping);
    const double fall = std::exp(-mode.damping * w * log_period);
    const double c = fall * std::cos(damped * log_period), s = fall * std::sin(damped * log_period);
    double x = 0.0, v = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      v += mode.gain * push[k];
      sum[k] += -2.0 * mode.damping * w * v - w * w * x;
      const double quarter = (v + mode.damping * w * x) / damped, next = c * x + s * quarter;
      v = (c * quarter - s * x) * damped - mode.damping * w * next;
      x = next;
    }
  }
  double square = 0.0;
  for (const double a : sum) square += a * a;
  const double rms = std::sqrt(square / static_cast<double>(count));
  for (double& a : sum) a += noise * rms * normal(engine);
  return sum;
}

void expect_found(const std::vector<Known>& known, Push excitation, double seconds, unsigned seed) {
  const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {logged(known, excitation, seconds, 0.1, seed)}});
  ASSERT_EQ(found.size(), known.size());
  for (const Known& mode : known) {
    const auto close = [&](const FoundMode& f) { return std::abs(f.frequency / mode.frequency - 1.0) <= 0.01; };
    const auto match = std::find_if(found.begin(), found.end(), close);
    ASSERT_NE(match, found.end()) << mode.frequency << " Hz";
    EXPECT_NEAR(match->damping, mode.damping, 0.2 * mode.damping) << mode.frequency << " Hz";
    EXPECT_LE(match->damping_low, match->damping);
    EXPECT_GE(match->damping_high, match->damping);
  }
}

TEST(FindModes, OfVibrationsThatDieAway) {
  for (const double damping : {0.02, 0.05, 0.1})
    expect_found({{42.0, damping, 1.0}, {97.0, 1.5 * damping, 0.8}}, Push::jolts, 20.0, 1);
}

TEST(FindModes, OfASweep) {
  for (const double damping : {0.02, 0.05, 0.1})
    expect_found({{42.0, damping, 1.0}, {97.0, 1.5 * damping, 0.8}}, Push::sweep, 30.0, 2);
  const std::vector<double> signal = logged({{42.0, 0.05, 1.0}}, Push::sweep, 30.0, 0.05, 33);
  const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {signal}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].certain()) << found[0].doubt;
  EXPECT_EQ(found[0].excitation, Excitation::sweep);
  EXPECT_NEAR(found[0].sweep.rate, 130.0 / 30.0, 0.01 * 130.0 / 30.0);
}

/// A mode that rings on for long is louder than the sweep behind it for many pieces of the log.
TEST(FindModes, OfASweepPastAModeThatRingsOn) {
  const Known mode{13.5, 0.005, 1.0};
  const auto found = find_modes({log_period, {"x"}, {logged({mode}, Push::sweep, 9.0, 0.02, 3)}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].excitation, Excitation::sweep);
  EXPECT_NEAR(found[0].frequency, mode.frequency, 0.01 * mode.frequency);
  EXPECT_NEAR(found[0].damping, mode.damping, 0.2 * mode.damping);
}

// Noise shows damping to about a part of 1/sqrt(2 pi f z t) only: a log of two minutes to 5 %.
TEST(FindModes, OfNoise) {
  expect_found({{42.0, 0.03, 1.0}}, Push::noise, 120.0, 3);
  expect_found({{42.0, 0.05, 1.0}}, Push::noise, 120.0, 4);
}

// Noise shows the damping to 1/sqrt(2 pi f z t) of it (standard error). This is 9.7 % in 20 s, and 2.6 of these are
// more than 20 %.
TEST(FindModes, SaysWhatAShortLogOfNoiseDoesNotShow) {
  for (const auto& [seconds, certain] : {std::pair{20.0, false}, std::pair{150.0, true}}) {
    const std::vector<double> signal = logged({{42.0, 0.02, 1.0}}, Push::noise, seconds, 0.05, 21);
    const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {signal}});
    ASSERT_FALSE(found.empty());
    const double expected = 1.0 / std::sqrt(2.0 * std::numbers::pi * 42.0 * 0.02 * seconds);
    EXPECT_NEAR(found[0].damping_error, expected, 0.35 * expected);
    EXPECT_EQ(found[0].certain(), certain) << found[0].doubt;
    EXPECT_EQ(found[0].jolts, 0);
  }
}

// Noise alone has no mode.
TEST(FindModes, NoneInWhiteNoise) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<double> noise(64'000);
  for (double& a : noise) a = normal(engine);
  EXPECT_TRUE(find_modes({log_period, {"x"}, {noise}}).empty());
}

/// Jolts at these times, s, each of which lets 42 Hz ring, with noise of 2 %.
std::vector<double> ringing(const std::vector<double>& starts, double z, std::size_t samples, std::mt19937& engine) {
  std::normal_distribution<double> normal(0.0, 1.0);
  const double w = 2.0 * std::numbers::pi * 42.0, damped = w * std::sqrt(1.0 - z * z);
  std::vector<double> signal(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    signal[k] = 0.02 * normal(engine);
    for (const double start : starts) {
      const double t = static_cast<double>(k) * log_period - start;
      if (t > 0.0) signal[k] += std::exp(-z * w * t) * std::sin(damped * t);
    }
  }
  return signal;
}

// One jolt alone, and jolts that begin before the last ringing ends: the stretches between them are fitted.
TEST(FindModes, OfOneJoltAndOfJoltsThatOverlap) {
  std::mt19937 engine(13);
  for (const std::vector<double>& starts : {std::vector<double>{0.5}, std::vector<double>{0.5, 0.57, 1.1, 1.8, 1.9}}) {
    for (const double z : {0.05, 0.15}) {
      const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {ringing(starts, z, 12'800, engine)}});
      ASSERT_EQ(found.size(), 1U);
      EXPECT_NEAR(found[0].frequency, 42.0, 0.42);
      EXPECT_NEAR(found[0].damping, z, 0.2 * z);
      EXPECT_GT(found[0].jolts, 0);
    }
  }
}

// A second jolt within a period of the first leaves no stretch between them. Nothing there looks like a mode.
TEST(FindModes, InventsNoneWhereJoltsAreCloserThanAPeriod) {
  std::mt19937 engine(31);
  int seen = 0;
  constexpr int logs = 20;
  for (int log = 0; log < logs; ++log) {
    const double apart = std::uniform_real_distribution<double>(0.1, 1.5)(engine) / 42.0;
    const std::vector<double> signal = ringing({0.5, 0.5 + apart, 1.9}, 0.04, 12'800, engine);
    for (const FoundMode& f : find_modes({log_period, {"x"}, {signal}})) {
      if (!f.certain()) continue;
      EXPECT_NEAR(f.frequency, 42.0, 0.42) << apart * 42.0 << " periods";
      EXPECT_NEAR(f.damping, 0.04, 0.2 * 0.04) << apart * 42.0 << " periods";
      ++seen;
    }
  }
  EXPECT_GE(seen, 19);
}

// Modes of which one is not told from the other are never shown as one without a remark.
TEST(FindModes, TwoCloseTogetherAreNotOneWithoutARemark) {
  for (const double apart : {1.005, 1.01, 1.02, 1.04}) {
    const std::vector<double> signal =
        logged({{45.0, 0.03, 1.0}, {45.0 * apart, 0.03, 0.8}}, Push::jolts, 10.0, 0.05, 32);
    const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {signal}});
    ASSERT_FALSE(found.empty());
    if (found.size() > 1) continue;
    // One that is within what is promised of both may stand for both.
    if (!found[0].certain()) continue;
    for (const double f : {45.0, 45.0 * apart}) EXPECT_NEAR(found[0].frequency, f, promised_frequency * f) << apart;
  }
}

// Jolts every quarter of a second, before each of which the last ringing has a quarter of its amplitude.
TEST(FindModes, OfManyJoltsThatOverlap) {
  std::mt19937 engine(22);
  const double z = 0.02;
  std::vector<double> starts;
  for (int jolt = 0; jolt < 36; ++jolt) starts.push_back(0.5 + 0.25 * jolt + 0.02 * std::sin(7.0 * jolt));
  const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {ringing(starts, z, 32'000, engine)}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].frequency, 42.0, 0.42);
  EXPECT_NEAR(found[0].damping, z, 0.2 * z);
  EXPECT_GT(found[0].overlaps, 10);
  EXPECT_TRUE(found[0].certain());
}

// The errors of 30 logs of one jolt, over the standard errors: their mean square is 1, within a third at 30.
TEST(FindModes, StandardErrorsAreThoseOfManyLogs) {
  double frequency = 0.0, damping = 0.0;
  constexpr int logs = 30;
  for (int log = 0; log < logs; ++log) {
    std::mt19937 engine(300U + static_cast<unsigned>(log));
    std::normal_distribution<double> normal(0.0, 1.0);
    const double z = 0.04, w = 2.0 * std::numbers::pi * 42.0, damped = w * std::sqrt(1.0 - z * z);
    std::vector<double> signal(9600);
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double t = static_cast<double>(k) * log_period - 0.7;
      signal[k] = 0.1 * normal(engine) + (t > 0.0 ? std::exp(-z * w * t) * std::sin(damped * t) : 0.0);
    }
    const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {signal}});
    ASSERT_EQ(found.size(), 1U) << log;
    frequency += std::pow((found[0].frequency / 42.0 - 1.0) / found[0].frequency_error, 2);
    damping += std::pow((found[0].damping / z - 1.0) / found[0].damping_error, 2);
  }
  for (const double sum : {frequency, damping}) {
    EXPECT_GT(sum, 0.4 * logs);
    EXPECT_LT(sum, 1.8 * logs);
  }
}

// Twelve logs of all kinds: a mode without doubt is within 1 % and 20 %, and is found.
TEST(FindModes, HoldsWhatItPromisesInLogsOfAllKinds) {
  std::mt19937 engine(23);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  int known = 0, seen = 0;
  for (int log = 0; log < 12; ++log) {
    const Push excitation = std::array{Push::jolts, Push::noise, Push::sweep}[log % 3];
    std::vector<Known> modes{{uniform(25.0, 45.0), uniform(0.02, 0.07), 1.0}};
    if (log % 2 == 1) modes.push_back({uniform(1.4, 1.8) * modes[0].frequency, uniform(0.02, 0.07), 0.8});
    const double seconds = excitation == Push::noise ? 120.0 : 20.0;
    const std::vector<double> signal = logged(modes, excitation, seconds, 0.05, 400U + static_cast<unsigned>(log));
    for (const FoundMode& f : find_modes({log_period, {"x"}, {signal}})) {
      if (!f.certain()) continue;
      const auto real = std::ranges::find_if(
          modes, [&](const Known& m) { return std::abs(f.frequency / m.frequency - 1.0) <= promised_frequency; });
      ASSERT_NE(real, modes.end()) << "log " << log << ": " << f.frequency << " Hz";
      EXPECT_NEAR(f.damping, real->damping, promised_damping * real->damping) << "log " << log;
      ++seen;
    }
    known += static_cast<int>(modes.size());
  }
  EXPECT_GE(seen, known - 2);
}

// The weaker one has 0.4 of the other's velocity, and 4 % of the energy of the lags.
TEST(FindModes, AWeakerOneBesideAStrong) {
  expect_found({{42.0, 0.04, 1.0}, {90.0, 0.04, 0.4}}, Push::jolts, 20.0, 9);
  expect_found({{42.0, 0.05, 1.0}, {90.0, 0.08, 0.3}}, Push::jolts, 20.0, 10);
}

TEST(FindModes, TellsApartWhatDiffersByATwelfth) {
  for (const double damping : {0.02, 0.04})
    expect_found({{45.0, damping, 1.0}, {1.08 * 45.0, damping, 0.7}}, Push::jolts, 20.0, 11);
}

// Whatever is found is there, and few of the 48 modes are too weak to be found.
TEST(FindModes, InventsNoneInRandomLogs) {
  std::mt19937 engine(12);
  const auto uniform = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0.0, 1.0)(engine));
  };
  int known = 0, seen = 0;
  for (int log = 0; log < 24; ++log) {
    std::vector<Known> modes;
    for (double f = uniform(15.0, 25.0); static_cast<int>(modes.size()) <= log % 3; f *= uniform(1.35, 2.0))
      modes.push_back({f, uniform(0.01, 0.1), uniform(0.3, 1.0)});
    const std::vector<double> signal = logged(modes, Push::jolts, 20.0, 0.1, 100U + static_cast<unsigned>(log));
    const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {signal}});
    for (const FoundMode& f : found) {
      const auto real = std::ranges::find_if(
          modes, [&](const Known& m) { return std::abs(f.frequency / m.frequency - 1.0) <= 0.01; });
      ASSERT_NE(real, modes.end()) << "log " << log << ": " << f.frequency << " Hz";
      EXPECT_NEAR(f.damping, real->damping, 0.2 * real->damping) << "log " << log << ": " << f.frequency << " Hz";
    }
    known += static_cast<int>(modes.size()), seen += static_cast<int>(found.size());
  }
  EXPECT_GE(seen, known * 9 / 10);
}

// A machine whose frequency depends on its place: a log in two halves.
TEST(FindModes, SaysByHowMuchTheFrequencyChanges) {
  std::vector<double> first = logged({{40.0, 0.04, 1.0}}, Push::jolts, 10.0, 0.05, 6);
  const std::vector<double> second = logged({{44.0, 0.04, 1.0}}, Push::jolts, 10.0, 0.05, 7);
  first.insert(first.end(), second.begin(), second.end());
  const std::vector<FoundMode> found = find_modes({log_period, {"x"}, {first}});
  ASSERT_FALSE(found.empty());
  EXPECT_LE(found[0].frequency * (1.0 - found[0].spread), 40.0 * 1.01);
  EXPECT_GE(found[0].frequency * (1.0 + found[0].spread), 44.0 * 0.99);
}

// The autocorrelation of a vibration exp(-a t) cos(w t) falls and turns in the same way.
TEST(PowerSpectrum, EnergyIsThatOfTheSignal) {
  const std::vector<double> signal = logged({{50.0, 0.1, 1.0}}, Push::jolts, 1.0, 0.0, 8);
  double mean = 0.0, energy = 0.0;
  for (const double a : signal) mean += a / static_cast<double>(signal.size());
  for (const double a : signal) energy += (a - mean) * (a - mean);
  const PowerSpectrum spectrum = power_spectrum(signal, log_period);
  double sum = 0.0;
  for (const double p : spectrum.power) sum += p;
  // Parseval, both signs of the frequency.
  EXPECT_NEAR(2.0 * sum / (2.0 * static_cast<double>(spectrum.power.size())), energy, 1e-3 * energy);
}

/// A mode that noise shakes rises and falls as if it were jolted. Between such jolts nothing is sure.
TEST(FindModes, NoiseIsNotManyJolts) {
  const std::vector<Known> known{{37.6, 0.058, 1.0}};
  for (unsigned seed = 1; seed < 5; ++seed) {
    for (const FoundMode& mode : find_modes({log_period, {"x"}, {logged(known, Push::noise, 28.0, 0.02, seed)}}))
      EXPECT_EQ(mode.excitation, Excitation::noise) << seed;
  }
}

/// Gravity of 9800 mm/s^2, as interpolation rounds it.
TEST(FindModes, InventsNoneInRounding) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> digits(-2, 2);
  std::vector<double> still(64000);
  for (double& value : still) value = 9.8 * (1.0 + digits(random) * std::numeric_limits<double>::epsilon());
  EXPECT_THAT(find_modes({log_period, {"z"}, {still}}), ::testing::IsEmpty());
}

TEST(FindModes, RefusesWhatIsTooShort) {
  const std::vector<double> second(3200, 0.0);
  EXPECT_THROW(find_modes({log_period, {"x"}, {second}}), std::invalid_argument);
  EXPECT_THROW(find_modes({0.01, {"x"}, {second}}, {.frequency_min = 20.0}), std::invalid_argument);
  const auto refused = [&](double period, const FindModesOptions& options) -> std::string {
    try {
      find_modes({period, {"x"}, {second}}, options);
    } catch (const std::invalid_argument& reason) {
      return reason.what();
    }
    return "";
  };
  EXPECT_THAT(refused(log_period, {.frequency_min = 90.0, .frequency_max = 40.0}),
              ::testing::HasSubstr("from 90 to 40 Hz is reversed"));
  // 32 kHz in a column of ms without a unit.
  EXPECT_THAT(refused(0.03125, {}), ::testing::HasSubstr("A column t counts seconds"));
}

}  // namespace
}  // namespace accdec
