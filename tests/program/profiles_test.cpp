#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/plan/trajectory/last_filter.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plan/trajectory/profile_corner.hpp>
#include <accdec/simulate/profile_motion.hpp>

#include "reference.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

using test::machine_of;
using test::path_of;
using test::random_program;

/// All samples of a plan, the start included: rows of as many values as the path has axes.
std::vector<std::vector<double>> samples_of(const Toolpath& path, const ProfilePlan& plan, double period) {
  std::vector<std::vector<double>> rows{{path.point(0), path.point(0) + path.dimensions()}};
  ProfileMotion motion(path, plan.chain, period, plan.last);
  while (motion.next()) rows.emplace_back(motion.position(), motion.position() + path.dimensions());
  return rows;
}

/// Measures a motion of rows of positions by brute force. It takes differences in long double of the whole sequence, at
/// rest at both ends. It takes the distance of every joint from every segment of the motion, in the order of the
/// program.
struct Brute {
  explicit Brute(std::vector<std::vector<double>> rows, const Toolpath& path, const Machine& m, double period)
      : rows_(std::move(rows)) {
    const std::size_t n = path.dimensions();
    rows_.insert(rows_.begin(), 3, rows_.front());
    rows_.insert(rows_.end(), 3, rows_.back());
    const long double T = period;
    for (std::size_t k = 3; k < rows_.size(); ++k) {
      for (std::size_t a = 0; a < n; ++a) {
        const auto x = [&](std::size_t back) { return static_cast<long double>(rows_[k - back][a]); };
        const long double v = (x(0) - x(1)) / T, acc = (x(0) - 2 * x(1) + x(2)) / (T * T);
        const long double jerk = (x(0) - 3 * x(1) + 3 * x(2) - x(3)) / (T * T * T);
        const Axis& axis = m.axes[a];
        const long double force = axis.mass * acc + axis.damping * v;
        const auto use = [&](long double value, double bound) {
          worst = std::max(worst, static_cast<double>(value / bound));
        };
        use(std::abs(v), axis.velocity_max);
        use(std::abs(acc), axis.acceleration_max);
        use(std::abs(jerk), axis.jerk_max);
        use(std::abs(force), axis.force_max);
        use(force * v, axis.power_max);
        use(-force * v, axis.regeneration_max);
      }
    }
  }

  double distance(std::size_t segment, const double* p) const {
    const auto &a = rows_[segment], &b = rows_[segment + 1];
    double dot = 0.0, length2 = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      dot += (p[i] - a[i]) * (b[i] - a[i]);
      length2 += (b[i] - a[i]) * (b[i] - a[i]);
    }
    const double t = length2 > 0.0 ? std::clamp(dot / length2, 0.0, 1.0) : 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] + t * (b[i] - a[i]) - p[i], 2);
    return std::sqrt(sum);
  }

  /// Whether the motion passes every joint within its tolerance plus `more`, one after the other: each as early as it
  /// can.
  bool passes(const Toolpath& path, double more) const {
    std::size_t at = 0;
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      const double tolerance = path.joint[b] == Joint::stop ? 0.0 : path.tolerance[b];
      while (at + 1 < rows_.size() && distance(at, path.point(b + 1)) > tolerance * (1.0 + 1e-9) + more) ++at;
      if (at + 1 == rows_.size()) return false;
    }
    return true;
  }

  std::vector<std::vector<double>> rows_;
  double worst = 0.0;
};

TEST(ProfileCorner, IsAParabolaOfTheSpeedThatItsToleranceAllows) {
  // u1 along x, u2 turned by the angle: v = sqrt(8 a e/(m n)), n = |u2 - u1|, m its largest component.
  const double a = 1.0, e = 5e-5, period = 1e-6;
  const Machine m = machine_of(a, unlimited, 0.2, 2);
  const AvailableAcceleration available(m, period, LastFilter(1, period));
  for (const double turn : {5.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0}) {
    const double in[] = {1.0, 0.0},
                 out[] = {std::cos(turn * std::numbers::pi / 180.0), std::sin(turn * std::numbers::pi / 180.0)};
    ProfileLegs legs;
    legs.in = in;
    legs.out = out;
    legs.ramp_in = legs.ramp_out = a;
    legs.feed = 10.0;
    legs.room = 1.0;
    legs.tolerance = e;
    const CornerPass pass = corner_pass(available, 2, legs);
    const double n = std::hypot(out[0] - in[0], out[1] - in[1]),
                 largest = std::max(std::abs(out[0] - in[0]), std::abs(out[1] - in[1]));
    // 1e-6: the sagitta a T^2/8 that the tolerance is lowered by is 1e-9 of it, the margin of the acceleration as
    // small.
    EXPECT_NEAR(pass.speed_max, std::sqrt(8.0 * a * e / (largest * n)), 1e-6 * pass.speed_max) << turn;
    EXPECT_NEAR(pass.stretch, largest / a, 1e-8 * largest) << turn;
  }
}

