#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

// Refusals of tasks whose control has no setting that holds all limits.

namespace accdec {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// 100 mm/s at a right angle. An average of L ms takes 100/L m/s^2: 6 m/s^2 need 16.7. Without a delay it errs by
/// 70.7 um times the mean absolute deviation of its taps, (L^2 - 1)/(4 L) for an odd L: 200 um allow 11. With 14 the
/// nearest sample has (1 + .. + 7)/14 = 2 samples to go and (1 + .. + 6)/14 = 1.5 behind it. These 250 um are 125 % of
/// the bound, and the acceleration is 119 %. With 13 the acceleration is 128 %, with 15 the error 132 %.
/// Averages of 17 err by 141.4/17 um times the sum of max(i - 8 - d/2, 0): 203 um with d = 3, 174.7 um with d = 4.
TEST(SettingsRefused, NameTheSettingThatIsClosestWithTheDelaysOfTheControl) {
  const DesignResult result =
      design_task(parse_task("sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\n[controller]\ndelays "
                             "= \"continuous\"\n[[axis]]\n"
                             "acceleration_max_mm_s2 = 6000\n[[corner]]\nname = \"A\"\nangle_deg = 90\nfeed_in_mm_min "
                             "= 6000\nerror_max_um = 200\n",
                             "task"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("the closest, one average of 14 ms, breaks corner error: 125.0 %"));
  EXPECT_THAT(result.message, HasSubstr("one average of 17 ms, and a delay of 4 ms"));
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
}

/// A pole of 50 samples leaves 1e-4 of its step behind 460.5 samples. Orders up to 400 have room for 401/9.2103 = 43.5.
TEST(SettingsRefused, SayHowLongAPoleTheHighestOrderAllows) {
  const DesignResult result = design_task(
      parse_task("sample_period_ms = 1\n[design]\nfamily = \"one-pole\"\nstages = 1\nlength_set_ms = [50]\n[[axis]]\n"
                 "acceleration_max_mm_s2 = 2500\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n"
                 "error_max_um = 200\n",
                 "task"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("`order_max` = 400 has room for a pole of 43 ms at most"));
}

/// Averages of 17 and 13 samples ramp the acceleration to 100 mm/s by 0.1/(17 13 1e-6) = 452.5 m/s^3. With N = 28 or a
/// sample more, the last ramp of a leg and the first of the next overlap. Both have sin 35 degrees of it along y: 519.1
/// m/s^3, 103.8 % of the bound.
TEST(SettingsRefused, SayHowLongAnExactStopLasts) {
  const DesignResult result = design_task(
      parse_task("sample_period_ms = 1\n[controller]\ndelays = \"exact-stop\"\n[design]\nfamily = \"averages\"\n"
                 "length_set_ms = [17]\nlength_set_2_ms = [13]\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
                 "jerk_max_mm_s3 = 500000\n[[corner]]\nangle_deg = 70\nheading_deg = 145\nturn = \"right\"\n"
                 "feed_in_mm_min = 6000\nerror_max_um = 50\n",
                 "task"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("breaks jerk y: 103.8 %"));
  EXPECT_THAT(result.message, HasSubstr("an exact stop lasts until the filter is empty, or a sample longer where"));
}

/// At 50 mm/s and a right angle, averages of L >= 11 ms hold 4.6 m/s^2. They err by 35.4 um (L^2 - 1)/(4 L), 96.4 um or
/// more. 2 um are 0.0207 of that: no multiple of 0.05, but 0.02 is one of 0.005. Longer averages err by more and lose
/// more samples.
TEST(SettingsRefused, NameNoDelayAsTheCureOfAControlThatHasCornerFeedsAlone) {
  const DesignResult result =
      design_task(parse_task("sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\norder_max = "
                             "30\n[controller]\ndelays = \"corner-feed\"\n[[axis]]\nacceleration_max_mm_s2 = "
                             "4600\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 3000\nerror_max_um = 2\n",
                             "task"));
  EXPECT_FALSE(result.has_design());
  EXPECT_THAT(result.message, HasSubstr("no corner feed of the step 0.05 holds it, whatever the lengths; a finer "
                                        "`corner_feed_step`, 0.005, has some that do, with any step and length: one "
                                        "average of 11 ms"));
  EXPECT_THAT(result.message, ::testing::Not(HasSubstr("and a delay")));
}

Task refused_corner_task(const std::string& more) {
  return parse_task(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
      "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n" +
          more,
      "task");
}

TEST(SettingsRefused, ARestInACornerBreaksItsSmallestSpeed) {
  const DesignResult rest = evaluate_task(
      refused_corner_task("speed_min_mm_s = 8.9\ndelay_samples = 30\n[filter]\nkind = \"averages\"\nlengths = [20]\n"));
  EXPECT_THAT(rest.message, HasSubstr("speed min: 0 mm/s, which must be at least 8.9 mm/s, at k ="));
}

TEST(SettingsRefused, ThatDoNotExistSayWhichLimitAndTheNearest) {
  const DesignResult result = design_task(refused_corner_task("[design]\nfamily = \"averages\"\nlength_max_ms = 10\n"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("the closest, averages of 10 ms and 10 ms, breaks jerk"));
  EXPECT_THAT(result.message, HasSubstr("averages of 17 ms and 13 ms"));
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  EXPECT_THAT(
      design_task(refused_corner_task("[design]\nfamily = \"averages\"\norder_max = 60\n[[mode]]\nfrequency_Hz = 40\n"
                                      "damping_ratio = 0.02\nresidual_max = 0\n"))
          .message,
      ContainsRegex("breaks vibration: lets [0-9.]+ % of a mode through, which must be zero, at 40 Hz"));
  // The same certificate is no proof for a control that may set more.
  DesignResult forged = result;
  for (SettableStage& stage : forged.task.settings->stages) stage.length_max = 0.0;
  EXPECT_FALSE(verify_result(forged).accepted);
}

}  // namespace
}  // namespace accdec
