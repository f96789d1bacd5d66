#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/study/baseline_table.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using study::BaselineTable;
using ::testing::HasSubstr;

/// A gantry that rings, at 4 ms: few enough filters to try them all.
Task ringing_gantry() {
  Axis axis;
  axis.acceleration_max = 1.5;
  axis.jerk_max = 100.0;
  Task task = testing::plane_task(axis, testing::plane_corner("edge", 90, 0, 0.1, 0.1), 100e-6);
  task.sample_period = 4e-3;
  task.machine.modes.push_back({18.0, 24.0, 0.1});
  FilterSpec today;
  today.kind = Shape::trapezoid;
  today.order = 32;
  today.ramp = 13;
  task.baseline = today;
  return task;
}

/// The least time of every member, each with the delays found for it.
double least_time(const Task& task, int pairs) {
  double least = unlimited;
  FilterSpec spec;
  spec.kind = Shape::trapezoid;
  spec.pairs = pairs;
  const int longest = 45;
  for (spec.order = 0; spec.order <= longest; ++spec.order) {
    for (spec.ramp = 0; spec.ramp <= spec.order / 2; ++spec.ramp) {
      for (spec.pair_delay = std::min(1, pairs); pairs * spec.pair_delay + spec.order <= longest; ++spec.pair_delay) {
        Task given = task;
        given.filter = spec;
        if (const DesignResult result = design_delays(given); result.filter)
          least = std::min(least, result.objective());
        if (pairs == 0) break;
      }
    }
  }
  return least;
}

TEST(Savings, StepsAreThoseOfAllMembersTried) {
  const Task task = ringing_gantry();
  const BaselineTable table = study::compare_with_baselines(task, DesignOptions{});
  const auto saved = study::savings(table);
  ASSERT_TRUE(saved && saved->by_retuning && saved->by_family && saved->by_taps);
  EXPECT_TRUE(saved->complete);
  Task given = task;
  given.filter = task.baseline;
  const double today = design_delays(given).objective(), retuned = least_time(task, 0),
               with_pairs = least_time(task, 1);
  EXPECT_DOUBLE_EQ(saved->today, today);
  EXPECT_NEAR(*saved->by_retuning, today - retuned, 1e-12);
  EXPECT_GT(*saved->by_retuning, 0.0);
  // Two averages with a pair are one of the families.
  EXPECT_GE(*saved->by_family, retuned - with_pairs - 1e-12);
  EXPECT_GE(*saved->by_taps, 0.0);
  EXPECT_NEAR(*saved->by_retuning + *saved->by_family + *saved->by_taps, saved->total, 1e-12);
  EXPECT_NEAR(saved->total, today - table.design.objective(), 1e-12);

  DesignResult design = table.design;
  design.savings = saved;
  const TemporaryFolder folder;
  const DesignResult again = read_result(folder.write("result.json", result_to_json(design)));
  ASSERT_TRUE(again.savings);
  EXPECT_EQ(again.savings->by_taps, saved->by_taps);
  EXPECT_EQ(again.savings->family, saved->family);
  EXPECT_TRUE(verify_result(again).accepted);
  *design.savings->by_taps += 1e-3;
  EXPECT_THAT(verify_result(design).reasons, ::testing::Contains(HasSubstr("savings, the sum of the parts")));
  *design.savings = *saved, design.savings->today += 1e-3;
  EXPECT_THAT(verify_result(design).reasons, ::testing::Contains(HasSubstr("savings.today_s")));
}

// Without families there is no split, and free taps are of no family to be retuned.
TEST(Savings, WhatWasNotSearchedIsNotSaid) {
  Task task = ringing_gantry();
  const DesignResult design = design_task(task);
  const BaselineTable own = study::compare_with_baselines(design, 0.0);
  const auto total = study::savings(own);
  ASSERT_TRUE(total);
  EXPECT_FALSE(total->by_retuning || total->by_family || total->by_taps);
  EXPECT_FALSE(total->complete);
  EXPECT_THAT(study::savings_text(own), ::testing::Not(HasSubstr("retuning")));

  Task taps = task;
  taps.baseline->kind = Shape::taps;
  const Filter same = make_filter(*task.baseline);
  taps.baseline->taps.assign(same.taps().begin(), same.taps().end());
  DesignResult of_taps = design;
  of_taps.task = taps;
  const auto saved = study::savings(study::compare_with_baselines(of_taps, 1e9));
  ASSERT_TRUE(saved && saved->by_family && saved->by_taps);
  EXPECT_FALSE(saved->by_retuning);
  EXPECT_NEAR(*saved->by_family + *saved->by_taps, total->total, 1e-12);
}

}  // namespace
}  // namespace accdec
