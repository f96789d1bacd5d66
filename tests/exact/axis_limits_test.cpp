#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/exact/exact.hpp>

#include "dense_lp.hpp"
#include "expect_proved.hpp"
#include "support/tasks.hpp"
#include "support/tries.hpp"

// Modes of axes in metres, and force-speed curves: designs and proofs beside a linear program of this file for every
// order and delay.

namespace accdec {
namespace {

using std::numbers::pi;
using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

/// The limits of one order and delay as rows in the taps.
class Program {
 public:
  Program(const Task& task, int order, int delay) : task_(task), order_(order), delay_(delay) {
    lp_.cost.assign(taps(), 0.0), lp_.low.assign(taps(), 0.0), lp_.high.assign(taps(), 1.0);
    add(std::vector<double>(taps(), 1.0), 1.0, 1.0);
  }
  bool feasible() {
    exact::DualSimplex simplex = exact::make(lp_);
    return simplex.solve() == exact::DualSimplex::Status::optimal;
  }

  /// Accelerations, and below the lines of a curve, of one axis in one event.
  void add_samples(const Axis& axis, double in, double out, int delay) {
    for (int k = 1; k <= order_ + 1 + delay; ++k) {
      const std::vector<double> a = acceleration(in, out, delay, k), v = velocity(in, out, delay, k);
      if (axis.acceleration_max < unlimited) add(a, -axis.acceleration_max, axis.acceleration_max);
      for (std::size_t i = 0; i + 1 < axis.force_speed.size(); ++i) {
        const SpeedForce p = axis.force_speed[i], q = axis.force_speed[i + 1];
        for (const double side : {1.0, -1.0}) {
          for (const double way : {1.0, -1.0}) {
            if (in * way <= 0.0 && out * way <= 0.0) continue;
            // side F (q.v - p.v) <= p.f (q.v - |v|) + q.f (|v| - p.v), the friction against the way
            std::vector<double> row(taps());
            const double wide = q.speed - p.speed, fall = p.force - q.force;
            for (std::size_t t = 0; t < row.size(); ++t)
              row[t] = side * (axis.mass * a[t] + axis.damping * v[t]) * wide + fall * way * v[t];
            add(row, -exact::no_bound, p.force * wide + fall * p.speed - side * way * axis.coulomb * wide);
          }
        }
      }
    }
  }

  /// The residual of a mode after one event, seen in many directions. Inside the circle of the bound, or around it.
  void add_mode(const Mode& mode, double in, double out, int delay, bool inside) {
    constexpr int directions = 180;
    const double w = 2.0 * pi * mode.frequency_low, z = mode.damping_low, damped = w * std::sqrt(1.0 - z * z);
    const double period = task_.sample_period;
    std::vector<std::complex<double>> left(taps(), 0.0);
    const int last = order_ + 1 + (out != 0.0 ? delay : 0);
    for (int k = 1; k <= last; ++k) {
      const std::vector<double> change = acceleration(in, out, delay, k);
      for (std::size_t t = 0; t < left.size(); ++t)
        left[t] += change[t] * period * std::exp(std::complex<double>(-z * w, -damped) * (last - k * 1.0) * period);
    }
    const double bound = mode.displacement_max * damped * (inside ? std::cos(pi / directions) : 1.0);
    for (int i = 0; i < directions; ++i) {
      std::vector<double> row;
      for (const auto& x : left) row.push_back((x * std::polar(1.0, 2.0 * pi * i / directions)).real() / bound);
      add(row, -exact::no_bound, 1.0);
    }
  }

 private:
  std::size_t taps() const { return static_cast<std::size_t>(order_) + 1; }
  void add(std::vector<double> row, double low, double high) {
    lp_.rows.push_back(std::move(row)), lp_.row_low.push_back(low), lp_.row_high.push_back(high);
  }
  std::vector<double> acceleration(double in, double out, int delay, int k) const {
    std::vector<double> row(taps(), 0.0);
    for (int i = 0; i <= order_; ++i) {
      if (i == k - 1) row[static_cast<std::size_t>(i)] -= in / task_.sample_period;
      if (i == k - 1 - delay) row[static_cast<std::size_t>(i)] += out / task_.sample_period;
    }
    return row;
  }
  std::vector<double> velocity(double in, double out, int delay, int k) const {
    std::vector<double> row(taps(), 0.0);
    for (int i = 0; i <= order_; ++i)
      row[static_cast<std::size_t>(i)] = (i >= k ? in : 0.0) + (i < k - delay ? out : 0.0);
    return row;
  }

