#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

// Free taps of several corners with one in-position width. attack_small judges such proofs by brute force.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const char* const in_position = "[controller]\ndelays = \"in-position\"\n";

/// Two corners under an acceleration alone.
Task two_corners(const std::string& more, double second_feed) {
  const auto corner = [](double angle, double feed, double error) {
    return fmt::format("[[corner]]\nangle_deg = {}\nfeed_in_mm_min = {}\nerror_max_um = {}\n", angle, feed, error);
  };
  TaskOptions choices;
  choices.response = Considered::all;
  return parse_task("sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n" + corner(90, 6000, 20) +
                        corner(120, second_feed, 20) + more,
                    "task", choices);
}

const proof::BranchAndBound& proof_of(const DesignResult& result) {
  return std::get<proof::BranchAndBound>(result.certificate->proof);
}

/// The least time of both corners with one delay, each given in turn, if it is not above a known one. The exact method
/// knows no widths here. A width gives a delay to filters that are at least as long, less the latency.
double least_of_equal_delays(double known, int latency) {
  double least = unlimited;
  const int samples = static_cast<int>(std::lround(known / 1e-3));
  for (int delay = latency; delay < 30; ++delay) {
    Task given = two_corners("", 6000);
    for (TaskCorner& corner : given.corners) corner.delay = delay;
    given.design.order_min = std::max(1, delay - latency);
    given.design.order_max = samples - 1 - 2 * delay;  // longer ones take more time
    if (given.design.order_max < given.design.order_min) continue;
    const DesignResult found = design_task(given);
    if (found.status == Status::optimal) least = std::min(least, found.objective());
  }
  return least;
}

