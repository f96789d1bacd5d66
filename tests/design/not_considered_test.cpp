#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/task.hpp>

#include "support/paths.hpp"

// A result without modes leaves out vibration: the figure of lib/accdec/THEORY.md, from a simulation of its own.

namespace accdec {
namespace {

/// Positions of a leg of one second that stops, at samples: velocity v through the filter, summed.
std::vector<double> positions(const Filter& filter, double v, double period) {
  std::vector<double> positions{0.0};
  for (int k = 0; k < 1400; ++k) {
    double velocity = 0.0;
    for (int i = 0; i <= filter.order(); ++i) velocity += k - i >= 0 && k - i < 1000 ? filter.tap(i) * v : 0.0;
    positions.push_back(positions.back() + velocity * period);
  }
  return positions;
}

/// By how much y'' = w^2 (u - y) - 2 z w y' passes the end of u, which is straight between samples. Runge-Kutta.
double overshoot(const std::vector<double>& u, double period, double frequency, double damping) {
  const double w = 2.0 * std::numbers::pi * frequency;
  constexpr int parts = 20;
  const double h = period / parts;
  double y = 0.0, v = 0.0, most = 0.0;
  const auto pull = [&](double at, double y_, double v_) { return w * w * (at - y_) - 2.0 * damping * w * v_; };
  for (std::size_t k = 0; k + 1 < u.size(); ++k) {
    for (int i = 0; i < parts; ++i) {
      const auto command = [&](double part) { return u[k] + (u[k + 1] - u[k]) * (i + part) / parts; };
      const double a1 = pull(command(0.0), y, v);
      const double v2 = v + 0.5 * h * a1, a2 = pull(command(0.5), y + 0.5 * h * v, v2);
      const double v3 = v + 0.5 * h * a2, a3 = pull(command(0.5), y + 0.5 * h * v2, v3);
      const double v4 = v + h * a3, a4 = pull(command(1.0), y + h * v3, v4);
      y += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      most = std::max(most, y - u.back());
    }
  }
  return most;
}

TEST(NotConsidered, AModeOvershootsByMoreThanTheTolerance) {
  const Task task = read_task(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::optimal);
  const double found = overshoot(positions(*result.filter, 0.1, task.sample_period), task.sample_period, 40.0, 0.02);
  EXPECT_NEAR(found, 94e-6, 0.5e-6);
  EXPECT_GT(found, *task.corners[0].error_max);
}

}  // namespace
}  // namespace accdec