  const Task& task_;
  int order_, delay_;
  exact::Lp lp_;
};

bool holds(const Task& task, int order, int delay, bool inside) {
  Program program(task, order, delay);
  for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
    const Corner& g = task.corners[0].geometry();
    const auto x = static_cast<Eigen::Index>(a);
    const double in = g.feed_in * g.direction_in[x], out = g.feed_out * g.direction_out[x];
    const auto event = [&](double from, double to, int d) {
      program.add_samples(task.machine.axes[a], from, to, d);
      for (const Mode& mode : task.machine.modes) {
        if (static_cast<std::size_t>(mode.axis) == a) program.add_mode(mode, from, to, d, inside);
      }
    };
    event(0.0, in, 0), event(in, out, delay), event(out, 0.0, 0);
  }
  return program.feasible();
}

/// Least N + 1 + d, in samples.
double least_by_programs(const Task& task, bool inside) {
  for (int length = 1; length <= task.design.order_max + 60; ++length) {
    for (int n = task.design.order_min; n <= std::min(length - 1, task.design.order_max); ++n) {
      if (holds(task, n, length - 1 - n, inside)) return length;
    }
  }
  return std::numeric_limits<double>::infinity();
}

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }

 private:
  std::mt19937 rng_;
};

Task random_task(Random& random) {
  Axis axis;
  axis.acceleration_max = random(5.0, 15.0);
  Task task =
      plane_task(axis, plane_corner("A", random(20.0, 180.0), random(0.0, 90.0), random(0.05, 0.2), 0.1), std::nullopt);
  task.sample_period = 4e-3;
  task.design.order_max = 11;
  return task;
}

TEST(ModesOfAxes, NoOrderAndDelayIsShorter) {
  Random random(7);
  int found = 0, bound = 0;
  for (int i = 0; i < test_support::tries(30); ++i) {
    SCOPED_TRACE(i);
    Task task = random_task(random);
    const double f = random(12.0, 60.0), z = i % 3 == 0 ? 0.0 : random(0.0, 0.2);
    task.machine.modes = {{f, f, 1.0, z, z, i % 2, random(20e-6, 300e-6)}};
    const DesignResult result = design_exact(task);
    const double some = least_by_programs(task, true), none = least_by_programs(task, false);
    if (std::isinf(none) || !result.filter) {
      EXPECT_FALSE(result.filter) << none;
      continue;
    }
    ++found;
    expect_proved(task, result);
    EXPECT_LE(result.objective() / task.sample_period, some + 1e-9) << result.message;
    EXPECT_GE(result.objective() / task.sample_period, none - 1e-9) << result.message;
    Task free = task;
    free.machine.modes.clear();
    if (design_exact(free).objective() < result.objective() * (1.0 - 1e-9)) ++bound;
    if (HasFailure()) break;
  }
  EXPECT_GT(found, test_support::tries(30) / 2);
  EXPECT_GT(bound, test_support::tries(30) / 4);
}

// A leg of each axis alone: the bound in metres is one on the filter's residual.
TEST(ModesOfAxes, OneLegAnAxisAsksForAResidual) {
  Axis axis;
  axis.acceleration_max = 8.0, axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 90.0, 0.0, 0.1, 0.08), 100e-6), ratio = task;
  const double f = 40.0, z = 0.05, damped = 2.0 * pi * f * std::sqrt(1.0 - z * z);
  for (const int a : {0, 1}) {
    task.machine.modes = {{f, f, 1.0, z, z, a, 30e-6}};
    ratio.machine.modes = {{f, f, 30e-6 * damped / (a == 0 ? 0.1 : 0.08), z, z}};
    const DesignResult result = design_exact(task), same = design_exact(ratio);
    expect_proved(task, result);
    EXPECT_EQ(result.objective(), same.objective());
  }
}

TEST(ModesOfAxes, AProofIsOfItsOwnBound) {
  Axis axis;
  axis.acceleration_max = 8.0, axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 120.0, 10.0, 0.1, 0.1), 100e-6);
  task.machine.modes = {{36.0, 44.0, 1.0, 0.02, 0.1, 0, 10e-6}};
  const DesignResult result = design_exact(task);
  expect_proved(task, result);
  for (const Mode& other : {Mode{36.0, 44.0, 1.0, 0.02, 0.1, 0, 40e-6}, Mode{36.0, 44.0, 1.0, 0.05, 0.1, 0, 10e-6},
                            Mode{60.0, 70.0, 1.0, 0.02, 0.1, 0, 10e-6}, Mode{36.0, 44.0, 0.5, 0.02, 0.1}}) {
    Task forged = task;
    forged.machine.modes = {other};
    EXPECT_FALSE(check_certificate(forged, result).accepted);
  }
}

