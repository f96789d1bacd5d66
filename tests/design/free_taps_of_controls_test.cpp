#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

// Controls that take any taps: what to set, and what is proved in front of their own smoothing.

namespace accdec {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The corner of corner/acceleration-jerk.toml.
Task everyday_corner(const std::string& more) {
  TaskOptions choices;
  choices.response = Considered::all;
  return parse_task(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
      "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n" +
          more,
      "task", choices);
}

TEST(FreeTapsOfControls, AreTapsAndDelays) {
  const DesignResult result = design_task(everyday_corner("[controller]\ndelays = [\"dwell\", \"in-position\"]\n"));
  ASSERT_EQ(result.status, Status::optimal);
  const std::string answer = settings_answer(result);
  EXPECT_EQ(
      answer,
      fmt::format("Set these: the {} taps that `accdec export` writes; dwell at corner {} ({} ms). 42 ms a corner, "
                  "proved best of free taps with delays. In-position is not used: a dwell waits as long as needed.\n",
                  result.filter->order() + 1, result.corners[0].name, 41 - result.filter->order()));
  const std::string text = result_to_json(result);
  auto json = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(json["answer"].get<std::string>() + "\n", answer);
  EXPECT_THAT(verify_result(parse_result(text, "result")).reasons, IsEmpty());
  json["answer"] = "Set these: 2 taps.";
  EXPECT_THROW(parse_result(json.dump(), "result"), InputError);
  EXPECT_EQ(settings_answer(design_task(everyday_corner(""))), "") << "nothing is said of a control";
}

/// An acceleration alone: 100 mm/s over 6 m/s^2 are 16.67 samples, so that 17 taps are the least. An exact stop lasts
/// 16 samples more, whatever the corner. Without a delay the corner error is v T cos(theta/2) times the mean absolute
/// deviation of the taps, 17/4 - 1/(4*17) = 4.235 samples.
TEST(FreeTapsOfControls, AreDesignedForOneKindOfDelay) {
  const auto designed = [](const std::string& kind, double error) {
    return design_task(parse_task(
        fmt::format(
            "sample_period_ms = 1\n[[axis]]\nname = \"x\"\nacceleration_max_mm_s2 = 6000\n[[axis]]\nname = \"y\"\n"
            "acceleration_max_mm_s2 = 6000\n[controller]\ndelays = \"{}\"\n[[corner]]\nangle_deg = 90\n"
            "feed_in_mm_min = 6000\nerror_max_um = {}\n",
            kind, error),
        "task"));
  };
  const DesignResult stops = designed("exact-stop", 1.0);
  ASSERT_EQ(stops.status, Status::optimal) << stops.message;
  EXPECT_NEAR(stops.cycle_time, (17 + 16) * 1e-3, 1e-9);
  EXPECT_THAT(settings_answer(stops), HasSubstr("exact-stop at corner A. 33 ms a corner, proved best"));
  EXPECT_THAT(verify_result(parse_result(result_to_json(stops), "result")).reasons, IsEmpty());
  const double error = 1e6 * 0.1 * 1e-3 * std::sqrt(0.5) * (17.0 / 4.0 - 1.0 / 68.0);
  const DesignResult runs_on = designed("continuous", 1.001 * error);
  ASSERT_EQ(runs_on.status, Status::optimal) << runs_on.message;
  EXPECT_NEAR(runs_on.cycle_time, 17e-3, 1e-9);
  EXPECT_EQ(runs_on.corners[0].delay, 0);
  EXPECT_THAT(verify_result(parse_result(result_to_json(runs_on), "result")).reasons, IsEmpty());
  EXPECT_NE(designed("continuous", 0.8 * error).status, Status::optimal);
  auto forged = nlohmann::ordered_json::parse(result_to_json(stops));
  forged["task"]["controller"]["delays"] = "continuous";
  EXPECT_THROW(parse_result(forged.dump(), "result"), InputError);
}

/// An exact stop lasts as long as the filter, or a sample more if a limit asks for that. With 17 taps, the acceleration
/// asks for none. So a given one needs a filter of as many samples.
TEST(FreeTapsOfControls, HaveTheGivenDelaysOfTheirKind) {
  const auto task = [](int delay) {
    return parse_task(
        fmt::format("sample_period_ms = 1\n[design]\norder_max = 40\n[controller]\ndelays = \"exact-stop\"\n[[axis]]\n"
                    "acceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\n"
                    "error_max_um = 50\ndelay_samples = {}\n",
                    delay),
        "task");
  };
  const DesignResult result = design_task(task(20));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_NEAR(result.cycle_time, (21 + 20) * 1e-3, 1e-9);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
  EXPECT_THROW(design_task(task(60)), std::invalid_argument);
}

/// Two corners under an acceleration alone.
Task two_corners(const std::string& more, double first_error, double second_error) {
  const auto corner = [](double angle, double error) {
    return fmt::format("[[corner]]\nangle_deg = {}\nfeed_in_mm_min = 6000\nerror_max_um = {}\n", angle, error);
  };
  return parse_task("sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n" + corner(90, first_error) +
                        corner(120, second_error) + more,
                    "task");
}

/// Here p(k) = sum_i b_i max(i - k, 0). At one corner, some width gives any delay up to the filter's order:
/// v1 T p(d) <= w < v1 T p(d - 1). So the optimum is that of any delay, 42 ms.
TEST(FreeTapsOfControls, InPositionIsProvedAtOneCorner) {
  const DesignResult result = design_task(everyday_corner("[controller]\ndelays = \"in-position\"\n"));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_NEAR(result.cycle_time, 42e-3, 1e-9);
  const auto way = [&](int k) {
    double sum = 0.0;
    for (int i = k + 1; i <= result.filter->order(); ++i) sum += result.filter->tap(i) * (i - k);
    return 0.1 * 1e-3 * sum;
  };
  ASSERT_TRUE(result.settings && result.settings->width);
  EXPECT_NEAR(result.settings->width->low, way(result.corners[0].delay), 1e-12);
  EXPECT_NEAR(result.settings->width->high, way(result.corners[0].delay - 1), 1e-12);
  EXPECT_THAT(settings_answer(result), HasSubstr("taps that `accdec export` writes; in-position width"));
  EXPECT_THAT(settings_answer(result), HasSubstr("42 ms a corner, proved best of free taps with such delays"));
  auto json = nlohmann::ordered_json::parse(result_to_json(result));
  EXPECT_THAT(verify_result(parse_result(json.dump(), "result")).reasons, IsEmpty());
  json["settings"]["filter"]["taps"][0] = 0.5;
  EXPECT_FALSE(verify_result(parse_result(json.dump(), "result")).accepted);
}

/// An average of 17 taps passes one corner without a delay and stops at the other, for 16 samples. A bound of delays is
/// none of corner feeds.
TEST(FreeTapsOfControls, KindsAreMixed) {
  const double runs_on = 1e6 * 0.1 * 1e-3 * std::sqrt(0.5) * (17.0 / 4.0 - 1.0 / 68.0);
  const std::string kinds = "[controller]\ndelays = [\"continuous\", \"exact-stop\"";
  const DesignResult both = design_task(two_corners(kinds + "]\n", 1.001 * runs_on, 0.0));
  ASSERT_TRUE(both.has_design()) << both.message;
  EXPECT_NEAR(both.objective(), (17 + 16) * 1e-3, 1e-9);
  EXPECT_EQ(both.corners[0].delay, 0);
  EXPECT_THAT(verify_result(both).reasons, IsEmpty());
  DesignResult slow = design_task(two_corners(kinds + ", \"corner-feed\"]\n", 1.001 * runs_on, 200.0));
  ASSERT_TRUE(slow.has_design()) << slow.message;
  EXPECT_LT(slow.objective(), both.objective());
  EXPECT_EQ(slow.status, Status::optimal) << slow.message;
  EXPECT_THAT(verify_result(slow).reasons, IsEmpty());
  slow.status = Status::feasible;
  slow.lower_bound = both.lower_bound, slow.certificate = both.certificate;
  slow.gap = (slow.objective() - *slow.lower_bound) / slow.objective();
  EXPECT_THAT(verify_result(slow).reasons, Contains(HasSubstr("the bound is of delays at full feed")));
}

/// Without a delay 17 equal taps have the error e. No filter within the acceleration has less than 0.98 e: 16 taps of
/// 0.06 and one of 0.04 have the least mean absolute deviation. So 7/8 e is held at 85 % of the feed, but not at 90 %.
/// Steps of the feed last 16 + 2 samples each.
TEST(FreeTapsOfControls, CornerFeedsAreProved) {
  const double error = 1e6 * 0.1 * 1e-3 * std::sqrt(0.5) * (17.0 / 4.0 - 1.0 / 68.0);
  const std::string corner = fmt::format(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 90\n"
      "feed_in_mm_min = 6000\nerror_max_um = {}\n",
      0.875 * error);
  for (const std::string kinds :
       {"\"corner-feed\"", "\"continuous\", \"corner-feed\"", "\"exact-stop\", \"corner-feed\""}) {
    const DesignResult result = design_task(parse_task(corner + "[controller]\ndelays = [" + kinds + "]\n", "task"));
    ASSERT_EQ(result.status, Status::optimal) << result.message;
    EXPECT_NEAR(result.objective(), (17 + 2 * 18 * 0.15) * 1e-3, 1e-12);
    EXPECT_NEAR(result.corners[0].feed_part, 0.85, 1e-12);
    EXPECT_THAT(settings_answer(result), HasSubstr("proved best"));
    const DesignResult again = parse_result(result_to_json(result), "result");
    EXPECT_THAT(verify_result(again).reasons, IsEmpty());
    DesignResult forged = result;
    forged.lower_bound = *result.lower_bound * 1.01;
    EXPECT_FALSE(verify_result(forged).accepted);
    auto proof = std::get<proof::CornerFeeds>(result.certificate->proof);
    forged = result;
    proof.parts.pop_back();
    forged.certificate = std::make_shared<Certificate>(Certificate{proof});
    EXPECT_FALSE(check_certificate(forged.task, forged).accepted) << "every part is needed";
    forged = result;
    forged.task.settings->delays.push_back(DelayKind::dwell);
    EXPECT_THAT(check_certificate(forged.task, forged).reason, HasSubstr("beside other delays"));
  }
}

/// The acceleration needs 17 taps, which leave an error without a delay. At a twentieth of the feed they leave a
/// twentieth of it. The proof leaves out what other corners limit, here also a smallest speed.
TEST(FreeTapsOfControls, NameTheLimitThatTheirDelaysCannotHold) {
  for (const double speed : {0.0, 0.01}) {
    Task task = two_corners("[controller]\ndelays = \"continuous\"\n", 500.0, 1.0);
    task.corners[0].speed_min = speed;
    const DesignResult runs_on = design_task(task);
    EXPECT_EQ(runs_on.status, Status::infeasible);
    EXPECT_THAT(runs_on.message, HasSubstr("corner error B"));
    EXPECT_THAT(runs_on.message, Not(HasSubstr("corner error A")));
    EXPECT_THAT(runs_on.message, HasSubstr("the control has no delays at corners"));
    EXPECT_THAT(verify_result(parse_result(result_to_json(runs_on), "result")).reasons, IsEmpty());
  }
  DesignOptions options;
  options.time_limit = 5.0;
  const std::string kinds = "[design]\norder_max = 40\n[controller]\ndelays = [\"continuous\", \"corner-feed\"]\n";
  const DesignResult slows = design_task(two_corners(kinds, 500.0, 0.01), options);
  EXPECT_FALSE(slows.has_design());
  EXPECT_THAT(slows.message, HasSubstr("; with no delays alone: no filter of order"));
  EXPECT_THAT(slows.message, HasSubstr("; even at the slowest corner feed, 0.05 of the programmed one, no filter"));
  EXPECT_THAT(slows.message, HasSubstr("corner error B"));
}

/// One corner's delay is given. With the delays of the others free, the search ran to its time limit.
TEST(FreeTapsOfControls, AGivenDelayIsRefutedBesideFreeOnes) {
  std::string text =
      "sample_period_ms = 1\n[design]\norder_max = 60\n[controller]\ndelays = \"dwell\"\n[[axis]]\n"
      "acceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n";
  for (const char* const corner :
       {"name = \"A\"\nangle_deg = 90\nerror_max_um = 20\ndelay_samples = 12\n",
        "name = \"B\"\nangle_deg = 60\nerror_max_um = 80\n", "name = \"C\"\nangle_deg = 120\nerror_max_um = 40\n",
        "name = \"D\"\nangle_deg = 75\nheading_deg = 50\nerror_max_um = 60\n"})
    text += std::string("[[corner]]\nfeed_in_mm_min = 6000\n") + corner;
  DesignOptions options;
  options.time_limit = 20.0;  // it takes 20 ms
  const DesignResult result = design_task(parse_task(text, "task"), options);
  EXPECT_EQ(result.status, Status::infeasible) << result.message;
  EXPECT_THAT(result.message, HasSubstr("corner error A, delay of corner A"));
  for (const char* const other : {"corner error B", "corner error C", "corner error D"})
    EXPECT_THAT(result.message, Not(HasSubstr(other)));
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

/// A stop of 3 samples takes a filter of 3 at most, and the acceleration needs 17 taps.
TEST(FreeTapsOfControls, SayWhichFiltersGivenStopsNeed) {
  Task task = two_corners("[controller]\ndelays = \"exact-stop\"\n", 500.0, 500.0);
  task.corners[0].delay = 3;
  const DesignResult result = design_task(task);
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("exact stops of the given delays need filters of order 2 to 3"));
}

/// Averages where they are as good as free taps: 17 taps for an acceleration of 6 m/s^2. Else the taps.
TEST(FreeTapsOfControls, MayStandBesideFamilies) {
  const std::string families = "[design]\nfamily = [\"taps\", \"averages\"]\n";
  const DesignResult equal = design_task(two_corners(families + "[controller]\ndelays = \"exact-stop\"\n", 5, 5));
  ASSERT_TRUE(equal.settings) << equal.message;
  EXPECT_EQ(equal.settings->family, SettingFamily::averages);
  EXPECT_NEAR(equal.objective(), (17 + 2 * 16) * 1e-3, 1e-9);
  EXPECT_THAT(verify_result(equal).reasons, IsEmpty());
  const DesignResult better =
      design_task(everyday_corner(families + "[baseline]\nkind = \"averages\"\nlengths = [20, 20]\n"));
  ASSERT_EQ(better.status, Status::optimal) << better.message;
  EXPECT_NEAR(better.objective(), 42e-3, 1e-12);
  ASSERT_TRUE(better.settings && better.savings);
  EXPECT_EQ(better.settings->family, SettingFamily::taps);
  EXPECT_GT(better.savings->today, 44e-3 - 1e-12) << "no two averages are faster than the best";
  EXPECT_THAT(settings_answer(better), HasSubstr("Today's setting takes"));
  EXPECT_THAT(verify_result(parse_result(result_to_json(better), "result")).reasons, IsEmpty());
}

const char* const smoothing = "[controller]\nprefilter_taps = [0.08, 0.42, 0.42, 0.08]\n";

/// The filter and its smoothing of 4 taps together are one filter, for which 42 ms are the proved optimum (see
/// corner/acceleration-jerk.toml). So the filter takes 39 ms or more. attack_small judges such proofs by brute force.
TEST(FreeTapsOfControls, AreProvedInFrontOfASmoothing) {
  for (const std::string family : {"", "[design]\nfamily = \"averages\"\n"}) {
    const DesignResult result = design_task(everyday_corner(family + smoothing));
    ASSERT_EQ(result.status, Status::optimal) << result.message;
    EXPECT_GE(*result.lower_bound, 39e-3 - 1e-12);
    EXPECT_LE(result.objective(), 44e-3 + 1e-12);
    EXPECT_TRUE(!family.empty() || *result.lower_bound == result.objective());
    EXPECT_THAT(verify_result(result).reasons, IsEmpty());
    EXPECT_THAT(settings_answer(result), HasSubstr("proved best"));
    const DesignResult again = parse_result(result_to_json(result), "result");
    EXPECT_THAT(verify_result(again).reasons, IsEmpty());
    DesignResult forged = result;
    forged.lower_bound = *result.lower_bound + 1e-3;
    EXPECT_FALSE(verify_result(forged).accepted);
    // The proof is about this smoothing: with less of it, limits leave less.
    forged = result;
    forged.task.machine.prefilter_taps.clear();
    EXPECT_FALSE(check_certificate(forged.task, forged).accepted);
  }
}

/// An exact stop in front of a smoothing and a servo, against every delay as a given one, with the filters of which it
/// is a stop behind the smoothing. Behind a servo a longer filter may be needed for the error, which is not proved.
TEST(FreeTapsOfControls, StopExactlyInFrontOfAResponse) {
  const std::string controls[] = {"prefilter_taps = [0.25, 0.5, 0.25]\n", "prefilter_taps = [0.2, 0.0, 0.8]\n",
                                  "prefilter_taps = [0.08, 0.42, 0.42, 0.08]\n", ""};
  for (const std::string& smooths : controls) {
    const std::string control = "[controller]\n" + smooths;
    const auto with_servo = [&](Task task) {
      for (Axis& axis : task.machine.axes) axis.servo_gain = smooths.empty() ? 70.0 : unlimited;
      return task;
    };
    const DesignResult result = design_task(with_servo(everyday_corner(control + "delays = \"exact-stop\"\n")));
    ASSERT_TRUE(result.has_design()) << result.message;
    EXPECT_TRUE(smooths.empty() || result.status == Status::optimal);
    EXPECT_THAT(settings_answer(result), HasSubstr("exact-stop at corner A"));
    EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
    double least = unlimited;
    for (int delay = 15; delay < 90; ++delay) {
      Task given = with_servo(everyday_corner(control));
      const int taps = static_cast<int>(given.machine.prefilter_taps.size());
      given.corners[0].delay = delay;
      given.design.order_max = delay - std::max(0, taps - 1), given.design.order_min = given.design.order_max - 1;
      const DesignResult best = design_task(given);
      if (best.status == Status::optimal) least = std::min(least, best.objective());
    }
    EXPECT_NEAR(result.objective(), least, 1e-12) << control;
    EXPECT_TRUE(result.lower_bound && *result.lower_bound <= least + 1e-12);
  }
}

/// Powers are those of the filter and the smoothing together, which are one filter that is three samples longer.
TEST(FreeTapsOfControls, AreProvedInFrontOfASmoothingWherePowerBinds) {
  Task task = everyday_corner("");
  for (Axis& axis : task.machine.axes) axis.mass = 30.0, axis.damping = 100.0, axis.power_max = 8.0;
  const DesignResult as_one = design_task(task);
  ASSERT_EQ(as_one.status, Status::optimal) << as_one.message;
  task.machine.prefilter_taps = {0.08, 0.42, 0.42, 0.08};
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_GE(result.objective(), as_one.objective() - 3e-3 - 1e-12);
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
  DesignResult forged = result;
  forged.lower_bound = *result.lower_bound + 1e-3;
  EXPECT_FALSE(verify_result(forged).accepted);
  // Without the smoothing the proof is of another motion.
  forged = result;
  forged.task.machine.prefilter_taps.clear();
  EXPECT_FALSE(check_certificate(forged.task, forged).accepted);
}

}  // namespace
}  // namespace accdec
