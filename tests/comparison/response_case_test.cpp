#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/design.hpp>
#include <accdec/instances/instance.hpp>
#include <accdec/nlp/violation.hpp>
#include <accdec/solver.hpp>

#include "support/tasks.hpp"

// Comparison problems behind a servo, with contours and with modes of axes.

namespace accdec::comparison {
namespace {

using ::testing::HasSubstr;

/// One corner along the axes at 0.1 m/s, acceleration such that a filter of 41 taps must be a boxcar.
CaseSpec boxcar_only(int delay) {
  Axis axis;
  axis.acceleration_max = 0.1 / 41e-3;
  CaseSpec spec;
  spec.name = "boxcar";
  spec.task = accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", 90.0, 0.0, 0.1, 0.1), 100e-6);
  spec.order = 40;
  spec.delays = {delay};
  return spec;
}

/// Way left at sample k of a stop behind a boxcar of 41 taps and a loop of this gain, in full-speed samples. The loop
/// is followed sample by sample: its following error falls by a in each.
double left_of(int k, double gain) {
  const double x = gain * 1e-3, a = std::exp(-x), lag = (1.0 - a) / x;
  double error = 1.0 / x, way = 0.0;  // behind the command: at steady feed to begin with
  for (int i = 1; i <= k; ++i) error = a * error + lag * std::max(0.0, 1.0 - i / 41.0);
  for (int i = k + 1; i <= 41; ++i) way += 1.0 - i / 41.0;
  return way + error;
}

TEST(ResponseCase, TheOnlyFilterErrsAsTheLoopDoes) {
  for (const double gain : {100.0, 300.0}) {
    CaseSpec spec = boxcar_only(12);
    for (Axis& axis : spec.task.machine.axes) axis.servo_gain = gain;
    const ComparisonCase subject(spec);
    const int k = subject.samples().front();
    // Gone of leg 2: all of its way less what is left of a stop at that sample.
    const double to_go = left_of(k, gain);
    const double lag = 20.0 + 1.0 / (gain * 1e-3);  // samples behind the command at steady feed
    const double gone = (k - 12) - lag + left_of(k - 12, gain);
    const double error = 0.1e-3 * std::hypot(to_go, gone), sigma = std::pow(error / 100e-6, 2);
    for (const bool reduced : {false, true}) {
      const auto result = solvers::find_solver("ipopt").solve(*subject.problem(reduced), subject.start(reduced, 0, 1));
      EXPECT_NEAR(result.verification.objective, sigma, 1e-5 * std::max(1.0, sigma)) << gain;
    }
    const Reference reference = reference_of(subject, 1.0);
    EXPECT_EQ(reference.proof, Reference::Proof::bound);
    EXPECT_EQ(reference.lower, 0.0);
    EXPECT_THAT(reference.method, HasSubstr("no reference"));
  }
}

// At a symmetric apex of 90 degrees the contour is the error times sin 45 deg. The error is
// 2 v T cos 45 deg m (m + 1)/2/41 with m = 20 - d/2.
TEST(ResponseCase, ContoursBindAtTheClosedForm) {
  const double error = 2.0 * 0.1e-3 * std::sqrt(0.5) * 14 * 15 / 2.0 / 41;
  for (const double part : {1.01, 0.99}) {
    CaseSpec spec = boxcar_only(12);
    spec.task.corners.front().contour_max = part * error * std::sqrt(0.5);
    const ComparisonCase subject(spec);
    const auto result = solvers::find_solver("ipopt").solve(*subject.problem(false), subject.start(false, 0, 1));
    EXPECT_EQ(result.verification.verdict != solvers::Verdict::infeasible, part > 1.0) << part;
  }
}

/// The rows hold of a verified design, and no longer if its mode allows less than the design leaves.
TEST(ResponseCase, RowsOfModesOfAxesAreThoseOfTheVerifier) {
  Axis axis;
  axis.acceleration_max = 6.0, axis.jerk_max = 500.0, axis.servo_gain = 200.0;
  Task task = accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", 95.0, 20.0, 0.1, 0.1), 50e-6);
  Mode mode;
  mode.axis = 0, mode.residual_max = 1.0, mode.frequency_low = mode.frequency_high = 40.0;
  mode.damping_low = mode.damping_high = 0.02, mode.displacement_max = 30e-6;
  task.machine.modes = {mode};
  DesignOptions options;
  options.time_limit = 5.0;
  const DesignResult design = design_task(task, options);
  ASSERT_TRUE(design.has_design()) << design.message;
  double left = 0.0;
  for (const LimitUse& use : design.limits) left = use.kind == LimitKind::residual ? std::max(left, use.value) : left;
  for (const double part : {1.0001, 0.99}) {
    CaseSpec spec;
    spec.task = task;
    spec.task.machine.modes.front().displacement_max = part * left;
    spec.order = design.filter->order();
    spec.delays = {design.corners.front().delay};
    const ComparisonCase subject(spec);
    const auto* problem = dynamic_cast<const MarginProblem*>(subject.problem(false));
    ASSERT_NE(problem, nullptr);
    EXPECT_EQ(nlp::largest_violation(*problem, problem->start_from(*design.filter)) < 1e-5, part > 1.0) << part;
  }
}

TEST(ResponseCase, WhatFilesCannotSayIsRefusedByName) {
  CaseSpec spec = boxcar_only(12);
  EXPECT_NO_THROW(instances::choice_of(spec.task, 20));
  const auto refused = [](const Task& task, const std::string& named) {
    try {
      instances::choice_of(task, 20);
      ADD_FAILURE() << named;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(named));
    }
  };
  Task contour = spec.task;
  contour.corners.front().contour_max = 50e-6;
  refused(contour, "contour_max_um");
  for (Axis& axis : spec.task.machine.axes) axis.servo_gain = 200.0;
  refused(spec.task, "servo");
  spec.question = Question::delay;
  const ComparisonCase subject(spec);
  const auto& problem = dynamic_cast<const QuadraticProblem&>(*subject.problem(false));
  EXPECT_THROW(instances::instance_of(problem, subject.start(false, 0, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace accdec::comparison
