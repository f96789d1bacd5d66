#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/plan/run/fixed_plan.hpp>

#include "corner_program.hpp"
#include "program_command.hpp"

// The in-position width of a program is the best of all that differ. Here every width is tried with corners by
// themselves, by the formulas of the model.

namespace accdec {
namespace {

constexpr double period = 1e-3;

/// 1 + 2 + ... + n.
double sum_to(int n) {
  return n > 0 ? 0.5 * n * (n + 1) : 0.0;
}

/// One average on two axes, legs longer than it.
struct Corners {
  std::vector<Eigen::Vector2d> velocity;  // m/s, of each leg in whole samples
  double moving = 0.0;                    // samples
  double tolerance = 0.0, acceleration = 0.0;
  bool by_axis = false;
  int latency = 0;  // samples

  void add_leg(double x, double y, double feed) {
    const Eigen::Vector2d way(x, y);
    // A leg that exceeds whole samples by a millionth is commanded in as many.
    const double samples = std::ceil(way.norm() / (feed * period) * (1.0 - 1e-6));
    velocity.push_back(way / (samples * period));
    moving += samples;
  }

  /// Whether the corner behind a leg holds with a delay: |S[k]| at the nearest sample, and all accelerations.
  bool holds(std::size_t leg, int length, int delay) const {
    const Eigen::Vector2d& in = velocity[leg];
    const Eigen::Vector2d& out = velocity[leg + 1];
    double error = unlimited, largest = 0.0;
    for (int k = 0; k <= length + delay; ++k) {
      // Samples that leg 1 has left and that leg 2 has gone, times the length.
      const double before = sum_to(length - 1 - k), behind = sum_to(k - delay) - sum_to(k - delay - length);
      error = std::min(error, (out * behind - in * before).norm() * period / length);
      const bool stops = k >= 1 && k <= length, starts = k > delay && k <= delay + length;
      const Eigen::Vector2d change = (starts ? out : Eigen::Vector2d::Zero().eval()) - (stops ? 1.0 : 0.0) * in;
      largest = std::max(largest, change.cwiseAbs().maxCoeff() / (length * period));
    }
    return error <= tolerance && largest <= acceleration;
  }

  double way_left(std::size_t leg, int length, int wait) const {
    const double watched = by_axis ? velocity[leg].cwiseAbs().maxCoeff() : velocity[leg].norm();
    return watched * period * sum_to(length - 1 - wait) / length;
  }

  /// Samples of the program with the best width for an average; unlimited if none holds.
  double least(int length) const {
    const std::size_t corners = velocity.size() - 1;
    std::vector<std::vector<bool>> held(corners);
    std::vector<double> widths{0.0};
    for (std::size_t j = 0; j < corners; ++j) {
      for (int d = 0; d < length; ++d) {
        held[j].push_back(holds(j, length, d + latency)), widths.push_back(way_left(j, length, d));
      }
    }
    std::sort(widths.begin(), widths.end());
    widths.push_back(2.0 * widths.back());
    double best = unlimited;
    for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
      if (widths[i + 1] - widths[i] < 1e-12) continue;
      const double width = 0.5 * (widths[i] + widths[i + 1]);
      double samples = moving + length;
      for (std::size_t j = 0; j < corners; ++j) {
        int d = 0;
        while (way_left(j, length, d) > width) ++d;
        samples += held[j][static_cast<std::size_t>(d)] ? d + latency : unlimited;
      }
      best = std::min(best, samples);
    }
    return best;
  }
};

Task in_position_task(const Corners& corners, int longest) {
  Task task = test::averages_task(1, {DelayKind::in_position});
  task.design.order_max = longest - 1;
  task.settings->in_position_by_axis = corners.by_axis;
  task.settings->in_position_latency = corners.latency * period;
  for (Axis& axis : task.machine.axes) axis.velocity_max = unlimited, axis.acceleration_max = corners.acceleration;
  return task;
}

/// Plans it as `program --feeds keep` does, which verifies the plan. @return samples
double planned(const Task& task, const std::string& text) {
  const TemporaryFolder folder;
  ProgramFileOptions options;
  options.fixed.feeds = Feeds::keep;
  options.fixed.filter_bound = false;
  ProgramFile file = read_program_file(folder.write("part.ngc", text), task, options, {});
  const ProgramResult result = run_fixed_plan(file, task, options, {});
  EXPECT_TRUE(result.verification.feasible) << result.message;
  EXPECT_TRUE(result.settings && result.settings->complete);
  return result.verification.feasible ? result.cycle_time / task.sample_period : unlimited;
}

/// Only waits of a few samples less than the filter's order hold such tolerances.
TEST(InPositionWidths, TheWidestThatHoldsIsFoundHoweverNarrow) {
  for (const double tolerance : {3e-6, 10e-6, 20e-6}) {
    for (const int length : {40, 45, 60, 80}) {
      Corners corners;
      corners.tolerance = tolerance, corners.acceleration = 5.0 * (1.0 + 1e-9);
      corners.add_leg(4.0, 0.0, 0.2), corners.add_leg(0.0, 4.0, 0.2);
      Task task = in_position_task(corners, length);
      task.design.order_min = length - 1;
      EXPECT_EQ(planned(task, fmt::format("G21 G90 G64 P{}\nG1 X4000 F12000\nY4000\nM2\n", 1e3 * tolerance)),
                corners.least(length))
          << length << " ms, " << tolerance << " m";
    }
  }
}

/// Two fast legs and many slow ones. The best width lies between two that change a wait of the slow ones alone.
TEST(InPositionWidths, TheWaysOfSlowLegsAreTried) {
  Corners corners;
  corners.tolerance = 10e-6, corners.acceleration = 5.0 * (1.0 + 1e-9);
  std::string text = "G21 G90 G64 P0.01\nG1 X400 F12000\nY400\nF600\n";
  corners.add_leg(0.4, 0.0, 0.2), corners.add_leg(0.0, 0.4, 0.2);
  for (int i = 1; i <= 20; ++i) {
    text += fmt::format("X{}\nY{}\n", 400 + i, 400 + i);
    corners.add_leg(1e-3, 0.0, 0.01), corners.add_leg(0.0, 1e-3, 0.01);
  }
  double least = unlimited;
  for (int length = 1; length <= 42; ++length) least = std::min(least, corners.least(length));
  EXPECT_EQ(planned(in_position_task(corners, 42), text + "M2\n"), least);
}

/// Each leg has a heading of its own, so that the fastest axis of each has another way left.
TEST(InPositionWidths, TheWaysOfAllHeadingsAreTried) {
  Corners corners;
  corners.tolerance = 76.57e-6, corners.acceleration = 9.72, corners.by_axis = true;
  std::string text = "G21 G90 G64 P0.07657\nG1 F6000\n";
  double x = 0.0, y = 0.0;
  for (const auto& [to_x, to_y] : {std::pair(18.53794, -33.400371),
                                   {15.490868, -57.407773},
                                   {0.439559, -74.799096},
                                   {-5.144873, -103.663852},
                                   {-36.718962, -89.031119}}) {
    text += fmt::format("X{} Y{}\n", to_x, to_y);
    corners.add_leg(1e-3 * (to_x - x), 1e-3 * (to_y - y), 0.1);
    x = to_x, y = to_y;
  }
  for (const int latency : {0, 1, 4, 12}) {
    corners.latency = latency;
    double least = unlimited;
    for (int length = 1; length <= 30; ++length) least = std::min(least, corners.least(length));
    EXPECT_EQ(planned(in_position_task(corners, 30), text + "M2\n"), least) << latency;
  }
}

}  // namespace
}  // namespace accdec
