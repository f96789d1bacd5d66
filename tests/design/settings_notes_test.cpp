#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

// Remarks of the answer to a task of a control: caps that bind, stops considered, today's setting, assumptions.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A corner along the axes at 100 mm/s, a period of 1 ms and 6 m/s^2: no tap may be above 0.06.
DesignResult noted_design(const std::string& design, const std::string& others = "", double error = 5000.0) {
  const DesignResult result = design_task(parse_task(
      fmt::format("sample_period_ms = 1\n[design]\n{}\n{}\n[[axis]]\nname = \"x\"\nacceleration_max_mm_s2 = 6000\n"
                  "[[axis]]\nname = \"y\"\nacceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 90\n"
                  "feed_in_mm_min = 6000\nerror_max_um = {}\n",
                  design, others, error),
      "task"));
  EXPECT_EQ(result.status, Status::optimal) << result.message;
  const DesignResult again = parse_result(result_to_json(result), "result");
  EXPECT_THAT(verify_result(again).reasons, IsEmpty());
  return result;
}

/// The first of n taps with the constant c is (1 - e^(-1/c)) / (1 - e^(-n/c)), which falls with n and c. 24 taps have
/// at most 0.06 from c = 30 on (0.0596; 0.0602 at 29), 23 taps from c = 33 on. So 30 ms are the least of 24 taps, and
/// with 30 as the largest constant all that there is. With 41 as the largest, 22 taps do from c = 36 on, 21 taps do
/// not.
TEST(SettingsNotes, SayThatTheTimeConstantIsAtItsCap) {
  const DesignResult capped = noted_design("family = \"exponential\"\norder_max = 29");
  EXPECT_EQ(capped.settings->values.back().value, 30.0);
  EXPECT_THAT(settings_answer(capped), HasSubstr(" The time constant is the longest that `order_max` = 29 allows; "));
  const DesignResult free = noted_design("family = \"exponential\"\norder_max = 40");
  EXPECT_EQ(free.filter->order(), 21);
  EXPECT_EQ(free.settings->values.back().value, 36.0);
  EXPECT_THAT(settings_answer(free), Not(HasSubstr("longest")));
}

/// 17 equal taps with a delay of 4 samples: after 10 samples, 28/17 steps of the first leg are left, and 21/17 of the
/// second are gone. The error is 100 um sqrt(28^2 + 21^2)/17 = 206 um. A delay of 3 has 100 um sqrt(2) 28/17 = 233 um.
TEST(SettingsNotes, SayThatATimeIsAtItsCap) {
  const auto answer = [](const std::string& caps) {
    return settings_answer(noted_design("family = \"averages\"\nstages = 1\n" + caps, "", 220.0));
  };
  EXPECT_THAT(answer("order_max = 16"),
              HasSubstr(" The filter is the longest that `order_max` = 16 allows; longer ones were not looked at."));
  EXPECT_THAT(answer("order_max = 60\nlength_max_ms = 17.9"), HasSubstr(" 17 ms is the longest time that can be set."));
  EXPECT_THAT(answer("order_max = 60\nlength_set_ms = [8, 17]"),
              HasSubstr(" 17 ms is the longest time that can be set."));
  EXPECT_THAT(answer("order_max = 60\nlength_max_ms = 18"), Not(HasSubstr("longest")));
}

/// An endless pole of 17 ms has a first tap of 0.0571, one of 16 ms 0.0606. It is cut off after ln(10^4) 17 = 156.6
/// taps, one of 18 ms after 165.8. Without delay, the error is 8.7 steps of 0.1 mm: near t = 0.85 c, e^-0.85 = 0.43 of
/// c steps are left and 0.28 are gone. It is below 5 steps behind a delay of 0.7 c.
TEST(SettingsNotes, SayThatAPoleIsAtItsCap) {
  const auto answer = [](int order_max) {
    return settings_answer(
        noted_design(fmt::format("family = \"one-pole\"\nstages = 1\norder_max = {}", order_max), "", 500.0));
  };
  EXPECT_THAT(answer(164),
              HasSubstr(" The pole is the longest that `order_max` = 164 allows; longer ones were not looked at."));
  EXPECT_THAT(answer(165), Not(HasSubstr("longest")));
}

/// Without delay, every longer filter takes longer: 17 taps are the fewest under 6 m/s^2. A longer filter with an exact
/// stop takes two samples more.
TEST(SettingsNotes, SayNoCapsWhereLongerFiltersGainNothing) {
  const std::string averages = "family = \"averages\"\nstages = 1\n", pole = "family = \"one-pole\"\nstages = 1\n";
  EXPECT_THAT(settings_answer(noted_design(averages + "order_max = 16")), Not(HasSubstr("longest")));
  EXPECT_THAT(settings_answer(noted_design(averages + "order_max = 60\nlength_max_ms = 17")),
              Not(HasSubstr("longest")));
  EXPECT_THAT(settings_answer(noted_design(pole + "order_max = 164")), Not(HasSubstr("longest")));
  EXPECT_THAT(
      settings_answer(noted_design(averages + "order_max = 16", "[controller]\ndelays = \"exact-stop\"\n", 220.0)),
      Not(HasSubstr("longest")));
}

TEST(SettingsNotes, SayWhichExactStopsWereConsidered) {
  const std::string family = "family = \"averages\"\norder_max = 60\n", said = "Longer ones are not considered.";
  EXPECT_THAT(settings_answer(noted_design(family, "[controller]\ndelays = \"exact-stop\"\n")), HasSubstr(said));
  EXPECT_THAT(settings_answer(noted_design(family, "[controller]\ndelays = [\"exact-stop\", \"dwell\"]\n")),
              Not(HasSubstr(said)));
}

/// 5 taps of 0.2 are 3.333 times 0.06. When 19 of 40 equal taps are done, 210/40 samples of one leg's way are left, and
/// 190/40 of the other's are gone. The error is 0.1 mm sqrt(5.25^2 + 4.75^2) = 708 um, 2.36 times 300 um.
TEST(SettingsNotes, NameTheLimitThatTodaysSettingBreaks) {
  const std::string family = "family = \"averages\"\norder_max = 60\n", one = "[filter]\nkind = \"averages\"\n";
  EXPECT_THAT(settings_answer(noted_design(family, one + "lengths = [5]\n")),
              HasSubstr(" Today's setting breaks a limit with any delay: acceleration x: 333.3 %"));
  EXPECT_THAT(
      settings_answer(noted_design(family, one + "lengths = [40]\n[controller]\ndelays = \"continuous\"\n", 300.0)),
      HasSubstr(" Today's setting breaks a limit without delay: corner error: 236.0 %"));
  EXPECT_THAT(settings_answer(noted_design(family, one + "lengths = [40]\n")), Not(HasSubstr("breaks")));
}

TEST(SettingsNotes, NameWhatNoSourceSays) {
  EXPECT_THAT(settings_answer(noted_design("order_max = 60", "[controller]\nname = \"fanuc-0i\"\n")),
              HasSubstr(" Assumed: T1 is entered in ms; it has no largest value; the second leg of a corner can be "
                        "delayed by any number of samples."));
  EXPECT_THAT(settings_answer(noted_design("order_max = 60", "[controller]\nname = \"sinumerik-840d\"\n")),
              HasSubstr("; G64 does not lower the feed before a corner; "));
}

}  // namespace
}  // namespace accdec