/// Distance of the corner from the mean, over a window, of a corner passed at v with a boxcar of tau and ramps of
/// `ramp` beyond `coast`: by summing.
double distance_by_sums(double n, double v, double tau, double window, double ramp, double coast) {
  // In the direction of u2 - u1: half of n v |t| without the boxcar of the corner, whose mean is taken first; the ramps
  // add n ramp t'^2/4.
  constexpr int count = 2000;
  double sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const double t = window * ((i + 0.5) / count - 0.5);
    double inner = 0.0;
    if (std::abs(t) >= 0.5 * tau) {
      inner = 0.5 * n * v * std::abs(t);
      const double beyond = std::abs(t) - 0.5 * tau - coast;
      if (beyond > 0.0) inner += 0.25 * n * ramp * beyond * beyond;
    } else {
      for (int j = 0; j < 400; ++j) inner += 0.5 * n * v * std::abs(t + tau * ((j + 0.5) / 400 - 0.5)) / 400;
    }
    sum += inner / count;
  }
  return sum;
}

TEST(ProfileCorner, DistanceThroughBothBoxcarsIsTheirMean) {
  const double n = 1.3, v = 0.03, ramp = 0.8;
  for (const double tau : {0.004, 0.02, 0.05}) {
    for (const double window : {0.01, 0.02, 0.06}) {
      for (const double coast : {0.0, 0.004, 0.1}) {
        const double expected = distance_by_sums(n, v, tau, window, ramp, coast);
        const LastFilter boxcar(100, window / 100);
        EXPECT_NEAR(corner_distance(n, v, tau, boxcar, ramp, coast), expected, 2e-5 * expected)
            << tau << " " << window << " " << coast;
      }
    }
  }
  EXPECT_DOUBLE_EQ(corner_distance(n, v, 0.02, LastFilter(1, 1e-3), ramp, 0.0), n * v * 0.02 / 8.0);
}

TEST(Profiles, OneLegTakesTheTimeOfItsRamps) {
  const double period = 1e-3, a = 1.0, v = 0.1;
  for (const double length : {0.003, 0.01, 0.05, 0.1234}) {
    const Toolpath path = path_of(fmt::format("G64 P0.05 F{}\nG1 X{}\nM2\n", v * 60e3, length * 1e3));
    const double expected = length >= v * v / a ? length / v + v / a : 2.0 * std::sqrt(length / a);
    const ProfilePlan plan = plan_profiles(path, machine_of(a, unlimited, 0.2, 1), period);
    EXPECT_TRUE(plan.holds());
    EXPECT_NEAR(chain_time(plan.chain), expected, 1e-8);
    // One sample more until the velocity is 0, and the end rounded up to a sample.
    EXPECT_GE(static_cast<double>(plan.check.samples) * period, expected + period - 1e-7);
    EXPECT_LT(static_cast<double>(plan.check.samples) * period, expected + 2.0 * period);
  }
}

TEST(Profiles, OneLegWithAJerkLimitTakesTheTimeOfAnSCurve) {
  const double period = 1e-3, a = 1.0, j = 50.0, v = 0.1, length = 0.05;
  const Toolpath path = path_of(fmt::format("G64 P0.05 F{}\nG1 X{}\nM2\n", v * 60e3, length * 1e3));
  const ProfilePlan plan = plan_profiles(path, machine_of(a, j, 0.2, 1), period);
  EXPECT_TRUE(plan.holds());
  // L/v + v/a + a/j = 0.5 + 0.1 + 0.02; a boxcar of 20 taps lengthens by 19 samples, one more until the velocity is 0,
  // one of rounding.
  EXPECT_NEAR(static_cast<double>(plan.check.samples) * period, 0.62, 1.01 * period);
}

