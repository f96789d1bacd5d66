#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/verify.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"

// Damped modes: what is left at the filter's last tap.

namespace accdec {
namespace {

using std::numbers::pi;
using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

Task straight_on() {
  Task task = plane_task(Axis{}, plane_corner("A", 180, 0, 0.1, 0.1), std::nullopt);
  task.design.order_max = 60;
  return task;
}

// Singer and Seering's shaper without residual at one mode. Its impulses are 1/(1 + K) and K/(1 + K), with K = exp(-pi
// z/sqrt(1 - z^2)), half a damped period apart. Nothing is shorter.
TEST(DampedModes, NoResidualGivesTheZeroVibrationShaper) {
  for (const double z : {0.02, 0.1, 0.4}) {
    Task task = straight_on();
    const double f = 1.0 / (2.0 * 10 * 1e-3) / std::sqrt(1.0 - z * z), k = std::exp(-pi * z / std::sqrt(1.0 - z * z));
    task.machine.modes.push_back({f, f, 0.0, z, z});
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    ASSERT_EQ(result.filter->order(), 10);
    EXPECT_NEAR(result.filter->tap(0), 1.0 / (1.0 + k), 1e-9);
    EXPECT_NEAR(result.filter->tap(10), k / (1.0 + k), 1e-9);
  }
}

// One impulse leaves all of a vibration. A second tap n samples later leaves |b_0 exp(-(z w + j w_d) n T) + b_1|. For a
// bound r and one mode, two taps at the right distance are best. So the order is the least n at which some split of the
// two gets below r. Searched here over all splits of all pairs of taps.
TEST(DampedModes, ABoundOfAThirdIsReachedAsSoonAsTwoTapsCan) {
  const double f = 31.0, z = 0.15, w = 2.0 * pi * f * 1e-3;
  Task task = straight_on();
  task.machine.modes.push_back({f, f, 1.0 / 3.0, z, z});
  int least = 0;
  // By Caratheodory, a point of the convex hull that is nearest to the origin is on an edge: two taps are enough.
  for (int n = 1; least == 0 && n < 60; ++n) {
    for (int early = 0; early < n && least == 0; ++early) {
      for (int late = early + 1; late <= n && least == 0; ++late) {
        const auto phase = [&](int tap) {
          return std::polar(std::exp(-z * w * (n - tap)), w * std::sqrt(1.0 - z * z) * (n - tap));
        };
        const std::complex<double> a = phase(early), b = phase(late) - a;
        const double share = std::clamp(-(a.real() * b.real() + a.imag() * b.imag()) / std::norm(b), 0.0, 1.0);
        if (std::abs(a + share * b) <= 1.0 / 3.0) least = n;
      }
    }
  }
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  EXPECT_EQ(result.filter->order(), least);
}

/// Least cost over all orders, delays and samples, one linear program each.
double least_by_trial(const Task& task) {
  const exact::LimitModel model(task);
  double best = std::numeric_limits<double>::infinity();
  for (int n = 1; n <= task.design.order_max; ++n) {
    for (int d = 0; d <= n + 2 && n + 1 + d < best; ++d) {
      for (int k = 0; k <= n + d + 1; ++k) {
        exact::Relaxation relaxation(model, n);
        if (relaxation.solve({n, {{d, d, k, k}}}, task.design.symmetric).kind != exact::Outcome::feasible) continue;
        best = n + 1 + d;
        break;
      }
    }
  }
  return best;
}

/// No taps that are there only to end the filter: the last is zero or counts, and zeros at the end are needed.
void expect_needed_taps(const Task& task, const DesignResult& result) {
  if (!result.has_design()) return;
  for (const double tap : result.filter->taps()) EXPECT_FALSE(tap > 0.0 && tap < 1e-12) << tap;
  const auto taps = result.filter->taps();
  if (task.design.symmetric || taps.back() > 0.0) return;
  std::vector<int> delays;
  for (const CornerResult& c : result.corners) delays.push_back(c.delay);
  EXPECT_FALSE(verify_by_simulation(task, Filter({taps.begin(), taps.end() - 1}), delays).feasible);
}

// A strongly damped mode dies away before it swings back: a later tap only adds to it. With exp(z w n T) cos(w_d n T) >
// 1 nothing leaves less than one tap at 0 and waiting. So the order is the least n with exp(-z w n T) <= r.
TEST(DampedModes, WaitingIsBestForAStronglyDampedMode) {
  const double f = 10.0, z = 0.6, w = 2.0 * pi * f * 1e-3;
  for (const int n : {1, 4, 10}) {
    ASSERT_GT(std::exp(z * w * n) * std::cos(w * std::sqrt(1.0 - z * z) * n), 1.0);
    Task task = straight_on();
    task.machine.modes.push_back({f, f, std::exp(-z * w * n) * (1.0 + 1e-7), z, z});
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    ASSERT_EQ(result.filter->order(), n);
    EXPECT_NEAR(result.filter->tap(0), 1.0, 1e-4);
    for (const double tap : result.filter->taps()) EXPECT_FALSE(tap > 0.0 && tap < 1e-12) << tap;
  }
}

TEST(DampedModes, OneCornerAgreesWithAllOrdersDelaysAndSamples) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int found = 0, none = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    Axis axis;
    axis.acceleration_max = 4.0 + 8.0 * u(rng);
    if (i % 2 == 0) axis.jerk_max = 1000.0 + 2000.0 * u(rng);
    Task task = plane_task(axis, plane_corner("A", 40.0 + 130.0 * u(rng), 40.0 * u(rng), 0.1, 0.1), 400e-6 * u(rng));
    task.sample_period = 4e-3;
    task.design.order_max = 12;
    task.design.symmetric = i % 5 == 4;
    const double low = 15.0 + 20.0 * u(rng), damping = 0.2 * u(rng);
    task.machine.modes = {{low, low * (1.0 + 0.3 * u(rng)), 0.02 + 0.3 * u(rng), damping, damping + 0.1 * u(rng)}};
    if (i % 4 == 1) task.machine.modes.push_back({70.0, 75.0, 0.2});
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    expect_needed_taps(task, result);
    const double expected = least_by_trial(task);
    if (std::isinf(expected)) {
      EXPECT_EQ(result.status, Status::infeasible);
      ++none;
    } else {
      EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-9) << result.message;
      ++found;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(found, 30);
  EXPECT_GT(none, 0);
}

// Windows know nothing of damped modes, so lemmas of one order take over.
TEST(DampedModes, SeveralCornersAreProved) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 95, 20, 0.1, 0.1), 60e-6);
  task.corners.push_back(plane_task(axis, plane_corner("B", 60, 0, 0.08, 0.1), 90e-6).corners[0]);
  task.corners.back().weight = 3.0;
  task.machine.modes = {{37.8, 46.2, 0.05, 0.02, 0.1}};
  expect_proved(task, design_exact(task));
}

