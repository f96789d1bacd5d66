#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/slow_down.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec::study {
namespace {

/// Filters a command by plain convolution: "full feed, slow zone of h samples, corner, slow zone of h samples, full
/// feed". Returns the smallest distance of its samples from the corner, and the additional time compared with no zones.
double simulated_error(const Filter& filter, const Corner& corner, double period, double factor, int h) {
  const int lead = 3 * filter.order() + h + 5;
  std::vector<Eigen::VectorXd> command;
  Eigen::VectorXd travelled = Eigen::VectorXd::Zero(corner.axes()), leg1 = travelled;
  for (int i = 0; i < 2 * lead; ++i) {
    const bool slow = i >= lead - h && i < lead + h;
    const double scale = slow ? factor : 1.0;
    command.push_back(scale *
                      (i < lead ? corner.feed_in * corner.direction_in : corner.feed_out * corner.direction_out));
    if (i < lead) leg1 += command.back() * period;
  }
  // The filter has passed exactly the command's distance at its end; start where the corner point is the origin.
  Eigen::VectorXd position = -leg1;
  double least = position.norm();
  for (int k = 0; k < 2 * lead; ++k) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(corner.axes());
    for (int i = 0; i <= std::min(k, filter.order()); ++i)
      v += filter.tap(i) * command[static_cast<std::size_t>(k - i)];
    position += v * period;
    least = std::min(least, position.norm());
  }
  return least;
}

TEST(SlowDown, KeepsTheToleranceInTheSimulatedStream) {
  const double period = 1e-3;
  for (const double angle : {60.0, 90.0, 130.0}) {
    for (const Filter& filter : {boxcar(40), hann(40), trapezoid(31, 8)}) {
      const Corner corner = planar_corner(angle * M_PI / 180.0, 0.3, Turn::left, 0.1, 0.1);
      const double full = corner_error(Blend(filter, corner, 0, period));
      const SlowDown s = slow_down({filter, {}, 1e-3}, corner, period, 0.4 * full);
      EXPECT_NEAR(s.factor, 0.4, 1e-12);
      // Zones of half the filter on either side are enough: the error is the tolerance, no more.
      const int half = (filter.order() + 2) / 2;
      EXPECT_NEAR(simulated_error(filter, corner, period, s.factor, half), 0.4 * full, 1e-9);
      EXPECT_NEAR(s.lost_time, 0.6 * (filter.order() + 1) * period, 1e-12);
    }
  }
}

TEST(SlowDown, CostsNothingInsideTheToleranceAndAnExactStopAtZero) {
  const Filter filter = boxcar(20);
  const Corner corner = planar_corner(1.5, 0.0, Turn::left, 0.1, 0.1);
  EXPECT_EQ(slow_down({filter, {}, 1e-3}, corner, 1e-3, 1.0).factor, 1.0);
  EXPECT_EQ(slow_down({filter, {}, 1e-3}, corner, 1e-3, 1.0).lost_time, 0.0);
  const SlowDown stop = slow_down({filter, {}, 1e-3}, corner, 1e-3, 0.0);
  EXPECT_EQ(stop.factor, 0.0);
  EXPECT_NEAR(stop.lost_time, 21e-3, 1e-15);
}

TEST(SlowDown, LosesMoreThanADelayWithLinearAccDec) {
  // Continuous linear Acc/Dec: error = e0 (1 - d/tau)^2, so a delay costs tau (1 - sqrt(r)) and slowing down tau (1 -
  // r), r = E/e0.
  const Filter filter = boxcar(400);
  const Corner corner = planar_corner(M_PI / 2, 0.0, Turn::left, 0.1, 0.1);
  const double period = 1e-4, full = corner_error(Blend(filter, corner, 0, period));
  for (const double r : {0.1, 0.3, 0.6, 0.9}) {
    const int delay = DelayFinder(filter)(corner.cos_interior(), 0.1 * period, 0.1 * period, r * full);
    EXPECT_NEAR(delay / 401.0, 1.0 - std::sqrt(r), 3.0 / 401.0);
    EXPECT_GE(slow_down({filter, {}, 1e-3}, corner, period, r * full).lost_time, delay * period);
  }
}

/// The feed to which a corner is slowed is the fastest at which the verifier finds its contour held.
TEST(SlowDown, KeepsTheContour) {
  Axis axis;
  for (const double angle : {50.0, 90.0, 140.0}) {
    Task task = testing::plane_task(axis, testing::plane_corner("A", angle, 0, 0.1, 0.08), 200e-6);
    task.filter = FilterSpec{.kind = Shape::boxcar, .order = 30};
    task.corners[0].contour_max = 60e-6;
    Row row;
    compute_into(row, task, "slow-down", {});
    const double factor = row.at("slow-down.factor").get<double>();
    ASSERT_LT(factor, 1.0);
    for (const double more : {1.0, 1.01}) {
      Task slow = task;
      slow.corners[0].set_feeds(more * factor * 0.1, more * factor * 0.08);
      EXPECT_EQ(verify_by_simulation(slow, boxcar(30), {0}).feasible, more == 1.0) << angle;
    }
  }
}

// A boxcar of 20 taps at the acceleration limit, on a corner that turns back by all but a degree. At d = N its last tap
// brakes while its first accelerates the same way: together twice the limit. One sample more separates them: 20 + 20
// samples.
TEST(ExactStop, HoldsTheLimits) {
  Axis axis;
  axis.acceleration_max = 0.1 / 20e-3;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 1.0, 0, 0.1, 0.1), std::nullopt);
  task.filter = FilterSpec{.kind = Shape::boxcar, .order = 19};
  Row row;
  compute_into(row, task, "exact-stop", {});
  EXPECT_EQ(row.at("exact-stop.status"), "feasible");
  EXPECT_EQ(row.at("exact-stop.delay_samples"), 20);
  EXPECT_NEAR(row.at("exact-stop.cycle_time_ms").get<double>(), 40.0, 1e-9);
}

}  // namespace
}  // namespace accdec::study