TEST(Profiles, RightAnglesOfLongLegsLoseWhatTheParabolaLoses) {
  // Corner of 90 degrees along the axes, a = 1 m/s^2, F = 100 mm/s, e = 0.05 mm: v_c^2 = 8 a e/sqrt(2). Beside passing
  // it at F the ramps lose (F - v_c)^2/(a F) and the corner itself (1 - v_c/F) v_c/a.
  const double a = 1.0, F = 0.1, e = 5e-5, v = std::sqrt(8.0 * a * e / std::numbers::sqrt2);
  const Toolpath path = path_of("G64 P0.05 F6000\nG1 X50\nG1 Y50\nM2\n");
  const ProfilePlan plan = plan_profiles(path, machine_of(a, unlimited, 0.2, 2), 1e-3);
  const double expected = 1.0 + F / a + (F - v) * (F - v) / (a * F) + (1.0 - v / F) * v / a;
  EXPECT_TRUE(plan.holds());
  EXPECT_NEAR(chain_time(plan.chain), expected, 1e-4);  // the sagitta of a sample takes 0.35 % of the tolerance
  EXPECT_NEAR(plan.errors[0], e, 0.01 * e);
  EXPECT_LE(plan.errors[0], e);
}

TEST(Profiles, CirclesGoAsFastAsTheAxesAllow) {
  // One axis has the whole centripetal acceleration v^2/R where the circle of radius R crosses an axis direction: v is
  // at most sqrt(a R) there. On the diagonals both axes share it: v is at most 2^(1/4) of that. So a turn takes between
  // 2^(-1/4) and 1 of 2 pi R/sqrt(a R), plus start and stop.
  const double a = 1.0, R = 4e-3, turns = 10.0, slow = 2.0 * std::numbers::pi * std::sqrt(R / a);
  std::string text = "G64 P0.02 F60000\nG0 X4\n";
  for (int i = 0; i < turns; ++i) text += "G3 X4 Y0 I-4 J0\n";
  const Machine m = machine_of(a, unlimited, 1.0, 2);
  const Toolpath path = path_of(text + "M2\n", m);
  const ProfilePlan plan = plan_profiles(path, m, 1e-3);
  EXPECT_TRUE(plan.holds());
  EXPECT_EQ(plan.rounds, 0);
  const double approach = 2.0 * std::sqrt(R / a), time = chain_time(plan.chain);
  EXPECT_GT(time, turns * slow * std::pow(2.0, -0.25));
  // A hundredth for what chords cost, and starting and stopping on the circle.
  EXPECT_LT(time, 1.01 * turns * slow + 2.0 * approach);
}

TEST(Profiles, StopsAndDwellsAreKept) {
  const Toolpath path = path_of("G64 P0.05 F6000\nG1 X10\nG4 P0.25\nG1 X20\nG61.1\nG1 Y10\nG64 P0.05\nG1 X30\nM2\n");
  for (const double jerk : {unlimited, 50.0}) {
    const Machine m = machine_of(1.0, jerk, 0.2, 2);
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    ASSERT_TRUE(plan.holds());
    const auto rows = samples_of(path, plan, 1e-3);
    int resting = 0;
    for (std::size_t k = 1; k < rows.size(); ++k)
      resting += rows[k] == rows[k - 1] && std::abs(rows[k][0] - 0.01) < 1e-12 && rows[k][1] == 0.0;
    EXPECT_GE(resting, 250);
    EXPECT_LE(resting, 260);
    EXPECT_TRUE(Brute(rows, path, m, 1e-3).passes(path, 1e-9));
  }
}

TEST(Profiles, ShortBlocksAreLookedAheadOver) {
  // One line in blocks of any length, feeds alike, takes the time of the line.
  std::string text = "G91 G64 P0.05 F6000\n";
  std::mt19937 random(7);
  double length = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double step = std::exp(std::uniform_real_distribution<double>(-6.0, 1.0)(random));
    text += fmt::format("G1 X{:.9f}\n", step);
    length += step * 1e-3;
  }
  const ProfilePlan plan = plan_profiles(path_of(text + "M2\n"), machine_of(1.0, unlimited, 0.2, 1), 1e-3);
  EXPECT_TRUE(plan.holds());
  EXPECT_NEAR(chain_time(plan.chain), length / 0.1 + 0.1, 1e-7);
}

