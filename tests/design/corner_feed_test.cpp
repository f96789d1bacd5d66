#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "settings_brute_force.hpp"
#include "support/tasks.hpp"

// Corners that a control passes at a part of the feed.

namespace accdec {
namespace {

using accdec::testing::brute_force;
using accdec::testing::random_task;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One corner of 90 degrees at 50 mm/s, 1 ms, and averages of at most this order.
Task right_angle(double error_max_um, int order_max, const std::string& delays) {
  return parse_task(
      "title = \"corner feed\"\nsample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\norder_max = " +
          std::to_string(order_max) + "\n[controller]\ndelays = [" + delays +
          "]\n[machine]\n[[axis]]\nacceleration_max_mm_s2 = 4600\n[[corner]]\nname = \"P0\"\nangle_deg = 90\n"
          "feed_in_mm_min = 3000\nerror_max_um = " +
          std::to_string(error_max_um) + "\n",
      "task.toml");
}

DesignResult designed(const Task& task) {
  DesignResult result = design_task(task);
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  return result;
}

/// The corner error of 11 equal taps without delay, v T cos(45 deg) E|i - 5| = 96.4 um.
const double error_at_feed = 0.05 * 1e-3 * std::sqrt(0.5) * 30.0 / 11.0;

/// An average of 11 samples is the shortest that holds v/(L T) <= 4.6 m/s^2. At part f the error is f times that at
/// feed, and 2 (N + 2) (1 - f) samples are lost.
TEST(CornerFeed, IsTheLargestPartThatHoldsTheToleranceByFormula) {
  const DesignResult result = designed(right_angle(1e6 * error_at_feed * 0.72, 30, "\"corner-feed\""));
  ASSERT_EQ(result.corners.size(), 1u);
  EXPECT_EQ(result.filter->order(), 10);
  EXPECT_EQ(result.corners[0].delay, 0);
  EXPECT_NEAR(result.corners[0].feed_part, 0.70, 1e-12);
  EXPECT_NEAR(result.corners[0].corner_error, 0.70 * error_at_feed, 1e-12);
  EXPECT_NEAR(result.objective(), (11.0 + 2.0 * 12.0 * 0.3) * 1e-3, 1e-12);
  EXPECT_NEAR(result.corners[0].corner_time, result.objective(), 1e-15);
  EXPECT_THAT(settings_answer(result), HasSubstr("corner-feed at corner P0 (70 % of the feed, 2100 mm/min, from "
                                                 "0.42 mm before to 0.42 mm behind it)"));
  // N + 2 samples are not the fastest stretch: what is proved says so.
  EXPECT_THAT(settings_answer(result),
              HasSubstr("proved best for this family with corner feeds that last until the motion has settled"));
  EXPECT_THAT(settings_answer(result), HasSubstr(" has settled. The 12 samples at the corner feed, before and behind"));
  EXPECT_THAT(verify_result(result).proof, HasSubstr("each corner feed lasts until the motion has settled"));
}

/// An exact stop costs N samples, a corner feed more than that below about half the feed.
TEST(CornerFeed, IsTakenWhereItIsFasterThanAStop) {
  const auto kind = [&](double part) {
    return designed(right_angle(1e6 * error_at_feed * part, 12, "\"exact-stop\", \"corner-feed\""))
        .settings->delays.at(0);
  };
  EXPECT_EQ(kind(0.8), DelayKind::corner_feed);
  EXPECT_EQ(kind(0.2), DelayKind::exact_stop);
}

TEST(CornerFeed, IsTheBestOfAllByBruteForce) {
  const std::vector<std::vector<DelayKind>> kinds{{DelayKind::corner_feed},
                                                  {DelayKind::continuous, DelayKind::corner_feed},
                                                  {DelayKind::exact_stop, DelayKind::corner_feed},
                                                  {DelayKind::in_position, DelayKind::corner_feed}};
  std::mt19937 rng(2626);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int slowed = 0;
  for (int i = 0; i < 24; ++i) {
    Task task = random_task(rng, 1 + i % 2);
    task.design.order_max = 20;
    task.design.runs = 0.5 + u(rng);
    task.settings.emplace();
    task.settings->families = {SettingFamily::averages};
    task.settings->stages.resize(2);
    task.settings->delays = kinds[static_cast<std::size_t>(i) % kinds.size()];
    task.settings->corner_feed_step = i % 3 == 0 ? 0.1 : 0.07;
    for (TaskCorner& corner : task.corners) corner.error_max = 2.0 * *corner.error_max, corner.speed_min *= 0.3;
    for (Axis& axis : task.machine.axes) {
      axis.acceleration_max *= 2.0, axis.jerk_max *= 2.0, axis.power_max *= 2.0, axis.regeneration_max *= 2.0;
      if (i % 5 == 4) axis.servo_gain = 0.5 / task.sample_period, axis.velocity_feedforward = 0.8;
    }
    if (i % 4 == 1) task.machine.prefilter_taps = {0.25, 0.5, 0.25};
    const std::string what = "task " + std::to_string(i);
    const double expected = brute_force(task);
    const DesignResult result = design_task(task);
    if (std::isinf(expected)) {
      EXPECT_EQ(result.status, Status::infeasible) << what << ": " << result.message;
    } else {
      ASSERT_EQ(result.status, Status::optimal) << what << ": " << result.message;
      EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-6) << what;
      for (const CornerResult& corner : result.corners) slowed += corner.feed_part < 1.0 ? 1 : 0;
    }
    EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << what;
  }
  EXPECT_GE(slowed, 6);
}

/// Written and read again, the result and its proof still hold. Forged parts are refused.
TEST(CornerFeed, IsInTheResultFile) {
  const Task task = right_angle(60.0, 30, "\"corner-feed\"");
  const DesignResult result = designed(task), again = parse_result(result_to_json(result), "result.json");
  EXPECT_EQ(again.corners[0].feed_part, result.corners[0].feed_part);
  EXPECT_THAT(verify_result(again).reasons, IsEmpty());
  EXPECT_EQ(parse_task(task_to_toml(task), "again.toml").settings->corner_feed_step, task.settings->corner_feed_step);
  for (const double part : {1.0, 0.75, 0.5, 0.63, 0.0, -0.5, 1.5}) {
    DesignResult forged = again;
    forged.corners[0].feed_part = part;
    EXPECT_FALSE(verify_result(forged).accepted) << part;
  }
  DesignResult renamed = again;
  renamed.settings->delays[0] = DelayKind::continuous;
  EXPECT_FALSE(verify_result(renamed).accepted);
}

TEST(CornerFeed, IsAPartAboveZeroForEveryCorner) {
  const Task task = right_angle(60.0, 30, "\"corner-feed\"");
  const Filter filter = make_filter({.kind = Shape::boxcar, .order = 10});
  EXPECT_TRUE(verify_by_simulation(task, filter, {0}, nullptr, nullptr, {0.1}).feasible);
  EXPECT_THROW(verify_by_simulation(task, filter, {0}, nullptr, nullptr, {0.0}), std::invalid_argument);
  EXPECT_THROW(verify_by_simulation(task, filter, {0}, nullptr, nullptr, {1.1}), std::invalid_argument);
  EXPECT_THROW(verify_by_simulation(task, filter, {0}, nullptr, nullptr, {0.5, 0.5}), std::invalid_argument);
}

TEST(CornerFeed, KeyIsRefusedWhereItIsOfNoUse) {
  const auto read = [](const std::string& controller) {
    parse_task("sample_period_ms = 1\n[design]\nfamily = \"averages\"\n[controller]\n" + controller +
                   "\n[machine]\n[[axis]]\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 3000\n",
               "task.toml");
  };
  const auto message = [&](const std::string& controller) -> std::string {
    try {
      read(controller);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("delays = [\"corner-feed\"]\ncorner_feed_step = 0.1"), "");
  EXPECT_THAT(message("delays = [\"dwell\"]\ncorner_feed_step = 0.1"),
              HasSubstr("goes with delays = [\"corner-feed\"]"));
  EXPECT_THAT(message("delays = [\"corner-feed\"]\ncorner_feed_step = 0"), HasSubstr("task.toml:6"));
  EXPECT_THAT(message("delays = [\"corner-feed\"]\ncorner_feed_step = 0.6"), HasSubstr("task.toml:6"));
  EXPECT_THAT(message("delays = [\"corner-fed\"]"), HasSubstr("corner-feed"));
}

}  // namespace
}  // namespace accdec