// A bound must hold for every frequency and damping of the ranges. So it costs no less than for any part of them.
TEST(DampedModes, RobustnessCosts) {
  Axis axis;
  axis.acceleration_max = 8.0;
  axis.jerk_max = 1000.0;
  const auto cost = [&](const Mode& mode) {
    Task task = plane_task(axis, plane_corner("A", 95, 20, 0.1, 0.1), 60e-6);
    task.machine.modes = {mode};
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    return result.objective();
  };
  const double robust = cost({37.8, 46.2, 0.02, 0.02, 0.1});
  for (const double f : {37.8, 42.0, 46.2}) {
    for (const double z : {0.02, 0.1}) EXPECT_LE(cost({f, f, 0.02, z, z}), robust) << f << " Hz, " << z;
  }
  EXPECT_LE(cost({37.8, 46.2, 0.02, 0.1, 0.1}), robust);
}

// A proof says nothing about modes that are damped more, or that need not be held.
TEST(DampedModes, AProofIsOfItsOwnDamping) {
  Axis axis;
  axis.acceleration_max = 8.0;
  Task task = plane_task(axis, plane_corner("A", 95, 20, 0.1, 0.1), 60e-6);
  task.machine.modes = {{37.8, 46.2, 0.02, 0.02, 0.1}};
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  for (const Mode& other : {Mode{37.8, 46.2, 0.02, 0.05, 0.1}, Mode{37.8, 46.2, 0.02, 0.0, 0.01},
                            Mode{37.8, 46.2, 0.5, 0.02, 0.1}, Mode{60.0, 70.0, 0.02, 0.02, 0.1}}) {
    Task forged = task;
    forged.machine.modes = {other};
    EXPECT_FALSE(check_certificate(forged, result).accepted);
  }
}

}  // namespace
}  // namespace accdec
