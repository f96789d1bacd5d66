#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/certificate/family_members.hpp>
#include <accdec/certificate/refuted_outlines.hpp>
#include <accdec/filter.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// One corner along the axes, so that starts and stops are all that the delay of an exact stop leaves.
Task task_of(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task;
  Axis axis;
  axis.acceleration_max = 1.0 + 4.0 * u(rng);
  axis.jerk_max = 20.0 + 200.0 * u(rng);
  axis.name = "x";
  task.machine.axes.push_back(axis);
  axis.name = "y";
  task.machine.axes.push_back(axis);
  task.corners.emplace_back("A", PlanarLegs{2.0, 0.3}, 0.1, 0.05 + 0.1 * u(rng));
  Mode mode;
  mode.frequency_low = 20.0 + 20.0 * u(rng);
  mode.frequency_high = mode.frequency_low + 4.0 * u(rng);
  if (rng() % 2 == 0) mode.damping_low = 0.01, mode.damping_high = 0.05 + 0.1 * u(rng);
  mode.residual_max = 0.05 + 0.4 * u(rng);
  if (rng() % 3 != 0) task.machine.modes.push_back(mode);
  return task;
}

std::vector<double> taps_of(const std::vector<int>& lengths,
                            const std::vector<std::pair<std::size_t, double>>& impulses) {
  std::vector<double> taps(impulses.back().first + 1, 0.0);
  for (const auto& [at, weight] : impulses) taps[at] += weight;
  for (const int length : lengths) {
    std::vector<double> next(taps.size() + static_cast<std::size_t>(length) - 1, 0.0);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      for (int j = 0; j < length; ++j) next[i + static_cast<std::size_t>(j)] += taps[i];
    }
    taps = std::move(next);
  }
  return taps;
}

/// A member that its lengths refute breaks a limit in simulation, with the legs apart.
TEST(RefutedOutlines, BreakALimit) {
  std::mt19937 rng(26);
  int refuted = 0, passed = 0;
  for (int i = 0; i < 60; ++i) {
    const Task task = task_of(rng);
    const RefutedOutlines outlines(granted_limits(task), CheckedResponse(task), 400);
    for (int m = 0; m < 100; ++m) {
      std::vector<int> lengths;
      for (int s = static_cast<int>(rng() % 3); s >= 0; --s) lengths.push_back(1 + static_cast<int>(rng() % 60));
      std::vector<std::pair<std::size_t, double>> impulses{{0, 1.0}};
      if (m % 3 > 0) impulses.emplace_back(1 + rng() % 30, m % 3 == 1 ? 1.0 : 0.4);
      if (m % 3 == 2) impulses.emplace_back(impulses.back().first + 1, 0.6);
      if (m % 6 == 2) impulses.emplace_back(2 * impulses.back().first, 1.0);
      const char* const rule = outlines.rule({lengths, impulses});
      if (rule == nullptr) {
        ++passed;
        continue;
      }
      ++refuted;
      const Filter filter(taps_of(lengths, impulses));
      const VerificationReport report = verify_by_simulation(task, filter, {filter.order() + 1});
      EXPECT_FALSE(report.feasible) << rule << ": " << report.worst;
    }
  }
  EXPECT_GT(refuted, 1000);
  EXPECT_GT(passed, 100);
}

}  // namespace
}  // namespace accdec
