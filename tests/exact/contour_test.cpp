#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <accdec/exact/contour_path.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/relaxation.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"

// Contour tolerances in the exact method.

namespace accdec {
namespace {

using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

/// The least objective with the path changing legs at a time of a grid: an upper bound on the least of all.
double least_on_grid(const Task& task, bool with_error) {
  constexpr int parts = 16;
  const exact::LimitModel model(task);
  double best = std::numeric_limits<double>::infinity();
  for (int n = task.design.order_min; n <= task.design.order_max; ++n) {
    for (int d = 0; d <= n + 2 && n + 1 + d < best; ++d) {
      exact::Relaxation relaxation(model, n);
      for (int k = with_error ? 0 : n + d + 1; k <= n + d + 1 && n + 1 + d < best; ++k) {
        for (int c = 0; c <= (n + d + 1) * parts; ++c) {
          const double time = 1.0 * c / parts;
          if (relaxation.solve({n, {{d, d, with_error ? k : 0, k, time, time}}}, false).kind !=
              exact::Outcome::feasible)
            continue;
          best = n + 1 + d;
          break;
        }
      }
    }
  }
  return best;
}

TEST(ExactContour, NothingOnAGridIsShorter) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int bound = 0, both = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const bool with_error = i % 4 == 0;
    Axis axis;
    axis.acceleration_max = 12.0 + 10.0 * u(rng);
    Task task = plane_task(axis, plane_corner("A", 5.0 + 170.0 * u(rng), 360.0 * u(rng), 0.05 + 0.3 * u(rng), 0.2), {});
    task.sample_period = 4e-3;
    task.design.order_max = 9;
    const double step = 4e-3 * 0.3;
    task.corners[0].contour_max = step * u(rng) * u(rng);
    if (with_error) task.corners[0].error_max = step * u(rng);
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    const double grid = least_on_grid(task, with_error);
    if (std::isinf(grid)) continue;
    EXPECT_LE(result.objective() / task.sample_period, grid + 1e-9);
    Task without = task;
    without.corners[0].contour_max.reset();
    const double before = design_exact(without).objective();
    EXPECT_LE(before, result.objective() * (1.0 + 1e-9));
    if (before < result.objective() * (1.0 - 1e-9)) ++(with_error ? both : bound);
    if (HasFailure()) break;
  }
  EXPECT_GT(bound, 3);
  EXPECT_GT(both, 0);
}

// The least over all times of the larger leg distance is the verifier's deviation: that of the polyline's vertices and
// chords from two rays.
TEST(ExactContour, PathIsThatOfTheVerifier) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    Task task = plane_task({}, plane_corner("A", 2.0 + 176.0 * u(rng), 360.0 * u(rng), 0.05 + u(rng), 0.1), {});
    task.corners[0].contour_max = 1e-5;
    const Filter filter = testing::random_filter(rng, 1 + static_cast<int>(12 * u(rng)));
    const int delay = static_cast<int>(u(rng) * filter.order());
    std::vector<CornerResult> corners;
    verify_by_simulation(task, filter, {delay}, nullptr, &corners);
    const exact::LimitModel model(task);
    const exact::ContourPath path(model, filter, 0);
    const double last = filter.order() + delay + 1;
    const double largest = path.missed(delay, path.crossing(delay, {delay, delay, 0, 0, 0.0, last}));
    const double found = *task.corners[0].contour_max * (1.0 + largest / model.contour_bound(0));
    EXPECT_NEAR(found, corners[0].contour_deviation, 1e-9 * found + 1e-12);
    EXPECT_NEAR(measure(Blend(filter, task.corners[0].geometry(), delay, task.sample_period)).contour_deviation,
                corners[0].contour_deviation, 1e-9 * found + 1e-12);
  }
}

TEST(ExactContour, FineSamplesUseIt) {
  Axis axis;
  axis.acceleration_max = 6.0, axis.jerk_max = 500.0;
  Task task = plane_task(axis, plane_corner("A", 95.0, 0.0, 0.1, 0.1), {});
  task.sample_period = 0.25e-3;
  task.corners[0].contour_max = 20e-6;
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  EXPECT_GT(result.corners[0].contour_deviation, 0.95 * 20e-6);
  // The proof is about this tolerance: of a looser one it proves nothing.
  task.corners[0].contour_max = 40e-6;
  EXPECT_FALSE(check_certificate(task, result).accepted);
}

}  // namespace
}  // namespace accdec