/// Corners of equal feeds have one delay by one width.
TEST(OneWidth, CornersOfEqualFeedsWaitEquallyLong) {
  const DesignResult any = design_task(two_corners("", 6000));
  const DesignResult result = design_task(two_corners(in_position, 6000));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(result.corners[0].delay, result.corners[1].delay);
  EXPECT_GT(result.objective(), any.objective() + 1e-9);
  EXPECT_THAT(settings_answer(result), HasSubstr("proved best"));
  EXPECT_NEAR(result.objective(), least_of_equal_delays(result.objective(), 0), 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// The way v T p(k) that the filter leaves k samples after its command's end, p(k) = sum_i b_i max(i - k, 0).
double way_left(const Filter& filter, double feed, double period, int k) {
  double sum = 0.0;
  for (int i = std::max(0, k) + 1; i <= filter.order(); ++i) sum += filter.tap(i) * (i - k);
  return k < 0 ? unlimited : feed * period * sum;
}

/// v1 T p(d1) <= w < v1 T p(d1 - 1) and v2 T p(d2) <= w < v2 T p(d2 - 1).
TEST(OneWidth, IsProvedForUnequalFeeds) {
  const DesignResult any = design_task(two_corners("", 3000));
  const DesignResult result = design_task(two_corners(in_position, 3000));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_GE(result.objective(), any.objective() - 1e-12);
  const auto way = [&](double feed, int k) { return way_left(*result.filter, feed, 1e-3, k); };
  const int first = result.corners[0].delay, second = result.corners[1].delay;
  ASSERT_TRUE(result.settings && result.settings->width);
  EXPECT_NEAR(result.settings->width->low, std::max(way(0.1, first), way(0.05, second)), 1e-12);
  EXPECT_NEAR(result.settings->width->high, std::min(way(0.1, first - 1), way(0.05, second - 1)), 1e-12);
  EXPECT_LT(result.settings->width->low, result.settings->width->high);
  EXPECT_TRUE(proof_of(result).in_position);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// Delays 0 and d need v1 p(0) < v2 p(d - 1). A zero tap in front of a filter adds a sample to every way: the same
/// blends get delays that are a sample longer, or stay at 0. Without it the best takes 60 ms.
TEST(OneWidth, MayNeedAZeroTapAtTheBeginning) {
  TaskOptions choices;
  choices.response = Considered::all;
  const std::string task =
      "sample_period_ms = 6\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
      "[[corner]]\nangle_deg = 150\nfeed_in_mm_min = 2000\nerror_max_um = 150\nweight = 2\n"
      "[[corner]]\nangle_deg = 60\nfeed_in_mm_min = 6000\nerror_max_um = 40\n";
  const DesignResult result = design_task(parse_task(task + in_position, "task", choices));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_NEAR(result.objective(), 54e-3, 1e-12);
  const Filter& filter = *result.filter;
  EXPECT_EQ(filter.tap(0), 0.0);
  ASSERT_EQ(result.corners[0].delay, 0);
  const int second = result.corners[1].delay;
  const double slow = 2.0 / 60.0, fast = 0.1, period = 6e-3;
  EXPECT_LT(std::max(way_left(filter, slow, period, 0), way_left(filter, fast, period, second)),
            way_left(filter, fast, period, second - 1));
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// A smoothing that begins with zero taps delays the motion: the way is 0 only after all of it. Behind 6 samples and an
/// average of 5, p(4) = 4, p(3) = 5, p(7) = 1.2 and p(6) = 2. At 25 and 100 mm/s one width gives delays of 4 and 7
/// samples, from 0.12 to 0.125 mm. The legs are apart after 4 samples.
TEST(OneWidth, GivesDelaysLongerThanTheFilterBehindALateSmoothing) {
  const auto corner = [](int feed) {
    return fmt::format("[[corner]]\nangle_deg = 90\nfeed_in_mm_min = {}\nerror_max_um = 1\n", feed);
  };
  TaskOptions choices;
  choices.response = Considered::all;
  const DesignResult result = design_task(parse_task(
      "sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\n[[axis]]\nacceleration_max_mm_s2 = 20000\n" +
          corner(1500) + corner(6000) + in_position + "prefilter_taps = [0, 0, 0, 0, 0, 0, 1]\n",
      "task", choices));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(result.filter->order(), 4);
  EXPECT_EQ(result.corners[0].delay, 4);
  EXPECT_EQ(result.corners[1].delay, 7);
  ASSERT_TRUE(result.settings && result.settings->width);
  EXPECT_NEAR(result.settings->width->low, 0.12e-3, 1e-12);
  EXPECT_NEAR(result.settings->width->high, 0.125e-3, 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

TEST(OneWidth, ProofIsAboutItsDelays) {
  const DesignResult result = design_task(two_corners(in_position, 6000));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  ASSERT_TRUE(check_certificate(result.task, result).accepted);
  proof::BranchAndBound proof = proof_of(result);
  proof.in_position = false;
  DesignResult forged = result;
  forged.certificate = std::make_shared<Certificate>(Certificate{proof});
  EXPECT_FALSE(check_certificate(forged.task, forged).accepted) << "with any delays there is a shorter design";
  forged = result;
  forged.task.settings->delays = {DelayKind::dwell};
  EXPECT_THAT(check_certificate(forged.task, forged).reason, HasSubstr("one in-position width"));
  forged = result;
  forged.task.settings->delays.push_back(DelayKind::exact_stop);
  EXPECT_FALSE(check_certificate(forged.task, forged).accepted);
  forged = result;
  forged.lower_bound = *result.lower_bound + 1e-3;
  EXPECT_FALSE(verify_result(forged).accepted);
}

/// With a latency of L samples no delay is below L, and every delay by the width is longer by L.
TEST(OneWidth, ReckonsWithTheLatency) {
  const DesignResult late =
      design_task(two_corners("[controller]\ndelays = \"in-position\"\nin_position_latency_ms = 9\n", 6000));
  ASSERT_EQ(late.status, Status::optimal) << late.message;
  EXPECT_GE(late.corners[0].delay, 9);
  EXPECT_NEAR(late.objective(), least_of_equal_delays(late.objective(), 9), 1e-12);
  EXPECT_THAT(verify_result(late).reasons, IsEmpty());
}

/// Legs at 45 degrees and a control that watches each axis, which has 0.71 of the way. An average of L leaves
/// p(d) = (L - 1 - d)(L - d)/(2 L) samples: the same settings as along the path, and 0.71 of their width.
TEST(OneWidth, OfEachAxisIsLessThanThatAlongThePath) {
  const auto designed = [](const std::string& by) {
    return design_task(parse_task(
        "sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
        "[[corner]]\nangle_deg = 90\nheading_deg = 45\nfeed_in_mm_min = 6000\nerror_max_um = 50\n" +
            std::string(in_position) + "in_position_by = \"" + by + "\"\n",
        "task"));
  };
  const DesignResult path = designed("path"), axis = designed("axis");
  ASSERT_TRUE(path.settings && path.settings->width && axis.settings && axis.settings->width);
  EXPECT_EQ(path.filter->order(), axis.filter->order());
  const int n = axis.filter->order(), d = axis.corners[0].delay;
  ASSERT_EQ(path.corners[0].delay, d);
  ASSERT_GT(d, 0);
  const auto left = [&](int k) { return 0.1 * 1e-3 * (n - k) * (n + 1 - k) / (2.0 * (n + 1)); };
  EXPECT_NEAR(path.settings->width->low, left(d), 1e-12);
  EXPECT_NEAR(path.settings->width->high, left(d - 1), 1e-12);
  EXPECT_NEAR(axis.settings->width->low, left(d) * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(axis.settings->width->high, left(d - 1) * std::sqrt(0.5), 1e-12);
  for (const DesignResult& result : {path, axis})
    EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
  DesignResult forged = axis;
  forged.settings->width = path.settings->width;
  EXPECT_THAT(verify_result(forged).reasons, Not(IsEmpty()));
  forged = axis;
  forged.task.settings->in_position_by_axis = false;
  EXPECT_THAT(verify_result(forged).reasons, Not(IsEmpty()));
}

/// Equal feeds, but the second leg 1 at 45 degrees: v1 p(d1) <= w/T < v1 p(d1 - 1), and the same with 0.71 v1.
TEST(OneWidth, OfEachAxisIsProvedForUnequalHeadings) {
  TaskOptions choices;
  choices.response = Considered::all;
  const std::string corner = "[[corner]]\nfeed_in_mm_min = 6000\nerror_max_um = 20\n";
  const std::string task = "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n" + corner +
                           "angle_deg = 90\n" + corner + "angle_deg = 120\nheading_deg = 45\n" + in_position;
  const DesignResult path = design_task(parse_task(task, "task", choices));
  const DesignResult result = design_task(parse_task(task + "in_position_by = \"axis\"\n", "task", choices));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(path.corners[0].delay, path.corners[1].delay);
  EXPECT_LE(result.corners[1].delay, result.corners[0].delay);
  const auto way = [&](double feed, int k) { return way_left(*result.filter, feed, 1e-3, k); };
  const int first = result.corners[0].delay, second = result.corners[1].delay;
  const double slower = 0.1 * std::sqrt(0.5);
  ASSERT_TRUE(result.settings && result.settings->width);
  EXPECT_NEAR(result.settings->width->low, std::max(way(0.1, first), way(slower, second)), 1e-12);
  EXPECT_NEAR(result.settings->width->high, std::min(way(0.1, first - 1), way(slower, second - 1)), 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

}  // namespace
}  // namespace accdec
