#include <cmath>
#include <numbers>
#include <utility>

#include <gmock/gmock.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verified_contour.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::plane_corner;
using testing::plane_task;

TEST(Simulation, GivesTableTwoOfThePaper) {
  // Blackman-sinc, N = 40, 95 degrees, feeds 0.1 and 0.3 m/s: 488, 267, 48, 0 um.
  const Filter filter = blackman_sinc(40, 0.049);
  const double printed[] = {488, 267, 48, 0};
  const int delays[] = {0, 5, 15, 41};
  for (int i = 0; i < 4; ++i) {
    const Task task = plane_task({}, plane_corner("A", 95, 0, 0.1, 0.3), std::nullopt);
    std::vector<CornerResult> corners;
    verify_by_simulation(task, filter, {delays[i]}, nullptr, &corners);
    EXPECT_NEAR(corners[0].corner_error * 1e6, printed[i], 0.5) << "d = " << delays[i];
  }
}

TEST(PathDistance, HasThePointBetweenSamplesWhereTheNearerLegChanges) {
  // Legs along x and y; the distance of (-p, q) is the smaller of p and q, and on a chord largest where they are equal.
  const Corner corner = make_corner(Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), 0.1, 0.1);
  const auto drawn = [&](const Eigen::MatrixXd& positions) { return path_distance(positions, corner); };
  const PathDistance between = drawn(Eigen::Matrix2d{{-4.0, 1.0}, {-1.0, 4.0}});
  EXPECT_THAT(between.time, ElementsAre(0.0, DoubleNear(0.5, 1e-12), 1.0));
  EXPECT_THAT(between.distance, ElementsAre(1.0, DoubleNear(2.5, 1e-12), 1.0));
  // At a sample, there is no other point beside it: not even if 1/3 rounds.
  const double p = 1.0 / 3.0;
  const PathDistance at = drawn(Eigen::Matrix<double, 3, 2>{{-0.4, 0.1}, {-p, p}, {-0.1, 0.4}});
  EXPECT_THAT(at.time, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(at.distance, ElementsAre(0.1, p, 0.1));
}

TEST(Verifier, AgreesWithTheFormulasOnEveryMeasureAndLimit) {
  std::mt19937 rng(7);
  for (int round = 0; round < 200; ++round) {
    Task task = testing::random_task(rng, 1 + round % 3);
    task.machine.modes = {{30.0, 60.0, 0.3}, {80.0, 80.0, 0.2}};
    const int order = 1 + static_cast<int>(rng() % 40);
    const Filter filter = testing::random_filter(rng, order);
    std::vector<int> delays;
    for (std::size_t j = 0; j < task.corners.size(); ++j) delays.push_back(static_cast<int>(rng() % 50));
    std::vector<LimitUse> uses;
    std::vector<CornerResult> corners;
    const VerificationReport report = verify_by_simulation(task, filter, delays, &uses, &corners);
    std::vector<LimitUse> expected;
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      const TaskCorner& corner = task.corners[j];
      const CornerMeasures m = measure(Blend(filter, corner.geometry(), delays[j], task.sample_period));
      EXPECT_NEAR(corners[j].corner_error, m.corner_error, 1e-12 + 1e-10 * m.corner_error);
      EXPECT_NEAR(corners[j].polyline_error, m.polyline_error, 1e-12 + 1e-10 * m.polyline_error);
      EXPECT_NEAR(corners[j].contour_deviation, m.contour_deviation, 1e-12 + 1e-9 * m.contour_deviation);
      EXPECT_NEAR(corners[j].speed_min, m.speed_min, 1e-12 + 1e-10 * m.speed_min);
      for (const LimitUse& use :
           axis_utilisation(filter, corner.geometry(), delays[j], task.sample_period, task.machine, corner.name)) {
        expected.push_back(use);
      }
    }
    double worst = 0.0;
    for (const LimitUse& use : expected) {
      const auto same = std::find_if(uses.begin(), uses.end(), [&](const LimitUse& other) {
        return other.kind == use.kind && other.axis == use.axis && other.corner == use.corner;
      });
      ASSERT_NE(same, uses.end());
      EXPECT_NEAR(same->utilisation, use.utilisation, 1e-9 * (1.0 + use.utilisation)) << describe(use);
    }
    for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, task.machine)) {
      const auto same = std::find_if(uses.begin(), uses.end(), [&](const LimitUse& other) {
        return other.kind == LimitKind::vibration && other.bound == use.bound;
      });
      ASSERT_NE(same, uses.end());
      EXPECT_NEAR(same->utilisation, use.utilisation, 1e-9 * (1.0 + use.utilisation));
    }
    for (const LimitUse& use : uses) worst = std::max(worst, use.utilisation);
    EXPECT_EQ(report.feasible, worst <= 1.0 + verification_tolerance);
  }
}

