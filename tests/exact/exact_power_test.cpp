#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/filter.hpp>
#include <accdec/solver.hpp>
#include <accdec/verify.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

Axis frictionless() {
  Axis axis;
  axis.mass = 30.0;
  axis.force_max = 450.0;
  return axis;
}

/// A square corner without tolerance at v (m/s), sampled every t (s).
DesignResult proved_exact_stop(const Axis& axis, double v, double t) {
  Task task = plane_task(axis, plane_corner("A", 90, 0, v, v), 0.0);
  task.sample_period = t;
  task.design.order_max = 80;
  DesignResult result = design_exact(task);
  expect_proved(task, result);
  return result;
}

// Exact stop of frictionless axes, limited by force and then by power. The shortest start has constant acceleration up
// to V* = P/F, then the speed is the square root of V*^2 + 2 P t/m. Sampled, B_k is the largest root of what one step
// allows. A stop is limited only by force, so the same filter works. Leg 2 starts when leg 1 has stopped: d = N.
TEST(ExactPower, ForceThenPowerIsTheSaturatingStart) {
  for (const double power : {60.0, 100.0, 140.0, 400.0}) {
    Axis axis = frictionless();
    axis.power_max = power;
    SCOPED_TRACE(power);
    const double v = 0.4, t = 2e-3, step = axis.force_max * t / (axis.mass * v);
    const DesignResult result = proved_exact_stop(axis, v, t);
    // m v/T (B_k - B_{k-1}) v B_k <= P
    const double p = power * t / (axis.mass * v * v);
    int taps = 0;
    for (double b = 0.0; b < 1.0 - 1e-12; ++taps) b = std::min(b + step, 0.5 * (b + std::sqrt(b * b + 4.0 * p)));
    EXPECT_EQ(result.filter->order() + 1, taps);
    EXPECT_EQ(result.filter->order() + result.corners[0].delay, 2 * (taps - 1));
    // This agrees to the sample with continuous time: m V*/F + m (v^2 - V*^2)/(2 P).
    const double knee = std::min(v, power / axis.force_max);
    const double tau = axis.mass * knee / axis.force_max + axis.mass * (v * v - knee * knee) / (2.0 * power);
    EXPECT_NEAR(taps, tau / t, 2.0);
  }
}

// Regeneration is the mirror image except for the last step. Power is counted with the speed at the end of a step, so a
// stop regenerates nothing in the step that ends at rest.
TEST(ExactPower, RegenerationIsTheMirrorImage) {
  for (const double power : {40.0, 70.0, 120.0}) {
    Axis axis = frictionless();
    axis.regeneration_max = power;
    SCOPED_TRACE(power);
    const double v = 0.4, t = 2e-3, step = axis.force_max * t / (axis.mass * v);
    const DesignResult result = proved_exact_stop(axis, v, t);
    // Backwards from rest, w = 1 - B: the w before is w + min(step, p/w).
    const double p = power * t / (axis.mass * v * v);
    int taps = 0;
    for (double w = 0.0; w < 1.0 - 1e-12; ++taps) w += w > 0.0 ? std::min(step, p / w) : step;
    EXPECT_EQ(result.filter->order() + 1, taps);
    EXPECT_EQ(result.filter->order() + result.corners[0].delay, 2 * (taps - 1));
  }
}

/// Two equal axes, few long samples, and a mix of limits outside the convex class.
Task small_task(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Axis axis;
  axis.mass = 10.0 + 40.0 * u(rng);
  axis.damping = u(rng) < 0.5 ? 0.0 : 60.0 * u(rng);
  if (u(rng) < 0.8) axis.force_max = axis.mass * (4.0 + 8.0 * u(rng));
  if (u(rng) < 0.5) axis.acceleration_max = 5.0 + 8.0 * u(rng);
  const double feed = 0.15 + 0.15 * u(rng), other = u(rng) < 0.5 ? feed : feed * (0.5 + 0.5 * u(rng));
  const double scale = axis.mass * feed * 5.0;
  const double kind = u(rng);
  if (kind < 0.6) axis.power_max = scale * (0.4 + 0.6 * u(rng)) + axis.damping * feed * feed;
  if (kind > 0.4) axis.regeneration_max = scale * (0.3 + 0.6 * u(rng));
  Task task = plane_task(axis, plane_corner("A", 40.0 + 130.0 * u(rng), 90.0 * u(rng), feed, other),
                         0.5 * 16e-3 * feed * u(rng));
  if (u(rng) < 0.4) task.corners[0].speed_min = 0.4 * u(rng) * other;
  task.sample_period = 16e-3;
  task.design.order_max = 4;
  return task;
}