TEST(Profiles, LinuxCncsZigZagIsFasterThanLinuxCnc) {
  // LinuxCNC's times, problems/program/linuxcnc/README.md.
  const std::pair<const char*, double> measured[] = {
      {"p0.01", 19.036}, {"p0.05", 18.699}, {"p0.1", 18.410}, {"p0.5", 16.847}};
  const Machine m = machine_of(1.0, unlimited, 0.2, 2);
  for (const auto& [name, time] : measured) {
    LineSource source{std::filesystem::path(
        fmt::format("{}/problems/program/linuxcnc/zigzag-{}.ngc", test_support::source_folder(), name))};
    const Toolpath path = read_toolpath(source, m, {});
    const ProfilePlan plan = plan_profiles(path, m, 1e-3);
    EXPECT_TRUE(plan.holds());
    EXPECT_LT(static_cast<double>(plan.check.samples) * 1e-3, 0.985 * time) << name;
    EXPECT_LE(Brute(samples_of(path, plan, 1e-3), path, m, 1e-3).worst, 1.0 + 1e-9);
  }
}

TEST(ProfileCorner, DistanceThroughAnyLastFilterIsItsMean) {
  // Over the taps themselves: each a corner passed so much earlier or later.
  const double n = 1.3, v = 0.03, ramp = 0.8, period = 1e-3;
  const Filter taps({0.3, 0.1, 0.0, 0.2, 0.4, 0.9, 0.4, 0.1, 0.0, 0.0, 0.5});
  const LastFilter last(taps, period);
  for (const double tau : {0.0, 0.0007, 0.002, 0.006, 0.011, 0.05}) {
    for (const double coast : {0.0, 0.001, 0.02}) {
      double sum = 0.0, before = 0.0, after = 0.0;
      for (int i = 0; i <= taps.order(); ++i) {
        const double t = (i - taps.mean_delay()) * period, half = 0.5 * tau;
        double inner = std::abs(t) >= half ? std::abs(t) : 0.0;
        for (int j = 0; j < 2000 && std::abs(t) < half; ++j)
          inner += std::abs(t + tau * ((j + 0.5) / 2000 - 0.5)) / 2000;
        sum += 0.5 * n * v * taps.tap(i) * inner;
        const double beyond = std::abs(t) - half - coast;
        if (beyond > 0.0) (t > 0.0 ? after : before) += 0.5 * n * ramp * taps.tap(i) * beyond * beyond;
      }
      const double exact = sum + std::max(before, after);
      const double planned = corner_distance(n, v, tau, last, ramp, coast);
      EXPECT_GE(planned, exact * (1.0 - 1e-6));  // the table's chords are above
      EXPECT_LE(planned, exact * 1.002);
    }
  }
}

TEST(LastFilters, HoldTheBoundsByTheirDefinition) {
  Machine m = machine_of(1.0, unlimited, 0.2, 2);
  m.modes = {{40.0, 60.0, 0.1}, {110.0, 120.0, 0.05}};
  const double period = 1e-3;
  const std::vector<Filter> filters = last_filters(m, period);
  ASSERT_FALSE(filters.empty());
  EXPECT_TRUE(last_filters(m, period, unlimited, 24, Deadline(-1.0)).empty());
  for (const Filter& filter : filters) {
    for (const Mode& mode : m.modes) {
      for (int i = 0; i <= 400; ++i) {
        const double f = mode.frequency_low + (mode.frequency_high - mode.frequency_low) * i / 400;
        std::complex<double> sum = 0.0;
        for (int k = 0; k <= filter.order(); ++k) {
          sum += filter.tap(k) * std::polar(1.0, -2.0 * std::numbers::pi * f * k * period);
        }
        EXPECT_LE(std::abs(sum), mode.residual_max * (1.0 + 1e-9)) << f;
      }
    }
  }
}