TEST(Verifier, NamesTheLimitThatIsBroken) {
  Axis axis;
  axis.acceleration_max = 4.0;  // a boxcar of 20 taps at 0.1 m/s asks for 5 m/s^2
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), std::nullopt);
  const DesignResult result = assess(task, boxcar(19), {0}, false);
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_FALSE(result.filter.has_value());
  EXPECT_THAT(result.message, HasSubstr("acceleration x: 125.0 % at k = 1 of the start, corner A"));
  EXPECT_NEAR(result.verification.max_violation, 0.25, 1e-12);
}

// The second side lobe of an average of 20 taps, |sin(20 x)/(20 sin x)| with x = pi f T. The band begins or ends 0.3 Hz
// beside its peak. There the band's end has a larger value than the next point of a grid of 0.9 Hz.
TEST(Verifier, FindsPeaksBesideTheEndsOfABand) {
  const auto lobe = [](double f) {
    const double x = std::numbers::pi * f * 1e-3;
    return std::abs(std::sin(20.0 * x) / (20.0 * std::sin(x)));
  };
  double low = 110.0, high = 140.0;
  while (high - low > 1e-9) {
    const double third = (high - low) / 3.0;
    (lobe(low + third) < lobe(high - third) ? low : high) += lobe(low + third) < lobe(high - third) ? third : -third;
  }
  const double peak = 0.5 * (low + high);
  Task task;
  for (const auto& [from, to] : {std::pair{peak - 0.3, peak + 20.0}, std::pair{peak - 20.0, peak + 0.3}}) {
    task.machine.modes = {{from, to, 0.5}};
    std::vector<LimitUse> limits;
    verify_by_simulation(task, Filter(std::vector<double>(20, 0.05)), {}, &limits);
    ASSERT_EQ(limits.size(), 1U);
    EXPECT_NEAR(limits[0].value, lobe(peak), 1e-12);
  }
}

// In the time of four zero taps, free vibration falls by exp(-4 z w T), in ratio and in metres, also behind a
// prefilter.
TEST(Verifier, ModesDieAwayInTheTimeOfZeroTaps) {
  Task task = plane_task({}, plane_corner("A", 90, 0, 0.1, 0.1), std::nullopt);
  task.machine.axes.resize(2);
  task.machine.modes = {{40.0, 40.0, 0.5, 0.1, 0.1}, {40.0, 40.0, 1.0, 0.1, 0.1}};
  task.machine.modes[1].axis = 0, task.machine.modes[1].displacement_max = 1e-4;
  const auto limits = [&](int zeros) {
    std::vector<double> taps(20, 0.05);
    taps.resize(20 + static_cast<std::size_t>(zeros), 0.0);
    std::vector<LimitUse> all;
    verify_by_simulation(task, Filter(taps), {10}, &all);
    return all;
  };
  const double dies = std::exp(-0.1 * 2.0 * std::numbers::pi * 40.0 * 4 * task.sample_period);
  for (const std::vector<double>& prefilter : {std::vector<double>{}, std::vector<double>{0.5, 0.5}}) {
    task.machine.prefilter_taps = prefilter;
    const std::vector<LimitUse> none = limits(0), four = limits(4);
    ASSERT_EQ(none.size(), four.size());
    int seen = 0;
    for (std::size_t i = 0; i < none.size(); ++i) {
      if (!of_mode(none[i].kind)) continue;
      EXPECT_NEAR(four[i].value, dies * none[i].value, 1e-9 * none[i].value) << to_string(none[i].kind);
      ++seen;
    }
    EXPECT_EQ(seen, 2);
  }
}

TEST(Verifier, TakesAnExactStopAsErrorZero) {
  Task task = plane_task({}, plane_corner("A", 90, 30, 0.1, 0.2), 0.0);
  EXPECT_TRUE(verify_by_simulation(task, hann(30), {31}).feasible);
  EXPECT_FALSE(verify_by_simulation(task, hann(30), {20}).feasible);
}

TEST(Evaluate, NeedsFilterAndDelays) {
  Task task = plane_task({}, plane_corner("A", 90, 0, 0.1, 0.1), std::nullopt);
  EXPECT_THROW(evaluate_task(task), std::invalid_argument);
  task.filter = FilterSpec{.kind = Shape::boxcar, .order = 10};
  EXPECT_THROW(evaluate_task(task), std::invalid_argument);
  task.corners[0].delay = 3;
  const DesignResult result = evaluate_task(task);
  EXPECT_EQ(result.status, Status::feasible);
  EXPECT_DOUBLE_EQ(result.cycle_time, 14e-3);
}

}  // namespace
}  // namespace accdec
