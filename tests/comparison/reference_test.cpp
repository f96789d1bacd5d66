#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/comparison/reference_delay.hpp>
#include <accdec/solver.hpp>

#include "support/tasks.hpp"

namespace accdec::comparison {
namespace {

using accdec::testing::degrees;

constexpr double feed = 0.1, period = 1e-3;

/// A corner at 0.1 m/s with 1 ms samples; limits on the blend are imposed where the legs are apart, so that the taps'
/// are all.
CaseSpec corner_case(Question question, const Axis& axis, int order, double error, double angle = 90.0,
                     double heading = 0.0) {
  CaseSpec spec;
  spec.name = "corner";
  spec.question = question;
  spec.task = accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", angle, heading, feed, feed), error);
  spec.order = order;
  spec.delays = {order + 1};
  return spec;
}

/// Acceleration such that no tap is above 1/taps.
Axis boxcar_axis(double taps) {
  Axis axis;
  axis.acceleration_max = feed / (taps * period);
  return axis;
}

void expect_proved(const Reference& r, double value, double tolerance) {
  EXPECT_EQ(r.proof, Reference::Proof::optimal) << r.method;
  EXPECT_LE(r.lower, r.upper);
  EXPECT_LE(r.upper - r.lower, 5e-5 * std::max(1.0, r.upper)) << r.method;
  EXPECT_LE(r.lower, value + tolerance) << r.method;
  EXPECT_GE(r.upper, value - tolerance) << r.method;
}

// Only a boxcar of L taps is left. Interpolated it is linear Acc/Dec of duration L T: eps = v L T/4 cos(theta/2) (1 -
// d/L)^2 by Eq. (12).
TEST(DelayReference, OfLinearAccDec) {
  for (const double angle : {40.0, 90.0, 130.0}) {
    for (const double error : {20e-6, 150e-6}) {
      const double taps = 25.0, free = feed * period * taps / 4.0 * std::cos(degrees(angle) / 2.0);
      const double delay = taps * std::max(0.0, 1.0 - std::sqrt(error / free));
      // Multiplied by 1 + 1e-9: at the bound itself rounding of 25 taps decides whether there is any filter.
      Axis axis = boxcar_axis(taps);
      axis.acceleration_max *= 1.0 + 1e-9;
      SCOPED_TRACE(::testing::Message() << angle << " deg, " << error << " m");
      expect_proved(reference_of(ComparisonCase(corner_case(Question::delay, axis, 24, error, angle)), 30.0), delay,
                    1e-6);
    }
  }
}

// No limit but the error: one tap, which interpolated lasts one sample, whatever order is allowed.
TEST(DelayReference, OfASingleTapWhereNothingElseIsLimited) {
  for (const int order : {0, 1, 5}) {
    const double error = 5e-6, free = feed * period / 4.0 * std::cos(degrees(30.0));
    const Reference r = reference_of(ComparisonCase(corner_case(Question::delay, Axis{}, order, error, 60.0)), 30.0);
    expect_proved(r, 1.0 - std::sqrt(error / free), 1e-6);
  }
}

/// Least delay of taps by quadrature and search, sharing nothing with the library. The midpoint rule is exact for the
/// linear pieces that `steps` divides, and O(1/steps^2) otherwise.
double delay_by_hand(const std::vector<double>& taps, double cosine, double reach) {
  constexpr int steps = 64;
  const int length = static_cast<int>(taps.size());
  std::vector<double> response, gone{0.0};  // B at cell middles, its integral at cell ends
  double sum = 0.0;
  for (int i = 0; i < length; ++i) {
    for (int s = 0; s < steps; ++s) response.push_back(sum + taps[static_cast<std::size_t>(i)] * (s + 0.5) / steps);
    sum += taps[static_cast<std::size_t>(i)];
  }
  for (const double b : response) gone.push_back(gone.back() + b / steps);
  const int cells = length * steps;
  const double total = length - gone.back();  // integral of 1 - B
  for (int d = 0; d <= cells; ++d) {
    for (int t = 0; t <= cells; ++t) {
      const auto at = [&](int k) { return gone[static_cast<std::size_t>(std::clamp(k, 0, cells))]; };
      const double p = total - (static_cast<double>(t) / steps - at(t)), q = at(t - d);
      if (p * p + q * q + 2.0 * cosine * p * q <= reach * reach) return static_cast<double>(d) / steps;
    }
  }
  return length;
}

// Every filter of three taps on a grid: none needs less than the proved bound, and the best is as good but for the
// grids.
TEST(DelayReference, AgreesWithEnumeratedFilters) {
  for (const double angle : {60.0, 120.0}) {
    const double error = 20e-6;
    const Reference r =
        reference_of(ComparisonCase(corner_case(Question::delay, boxcar_axis(2.2), 2, error, angle)), 30.0);
    double least = 1e9;
    constexpr int grid = 44;  // holds 1/2.2 = 20/44
    for (int a = 0; a <= 20; ++a) {
      for (int b = 0; b <= 20; ++b) {
        const int c = grid - a - b;
        if (c < 0 || c > 20) continue;
        least = std::min(
            least, delay_by_hand({a / 44.0, b / 44.0, c / 44.0}, std::cos(degrees(angle)), error / (feed * period)));
      }
    }
    // Steps of t and d: 1/64 sample each.
    expect_proved(r, least, 1.5 / 64.0);
    EXPECT_LE(r.lower, least);
  }
}

// None of the filters drawn at random that hold the limits beats the bound.
TEST(DelayReference, IsNotBeatenByRandomFilters) {
  std::mt19937 rng(7);
  std::exponential_distribution<double> draw;
  const double error = 60e-6;
  for (const double angle : {50.0, 140.0}) {
    const CaseSpec spec = corner_case(Question::delay, boxcar_axis(4.0), 6, error, angle);
    const Reference r = reference_of(ComparisonCase(spec), 30.0);
    ASSERT_EQ(r.proof, Reference::Proof::optimal) << r.method;
    const DelaySearch search(spec.task, 0, 6, spec.delays, {});
    int held = 0;
    for (int i = 0; i < 3000; ++i) {
      std::vector<double> taps;
      for (int k = 0; k < 7; ++k) taps.push_back(draw(rng));
      const Filter filter(taps);
      if (*std::max_element(filter.taps().begin(), filter.taps().end()) > 0.25) continue;
      ++held;
      EXPECT_GE(search.delay_of(filter).first, r.lower);
    }
    EXPECT_GT(held, 100);
  }
}

/// Least verified objective of Ipopt from starts until one comes to `enough`: delay questions have local optima.
double by_ipopt(const ComparisonCase& subject, double enough) {
  double least = 1e9;
  for (int i = 0; i < 30 && least > enough; ++i) {
    const auto result = solvers::find_solver("ipopt").solve(*subject.problem(false), subject.start(false, i, 5));
    if (result.verification.verdict != solvers::Verdict::optimal) continue;
    least = std::min(least, result.verification.objective);
  }
  return least;
}

// A second opinion, which shares nothing with branch and bound, with limits of every kind. The brackets are 5e-5 and
// 1e-5 wide.
TEST(References, AgreeWithTheInteriorPointMethod) {
  Axis jerk = boxcar_axis(5.0);
  jerk.jerk_max = 0.5 * jerk.acceleration_max / period;
  Axis power = boxcar_axis(4.0);
  power.mass = 10.0, power.damping = 5.0, power.power_max = 0.6 * power.mass * power.acceleration_max * feed;
  Axis braking = power;
  braking.power_max = unlimited, braking.regeneration_max = 0.7 * power.mass * power.acceleration_max * feed;
  for (const Axis& axis : {boxcar_axis(3.5), jerk, power, braking}) {
    for (const double angle : {70.0, 115.0}) {
      for (const Question question : {Question::margin, Question::delay}) {
        CaseSpec spec = corner_case(question, axis, 9, 60e-6, angle, 15.0);
        spec.delays = {3};
        spec.task =
            accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", angle, 15.0, feed, 0.8 * feed), 60e-6);
        const ComparisonCase subject(spec);
        const Reference r = reference_of(subject, 60.0);
        expect_proved(r, by_ipopt(subject, r.upper), 1e-6 * std::max(1.0, r.upper));
      }
    }
  }
}

TEST(References, WithASmallestSpeedAgreeToo) {
  for (const Question question : {Question::margin, Question::delay}) {
    CaseSpec spec = corner_case(question, boxcar_axis(6.0), 9, 40e-6, 100.0);
    spec.delays = {1};
    spec.task.corners[0].speed_min = 0.55 * feed;
    const ComparisonCase subject(spec);
    const Reference r = reference_of(subject, 60.0);
    expect_proved(r, by_ipopt(subject, r.upper), 1e-6);
  }
}

// Two corners of the same kind want the same filter: both delays are least at once. With tolerances that differ the sum
// is a bound.
TEST(DelayReference, OfTwoCorners) {
  CaseSpec spec = corner_case(Question::delay, boxcar_axis(25.0), 30, 50e-6);
  spec.task.corners.push_back(spec.task.corners[0]);
  spec.delays = {31, 31};
  spec.task.corners[1].name.assign(1, 'B');
  spec.task.corners[1].weight = 3.0;
  const Reference one = reference_of(ComparisonCase(corner_case(Question::delay, boxcar_axis(25.0), 30, 50e-6)), 30.0);
  const Reference two = reference_of(ComparisonCase(spec), 30.0);
  expect_proved(two, 4.0 * one.upper, 4.0 * (one.upper - one.lower));
}

}  // namespace
}  // namespace accdec::comparison
