#include <complex>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/design.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/standard_shapes.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"

// How design_task goes about a task whose proof is too large, does not end, or hangs on order_max.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Task straight_start(int order_max, const char* more = "") {
  // 0.1 m/s at 1 m/s^2 and 1 ms: a tap is at most 0.01, so that 100 taps, order 99, are needed and enough.
  return parse_task(fmt::format(R"(sample_period_ms = 1.0
[design]
order_max = {}
[[axis]]
acceleration_max_mm_s2 = 1000
[[corner]]
angle_deg = 90
feed_in_mm_min = 6000
{})",
                                order_max, more),
                    "task.toml");
}

TEST(DesignTask, EveryRunOfTheExactMethodGetsTheOptions) {
  DesignOptions options;
  options.exact.threads = 3;
  options.exact.gap = 0.25;
  options.exact.certificate = false;
  const ExactOptions exact = exact_options(options, 7.0);
  EXPECT_EQ(exact.threads, 3);
  EXPECT_EQ(exact.gap, 0.25);
  EXPECT_FALSE(exact.certificate);
  EXPECT_EQ(exact.time_limit, 7.0);
}

TEST(DesignTask, InfeasibleForItsOrderNamesTheKeyAndALongerFilter) {
  const DesignResult result = design_task(straight_start(40, "error_max_um = 50\n"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("no filter of order 40 or less ([design] order_max) holds together"));
  EXPECT_THAT(result.message, HasSubstr("with [design] order_max = 99 there is a verified design"));
  EXPECT_EQ(design_task(straight_start(99, "error_max_um = 50\n")).status, Status::optimal) << "as the message says";
  EXPECT_EQ(design_task(straight_start(98, "error_max_um = 50\n")).status, Status::infeasible);
}

TEST(DesignTask, InfeasibleForEveryOrderDoesNotPromiseALongerFilter) {
  // Without delay the corner is cut by about v T (taps)/4 at least, far more than 1 um, by every filter that holds the
  // acceleration; longer ones cut more.
  const DesignResult result = design_task(straight_start(120, "error_max_um = 1\ndelay_samples = 0\n"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, Not(HasSubstr("there is a verified design")));
}

TEST(DesignTask, WhereTheProofWouldNotFitAStandardShapeIsVerified) {
  Task task = straight_start(20'000, "error_max_um = 50\n");
  task.design.order_min = 20'000;
  task.machine.axes[0].jerk_max = task.machine.axes[1].jerk_max = 500.0;
  DesignOptions options;
  options.time_limit = 20.0;
  const DesignResult result = design_task(task, options);
  EXPECT_EQ(result.status, Status::feasible) << result.message;
  EXPECT_THAT(result.message, HasSubstr("GB"));
  EXPECT_FALSE(result.lower_bound);
  EXPECT_TRUE(verify_result(result).accepted);
}

// No boxcar, trapezoid, Hann or Blackman window of 400 taps leaves so little of a band; Kaiser's does.
TEST(BestShape, LeavesATenMillionthOfABand) {
  Task task = parse_task(R"(sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
[[mode]]
frequency_Hz = [20, 30]
residual_max = 1e-7
[[corner]]
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
)",
                         "task.toml");
  const auto result = best_standard_shape(task, 30.0);
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(verify_result(*result).accepted);
  // The sum over the taps at a frequency of the band, term by term.
  for (const double frequency : {20.0, 23.7, 30.0}) {
    std::complex<double> sum = 0.0;
    for (int i = 0; i <= result->filter->order(); ++i)
      sum += result->filter->tap(i) * std::polar(1.0, -2.0 * std::numbers::pi * frequency * i * 1e-3);
    EXPECT_LE(std::abs(sum), 1e-7 * (1.0 + 1e-6));
  }
}

// To reach 1 m/s with a jerk of 0.4 m/s^3 takes 2 sqrt(1 / 0.4) s. With 20 m/s^3 it takes a seventh of that. These are
// 3162 and 447 samples.
TEST(DesignTask, WhatALargerOrderMaxDoesIsSaid) {
  const auto message = [](double jerk) {
    Task task = straight_start(100);
    task.corners[0].set_feeds(1.0, 1.0);
    task.machine.axes[0].acceleration_max = task.machine.axes[1].acceleration_max = unlimited;
    task.machine.axes[0].jerk_max = task.machine.axes[1].jerk_max = jerk;
    const DesignResult result = design_task(task);
    EXPECT_EQ(result.status, Status::infeasible);
    return result.message;
  };
  EXPECT_THAT(message(0.4), HasSubstr("with order_max = 800 there is none either, a larger one was not tried"));
  EXPECT_THAT(message(20.0), HasSubstr("a longer filter does: with [design] order_max = 4"));
}

TEST(DesignTask, ProgrammesAreEstimatedBeforeTheyAreBuilt) {
  Task task = straight_start(400);
  task.machine.axes[0].jerk_max = 500.0;
  // The dense tableau alone has a row and a column a tap.
  for (const int order : {100, 1000, 20'000}) {
    const double tableau = 8.0 * (order + 1.0) * (order + 1.0);
    EXPECT_GT(exact::linear_program_bytes(task, order), tableau);
    EXPECT_LT(exact::linear_program_bytes(task, order), 4.0 * tableau);
  }
  EXPECT_NO_THROW(exact::require_room(task, 1000));
  EXPECT_THROW(exact::require_room(task, 1'000'000), exact::TooLarge);
}

// Power and regeneration keep the exact method from a bound for a while; the other limits give one at once. 74 ms is
// the proved optimum of this task (results/README.md).
TEST(DesignTask, StoppedEarlyItStillStatesABoundThatIsAccepted) {
  const Task task = read_task(test_support::source_folder() + "/problems/corner/regeneration.toml");
  DesignOptions options;
  options.time_limit = 0.5;
  const DesignResult result = design_task(task, options);
  ASSERT_TRUE(result.status == Status::feasible || result.status == Status::optimal) << result.message;
  EXPECT_GE(result.objective(), 0.074 - 1e-9);
  if (result.lower_bound) {
    EXPECT_LE(*result.lower_bound, 0.074 + 1e-9);
    EXPECT_TRUE(result.gap.has_value());
  }
  EXPECT_THAT(verify_result(result).reasons, ::testing::IsEmpty());
}

TEST(DesignTask, SeveralCornersAreNeverWorseThanALocalSolverAlone) {
  const Task task = read_task(test_support::source_folder() + "/problems/machine/three-corners.toml");
  DesignOptions options;
  options.time_limit = 20.0;
  const DesignResult best = design_task(task, options);
  options.method = Method::nlp;
  for (const char* solver : {"nlopt-slsqp", "ipopt"}) {
    options.nlp.solver = solver;
    options.time_limit = 5.0;
    const DesignResult alone = design_task(task, options);
    if (alone.status == Status::feasible) {
      EXPECT_LE(best.objective(), alone.objective() * (1.0 + 1e-9)) << solver;
    }
  }
}

Task many_corners(int count) {
  std::string corners;
  for (int j = 0; j < count; ++j)
    corners +=
        fmt::format("[[corner]]\nangle_deg = {}\nfeed_in_mm_min = 3000\nerror_max_um = {}\n", 40 + j % 100, 30 + j);
  return parse_task(
      "sample_period_ms = 1.0\n[design]\norder_max = 60\n[[axis]]\nacceleration_max_mm_s2 = 6000\n" + corners,
      "task.toml");
}

// The local solver that is tried first takes 4000 variables; more corners than it takes once ended the design.
TEST(DesignTask, ASolverThatRefusesDoesNotEndTheDesign) {
  DesignOptions options;
  options.time_limit = 2.0;
  const DesignResult result = design_task(many_corners(1100), options);
  EXPECT_TRUE(result.verification.feasible) << result.message;
}

// Steps that would take longer than the time limit leaves room for are not begun.
TEST(DesignTask, StepsThatWouldTakeTooLongAreNotBegun) {
  DesignOptions options;
  options.method = Method::nlp;
  options.nlp.solver = "ipopt";
  options.time_limit = 1.0;
  const DesignResult result = design_nlp(many_corners(20'000), options);
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_EQ(result.stop, StopReason::time_limit);
  EXPECT_THAT(result.message, HasSubstr("a step of a local solver on 20000 corners"));
  // A dense factorisation of as many rows and variables as taps: memory or hours.
  options.nlp.solver = "ceres-al";
  options.time_limit = 300.0;  // the refusal comes before
  Task task = straight_start(20'000, "error_max_um = 50\n");
  task.design.order_min = 20'000;
  EXPECT_THROW(design_task(task, options), std::invalid_argument);
}

// A heavy corner once drew the exact method away from the light one, and left it far behind the local solvers.
TEST(DesignTask, UnequalWeightsAreNoWorseThanForLocalSolvers) {
  const Task task = parse_task(R"(sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
weight = 1000
[[corner]]
angle_deg = 40
feed_in_mm_min = 5000
error_max_um = 10
)",
                               "task.toml");
  const DesignResult result = design_task(task);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_TRUE(verify_result(result).accepted);
  DesignOptions local;
  local.method = Method::nlp;
  local.nlp.solver = "nlopt-slsqp";
  const DesignResult other = design_task(task, local);
  ASSERT_TRUE(other.has_design()) << other.message;
  EXPECT_LE(result.objective(), other.objective());
}

TEST(DesignTask, StoppedWithoutADesignItSaysOnceWhatIsProved) {
  DesignOptions options;
  options.time_limit = 1.0;
  std::string told;
  options.progress = [&](const std::string& line) { told += line + "\n"; };
  const DesignResult result =
      design_task(parse_task("sample_period_ms = 1.0\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = "
                             "500000\n[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = "
                             "50\n[[mode]]\nfrequency_Hz = [38, 46]\nresidual_max = 1e-12\n",
                             "task.toml"),
                  options);
  ASSERT_FALSE(result.filter) << "a faster machine: choose a harder task";
  const std::string& message = result.message;
  EXPECT_EQ(message.find("stopped"), message.rfind("stopped")) << message;
  EXPECT_THAT(message, HasSubstr("proved"));
  EXPECT_THAT(told, Not(HasSubstr("inf")));
}

TEST(DesignTask, NumbersOfTheTaskAreToldAsTheyWereGiven) {
  const DesignResult result = design_task(parse_task(
      "sample_period_ms = 1.0\n[[axis]]\nmass_kg = 1\ndamping_N_s_m = 100000\nforce_max_N = 2047.335\n[[corner]]\n"
      "angle_deg = 95\nfeed_in_mm_min = 6000.25\nerror_max_um = 50\n",
      "task.toml"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("the limit is 2047.335 N"));
}

}  // namespace
}  // namespace accdec
