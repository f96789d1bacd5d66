#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

// Exact stops of a control: as soon as the filter has ended, or a sample later where a limit asks for that.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// One corner at 100 mm/s and a period of 1 ms.
Task stops(double angle, const std::string& axis, const std::string& design, const std::string& corner = "") {
  return parse_task(fmt::format("sample_period_ms = 1\n[design]\n{}order_max = 60\n[controller]\n"
                                "delays = \"exact-stop\"\n[[axis]]\n{}\n[[corner]]\nangle_deg = {}\n"
                                "feed_in_mm_min = 6000\nerror_max_um = 50\n{}",
                                design, axis, angle, corner),
                    "task");
}

const std::string average_stages = "family = \"averages\"\nstages = ";

/// 6 m/s^2 are 0.06 of the feed a sample: 17 equal taps. At a corner of 60 degrees x goes on at minus half the speed.
/// With a delay of 16, the sample in between asks for 1.5/17 > 0.06. So it takes 17. Taps that need none of that sample
/// would be 1.5/0.06 = 25, or 18 free ones.
TEST(ExactStop, WaitsASampleMoreWhereAnAxisReverses) {
  for (const std::string& family : {average_stages + "1\n", std::string()}) {
    const DesignResult result = design_task(stops(60, "acceleration_max_mm_s2 = 6000", family));
    ASSERT_EQ(result.status, Status::optimal) << result.message;
    EXPECT_EQ(result.filter->order(), 16);
    EXPECT_EQ(result.corners[0].delay, 17);
    EXPECT_NEAR(result.objective(), 34e-3, 1e-12);
    EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
  }
}

/// Averages of L and M have taps that rise by 1/(L M) a sample. A jerk of 500 m/s^3 lets taps rise by 0.005, so that
/// starts and stops need L M >= 200. Straight on, the last rise of a stop and the first of a start are a sample apart
/// at most. So L M >= 400, averages of 20 and 20. No control can be told to wait for two samples. Free taps rise by
/// 0.005 a sample and begin and end with half of that. 14 + 1/2 + 14 of them on both sides have the sum 0.005 (14^2 +
/// 14 + 1/2) > 1. With one tap less it is 0.005 14^2 < 1.
TEST(ExactStop, DoesNotWaitForTheJerkOfBothLegs) {
  const DesignResult settings = design_task(stops(180, "jerk_max_mm_s3 = 500000", average_stages + "2\n"));
  ASSERT_EQ(settings.status, Status::optimal) << settings.message;
  EXPECT_NEAR(settings.objective(), (39 + 38) * 1e-3, 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(settings), "result")).reasons, IsEmpty());
  const DesignResult taps = design_task(stops(180, "jerk_max_mm_s3 = 500000", ""));
  ASSERT_TRUE(taps.has_design()) << taps.message;
  EXPECT_NEAR(taps.objective(), (29 + 29) * 1e-3, 1e-12);
  EXPECT_LE(taps.lower_bound.value_or(0.0), taps.objective());
  EXPECT_THAT(verify_result(parse_result(result_to_json(taps), "result")).reasons, IsEmpty());
}