TEST(Profiles, NoProgramExcitesAModeMoreThanItsBoundAllows) {
  // The whole motion's acceleration, transformed at each frequency, against that of the command before the last filter.
  const double period = 1e-3;
  for (const double jerk : {unlimited, 50.0}) {
    Machine m = machine_of(1.0, jerk, 0.2, 2);
    m.modes = {{40.0, 60.0, 0.1}};
    const Toolpath path =
        path_of("G64 P0.05 F6000\nG1 X20\nG1 Y20\nG1 X22 Y22\nG3 X12 Y32 I-10\nG1 X0 Y0\nG1 X1\nM2\n", m);
    const ProfilePlan plan = plan_profiles(path, m, period);
    ASSERT_TRUE(plan.holds());
    const auto rows = samples_of(path, plan, period);
    const Brute brute(rows, path, m, period);
    EXPECT_LE(brute.worst, 1.0 + 1e-8);
    EXPECT_TRUE(brute.passes(path, 1e-9));
    ProfilePlan command = plan;
    command.last = Filter({1.0});
    const auto raw = samples_of(path, command, period);
    const auto excited = [&](const std::vector<std::vector<double>>& motion, std::size_t axis, double f) {
      std::complex<double> sum = 0.0;
      for (std::size_t k = 1; k < motion.size(); ++k) {
        sum += (motion[k][axis] - motion[k - 1][axis]) *
               std::polar(1.0, -2.0 * std::numbers::pi * f * static_cast<double>(k) * period);
      }
      return std::abs(sum);
    };
    for (const double f : {40.0, 44.0, 50.0, 57.0, 60.0}) {
      for (const std::size_t axis : {0U, 1U}) {
        EXPECT_LE(excited(rows, axis, f), 0.1 * excited(raw, axis, f) * (1.0 + 1e-6) + 1e-12) << f;
      }
    }
  }
}

TEST(Profiles, VibrationBoundsThatNoShortFilterHoldsAreRefused) {
  Machine m = machine_of(1.0, unlimited, 0.2, 3);
  m.modes.push_back({1.0, 499.0, 1e-9});
  EXPECT_THROW(plan_profiles(path_of("G64 P0.05 F6000\nG1 X10\nG1 Y10\nM2\n"), m, 1e-3), std::invalid_argument);
}

/// Random programs on random machines: whatever is said to hold, brute force finds to hold; and plans without force
/// limits hold always.
class RandomProfiles : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomProfiles, HoldByBruteForce) {
  const unsigned seed = GetParam();
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0.0, 1.0)(random));
  };
  Machine m = machine_of(1.0, unlimited, 0.2, 3);
  const bool jerk = seed % 2 == 1, force = seed % 3 == 2;
  for (Axis& axis : m.axes) {
    axis.acceleration_max = between(0.3, 10.0);
    if (jerk) axis.jerk_max = axis.acceleration_max / between(0.003, 0.05);
    if (!force) continue;
    axis.mass = between(1.0, 50.0);
    axis.damping = between(1.0, 200.0);
    axis.force_max = 0.5 * axis.mass * axis.acceleration_max + axis.damping * 0.1;
    axis.power_max = 0.06 * axis.force_max;
    axis.regeneration_max = 0.05 * axis.force_max;
  }
  const double period = seed % 4 == 0 ? 2.5e-4 : 1e-3;
  const Toolpath path = path_of(random_program(seed, 120) + "M2\n", m);
  const ProfilePlan plan = plan_profiles(path, m, period);
  EXPECT_TRUE(plan.holds());
  const auto rows = samples_of(path, plan, period);
  EXPECT_EQ(static_cast<std::int64_t>(rows.size()), plan.check.samples);
  const Brute brute(rows, path, m, period);
  // Rounding: the program's own check takes off what rounding of positions can add, at most 8 half units over T^3.
  const double largest = *std::max_element(path.points.begin(), path.points.end(),
                                           [](double a, double b) { return std::abs(a) < std::abs(b); });
  double rounding = 0.0;
  for (const Axis& axis : m.axes) {
    rounding = std::max(rounding, 8.0 * 1.2e-16 * std::abs(largest) / std::pow(period, 3) / axis.jerk_max);
    rounding = std::max(rounding, 4.0 * 1.2e-16 * std::abs(largest) / std::pow(period, 2) / axis.acceleration_max);
  }
  EXPECT_LE(brute.worst, 1.0 + 1e-8 + 4.0 * rounding);
  EXPECT_TRUE(brute.passes(path, 1e-11));
  for (std::size_t a = 0; a < path.dimensions(); ++a) EXPECT_NEAR(rows.back()[a], path.point(path.blocks())[a], 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Programs, RandomProfiles, ::testing::Range(1U, 41U));

}  // namespace
}  // namespace accdec