/// Calls `visit` with every filter of order n whose taps are multiples of 1/parts.
void each_on_grid(int n, int parts, const std::function<bool(const Filter&)>& visit) {
  std::vector<int> taps(static_cast<std::size_t>(n) + 1, 0);
  const std::function<bool(std::size_t, int)> fill = [&](std::size_t i, int left) {
    if (i + 1 == taps.size()) {
      taps[i] = left;
      return visit(Filter(std::vector<double>(taps.begin(), taps.end())));
    }
    for (taps[i] = 0; taps[i] <= left; ++taps[i]) {
      if (!fill(i + 1, left - taps[i])) return false;
    }
    return true;
  };
  fill(0, parts);
}

// No filter on a fine grid, with any delay, beats what is claimed to be optimal, and that itself holds all limits.
TEST(ExactPower, NothingOnAGridIsShorter) {
  std::mt19937 rng(3);
  int found = 0, dearer = 0;
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Task task = small_task(rng);
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    if (HasFailure()) return;
    const bool none = result.status == Status::infeasible;
    const int total = none ? 100 : result.filter->order() + result.corners[0].delay;
    found += none ? 0 : 1;
    Task convex = task;
    for (Axis& axis : convex.machine.axes) axis.power_max = axis.regeneration_max = unlimited;
    convex.corners[0].speed_min = 0.0;
    const DesignResult easier = design_exact(convex);
    if (easier.status == Status::optimal && easier.filter->order() + easier.corners[0].delay < total) ++dearer;
    for (int n = 1; n <= 4; ++n) {
      const int parts = n == 1 ? 200 : n == 2 ? 80 : n == 3 ? 30 : 18;
      each_on_grid(n, parts, [&](const Filter& filter) {
        for (int d = std::min(n + 1, total - 1 - n); d >= 0; --d) {
          // Cheaper than the simulation, and mostly enough.
          if (corner_error(Blend(filter, task.corners[0].geometry(), d, task.sample_period)) >
              *task.corners[0].error_max)
            continue;
          EXPECT_FALSE(verify_by_simulation(task, filter, {d}).feasible) << "order " << n << ", delay " << d;
        }
        return !HasFailure();
      });
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(found, 50);
  EXPECT_GT(dearer, 15);
}

// Neither does a nonlinear solver from several starts, at every sample of every pair of order and delay one shorter.
TEST(ExactPower, NoLocalSolverIsShorter) {
  std::mt19937 rng(5);
  int solves = 0, works = 0;
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE(i);
    const Task task = small_task(rng);
    const DesignResult result = design_exact(task);
    if (result.status != Status::optimal) continue;
    const int total = result.filter->order() + result.corners[0].delay;
    for (int sum : {total, total - 1}) {
      bool held = false;
      for (int n = 1; n <= std::min(4, sum); ++n) {
        const int d = std::min(sum - n, n + 1);
        FormulationOptions options;
        options.order = n;
        options.blend_delays = {d};
        options.mode_frequencies.clear();
        for (int k = 0; k <= n + d + 1 && !held; ++k) {
          const MarginProblem problem(task, options, std::vector<int>{k});
          for (const Filter& start : {boxcar(n), testing::random_filter(rng, n), testing::random_filter(rng, n)}) {
            const auto solved = solvers::find_solver("ipopt").solve(problem, problem.start_from(start));
            ++solves;
            if (solved.x.empty()) continue;
            held |= verify_by_simulation(task, filter_from(solved.x, n), {d}).feasible;
          }
        }
      }
      if (sum == total)
        works += held;
      else
        EXPECT_FALSE(held) << "total " << sum;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(solves, 200);
  EXPECT_GT(works, 3);  // it does find the optimum where there is one
}

TEST(ExactPower, InfeasibleNamesTheLimitsOutsideTheConvexClass) {
  Axis axis;
  axis.mass = 30.0;
  axis.force_max = 450.0;
  axis.power_max = 60.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.4, 0.4), 0.0);
  task.sample_period = 2e-3;
  task.design.order_max = 18;  // the saturating start takes 24 taps
  const DesignResult result = design_exact(task);
  ASSERT_EQ(result.status, Status::infeasible);
  EXPECT_NE(result.message.find("power"), std::string::npos) << result.message;
  EXPECT_TRUE(check_certificate(task, result).accepted);
}

}  // namespace
}  // namespace accdec