/// Along the axes, 17 equal taps hold the acceleration with a stop of 16. A given stop of 17 is none of theirs: 18 are.
TEST(ExactStop, IsNoLongerOnRequest) {
  const DesignResult result = design_task(stops(90, "acceleration_max_mm_s2 = 6000", "", "delay_samples = 17\n"));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_NEAR(result.objective(), (18 + 17) * 1e-3, 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// At 60 degrees an axis reverses, which asks a stop of 16 for a sample more. At 90 degrees, along the axes, none does.
TEST(ExactStop, WaitsLongerOnlyAtCornersThatNeedIt) {
  Task task = stops(60, "acceleration_max_mm_s2 = 6000", "");
  task.corners.push_back(stops(90, "acceleration_max_mm_s2 = 6000", "").corners[0]);
  task.corners.back().name = "B";
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(result.corners[0].delay, 17);
  EXPECT_EQ(result.corners[1].delay, 16);
  EXPECT_NEAR(result.objective(), (17 + 17 + 16) * 1e-3, 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// A control waits until its filter is empty, whatever the taps are. Those of a windowed sinc of 30 end in zeros: the
/// legs would be apart two samples sooner. Three taps of its own smoothing last two samples.
TEST(ExactStop, WaitsForZeroTapsAndSmoothing) {
  const std::string limit = "acceleration_max_mm_s2 = 20000";
  DesignResult sinc = design_task(stops(90, limit, "family = \"windowed-sinc\"\nlength_set_ms = [30]\n"));
  ASSERT_EQ(sinc.status, Status::optimal) << sinc.message;
  ASSERT_EQ(sinc.filter->last_nonzero_tap() - sinc.filter->first_nonzero_tap(), 27);
  EXPECT_EQ(sinc.corners[0].delay, 29);
  EXPECT_NEAR(sinc.objective(), (30 + 29) * 1e-3, 1e-12);
  EXPECT_THAT(verify_result(sinc).reasons, IsEmpty());
  sinc.corners[0].delay = 27;
  EXPECT_THAT(verify_result(sinc).reasons, ::testing::Contains(HasSubstr("delay 27 is no exact stop")));

  for (const std::string& family : {average_stages + "1\n", std::string()}) {
    Task task = stops(90, "acceleration_max_mm_s2 = 6000", family);
    task.machine.prefilter_taps = {0.25, 0.5, 0.25};
    const DesignResult smoothed = design_task(task);
    ASSERT_EQ(smoothed.status, Status::optimal) << smoothed.message;
    EXPECT_EQ(smoothed.corners[0].delay, smoothed.filter->order() + 2);
    EXPECT_THAT(verify_result(parse_result(result_to_json(smoothed), "result")).reasons, IsEmpty());
    EXPECT_THAT(settings_answer(smoothed), HasSubstr("The control's smoothing ends 2 ms after this time."));
  }
}

TEST(ExactStop, ThatIsLongerIsRefused) {
  DesignResult forged = design_task(stops(90, "acceleration_max_mm_s2 = 6000", average_stages + "1\n"));
  ASSERT_EQ(forged.corners[0].delay, 16) << forged.message;
  ++forged.corners[0].delay;
  EXPECT_THAT(verify_result(forged).reasons, ::testing::Contains(HasSubstr("delay 17 is no exact stop")));
}

/// The legs are apart after N samples. 3 taps of 1/3 use all of an acceleration v/(3 T). An axis that reverses by half
/// has 3/2 of it in the sample that the last tap of one leg shares with the first of the other. Taps 1, 2, 3, 2, 1 of 9
/// use all of a jerk v/(9 T^2), also in the sample after the last tap. An axis that goes on at half the speed adds the
/// other leg's first step there, of the same sign. So a sample more does not help, and no control waits for two.
TEST(ExactStop, WaitsASampleMoreAtMost) {
  const auto stop = [](const std::string& limit, int stages, double angle) {
    const DesignResult result = design_task(
        parse_task(fmt::format("sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = {}\n"
                               "length_set_ms = [3]\n[controller]\ndelays = \"exact-stop\"\n[[axis]]\nname = \"x\"\n"
                               "{}\n[[axis]]\nname = \"y\"\n{}\n[[corner]]\nangle_deg = {}\n"
                               "feed_in_mm_min = 5400\nerror_max_um = 1\n",
                               stages, limit, limit, angle),
                   "task"));
    EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << result.message;
    EXPECT_TRUE(result.has_design() || result.status == Status::infeasible);
    return result.has_design() ? result.corners[0].delay - result.filter->order() : -1;
  };
  const std::string acceleration = "acceleration_max_mm_s2 = 30000", jerk = "jerk_max_mm_s3 = 10000000";
  EXPECT_EQ(stop(acceleration, 1, 90), 0);
  EXPECT_EQ(stop(acceleration, 1, 60), 1);
  EXPECT_EQ(stop(jerk, 2, 90), 0);
  EXPECT_EQ(stop(jerk, 2, 120), -1);
}

}  // namespace
}  // namespace accdec