// Windows know no blends of modes, and equal corners must not exchange an axis that vibrates.
TEST(ModesOfAxes, SeveralCornersAreProved) {
  Axis axis;
  axis.acceleration_max = 8.0, axis.jerk_max = 1000.0;
  Task task = plane_task(axis, plane_corner("A", 95, 20, 0.1, 0.1), 60e-6);
  task.corners.push_back(plane_task(axis, plane_corner("B", 95, -75, 0.1, 0.1), 60e-6).corners[0]);
  task.machine.modes = {{38.0, 46.0, 1.0, 0.02, 0.1, 0, 15e-6}};
  expect_proved(task, design_exact(task));
}

TEST(ForceSpeedCurve, NoOrderAndDelayIsShorter) {
  Random random(11);
  int found = 0, bound = 0;
  for (int i = 0; i < test_support::tries(60); ++i) {
    SCOPED_TRACE(i);
    Task task = random_task(random);
    for (Axis& axis : task.machine.axes) {
      axis.mass = 50.0, axis.damping = i % 3 == 0 ? random(0.0, 600.0) : 0.0;
      const double first = random(250.0, 700.0), second = first * random(0.6, 1.0);
      axis.force_speed = {{0.0, first}, {random(0.02, 0.1), second}, {0.21, second * random(0.1, 0.5)}};
      const double fall = (first - second) / axis.force_speed[1].speed;
      axis.force_speed[2].force =
          std::min(axis.force_speed[2].force, second - fall * (0.21 - axis.force_speed[1].speed));
      if (axis.force_speed[2].force < 0.0) axis.force_speed = {{0.0, first}, {0.21, 0.3 * first}};
      axis.force_speed_max = first;
    }
    const DesignResult result = design_exact(task);
    const double least = least_by_programs(task, true);
    expect_proved(task, result);
    if (std::isinf(least)) {
      EXPECT_EQ(result.status, Status::infeasible);
      continue;
    }
    ++found;
    EXPECT_NEAR(result.objective() / task.sample_period, least, 1e-9) << result.message;
    Task free = task;
    for (Axis& axis : free.machine.axes) axis.force_speed.clear(), axis.force_speed_max = unlimited;
    if (design_exact(free).objective() < result.objective() * (1.0 - 1e-9)) ++bound;
    if (HasFailure()) break;
  }
  EXPECT_GT(found, test_support::tries(60) / 2);
  EXPECT_GT(bound, test_support::tries(60) / 4);
}

// Starts and stops alone: a curve that is flat is a largest force.
TEST(ForceSpeedCurve, AFlatOneIsALargestForce) {
  Axis axis;
  axis.mass = 50.0, axis.damping = 200.0, axis.jerk_max = 1000.0;
  Task curved = plane_task(axis, plane_corner("A", 100.0, 10.0, 0.1, 0.1), 60e-6), flat = curved;
  for (Axis& x : flat.machine.axes) x.force_max = 300.0;
  for (Axis& x : curved.machine.axes) x.force_speed = {{0.05, 300.0}, {0.3, 300.0}}, x.force_speed_max = 300.0;
  const DesignResult result = design_exact(curved);
  expect_proved(curved, result);
  EXPECT_EQ(result.objective(), design_exact(flat).objective());
  // Nothing is allowed beyond the last speed.
  for (Axis& x : curved.machine.axes) x.force_speed = {{0.05, 300.0}, {0.09, 300.0}};
  const DesignResult none = design_exact(curved);
  EXPECT_EQ(none.status, Status::infeasible);
  EXPECT_TRUE(check_certificate(curved, none).accepted);
}

TEST(ForceSpeedCurve, AProofIsOfItsOwnCurve) {
  Axis axis;
  axis.mass = 50.0, axis.coulomb = 20.0, axis.jerk_max = 1000.0;
  axis.force_speed = {{0.0, 400.0}, {0.05, 350.0}, {0.15, 150.0}}, axis.force_speed_max = 400.0;
  Task task = plane_task(axis, plane_corner("A", 110.0, 10.0, 0.1, 0.1), 60e-6);
  const DesignResult result = design_exact(task);
  ASSERT_TRUE(result.filter);
  Task forged = task;
  for (Axis& x : forged.machine.axes) x.force_speed[1].force = 390.0, x.force_speed[2].force = 200.0;
  EXPECT_FALSE(check_certificate(forged, result).accepted);
}

}  // namespace
}  // namespace accdec
