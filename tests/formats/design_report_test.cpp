#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/formats/explanation.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/malformed_tasks.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;

TEST(TextTable, AlignsColumnsWithoutTrailingSpaces) {
  TextTable table({"name", "value", "note"});
  table.left(2);
  table.add({"a", "1.5", "x"});
  table.add({"longer", "12.25", ""});
  table.add({"\xC3\xA9t\xC3\xA9", "3", "umlauts count once"});
  EXPECT_EQ(table.str(),
            "name    value  note\n"
            "a         1.5  x\n"
            "longer  12.25\n"
            "\xC3\xA9t\xC3\xA9         3  umlauts count once\n");
  EXPECT_THROW(table.add({"too", "few"}), std::invalid_argument);
}

TEST(ResultText, StatesUnitsAndTheWorstOfEveryLimit) {
  const DesignResult result = evaluate_task(parse_task(malformed::Parts{}.str(), "t"));
  const std::string text = result_text(result);
  EXPECT_THAT(text, HasSubstr("status      feasible\n"));
  EXPECT_THAT(text, HasSubstr("order 20 (21 taps), sample period 1 ms, mean delay 10 ms"));
  EXPECT_THAT(text, HasSubstr("cycle time  24 ms"));
  EXPECT_THAT(text, HasSubstr("all limits hold"));
  for (const char* unit : {"um", "mm/s", "ms", "mm/s^2", "N", "%"}) EXPECT_THAT(text, HasSubstr(unit));
  // Velocity x: 100 mm/s of 500, under the width of "313.344".
  EXPECT_THAT(text, HasSubstr("20.00      100    500  mm/s"));
}

// A boxcar of 20 samples takes 10 kg to 100 mm/s at 5 m/s^2. With a damping of 100 N s/m the last sample needs 60 N.
// Between 0 and 150 mm/s the curve is |F| = 200 N - 1000 N s/m |V|: 100 N at that speed, and (60 + 100)/200 of it used.
TEST(ResultText, ForceIsBesideTheCurveAtItsSpeed) {
  const DesignResult result = evaluate_task(parse_task(
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 19\n[[axis]]\nmass_kg = 10\ndamping_N_s_m = 100\n"
      "force_speed_N = [[0, 200], [150, 50]]\n[[corner]]\nname = \"A\"\nfeed_in_mm_min = 6000\ndelay_samples = 0\n"
      "direction_in = [1]\ndirection_out = [1]\n",
      "task.toml", {.response = Considered::all}));
  const ReportTable limits = limit_report(result);
  const std::vector<std::string> row{"force speed", "x", "80.00", "60", "100", "N", "A start, k = 20, at 100 mm/s"};
  EXPECT_THAT(limits.rows, ::testing::Contains(row));
  EXPECT_THAT(result_text(result), HasSubstr("\n" + limits.note + "\n"));
  EXPECT_THAT(limits.note, HasSubstr("the curve's force at that speed"));
}

TEST(ResultText, SaysWhatIsNotConsidered) {
  const auto text = [](const malformed::Parts& parts) {
    return result_text(evaluate_task(parse_task(parts.str(), "t")));
  };
  EXPECT_THAT(text({}), HasSubstr("ignored     vibration of the machine (the task has no [[mode]]); following error "
                                  "and feedforward of the servo, thermal rating of the drives\n"));
  EXPECT_THAT(text({.end = "[[mode]]\nfrequency_Hz = 40\nresidual_max = 1\n"}),
              HasSubstr("ignored     following error and feedforward of the servo, thermal rating of the drives\n"));
}

// A corner says nothing about the mean over a program.
TEST(ResultText, SaysWhoJudgesTheRating) {
  const DesignResult result = evaluate_task(parse_task(
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 19\n[[axis]]\nmass_kg = 20\nforce_rms_N = 90\n"
      "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n",
      "task.toml", {.response = Considered::all}));
  EXPECT_THAT(result_text(result), HasSubstr("thermal rating of the drives (the mean over a whole program, which "
                                             "`accdec program` judges)"));
}

// If some axes have a servo, the others are named.
TEST(ResultText, NamesTheAxesWithoutServo) {
  const DesignResult result = evaluate_task(parse_task(
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 19\n[[axis]]\nname = \"x\"\nservo_gain_1_s = 200\n"
      "[[axis]]\nname = \"y\"\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n",
      "task.toml", {.response = Considered::all}));
  EXPECT_THAT(result_text(result), HasSubstr("following error and feedforward of the servo of axis y, thermal rating"));
}

TEST(ExplanationText, SaysWhatIsNotConsidered) {
  const Explanation explanation = explain_task(parse_task(malformed::Parts{}.str(), "t"));
  EXPECT_THAT(explanation_text(explanation), HasSubstr("Ignored: vibration of the machine (the task has no [[mode]])"));
}

// Names in a result come from a file; the terminal obeys what it gets.
TEST(ResultText, HoldsNoControlCharacters) {
  DesignResult result = evaluate_task(parse_task(malformed::Parts{}.str(), "t"));
  result.message = result.solver.name = "\x1b[31mred";
  result.limits.front().axis = "\x1b]0;title\a";
  const std::string shown = result_text(result);
  EXPECT_THAT(shown, HasSubstr("\\x1b[31mred"));
  EXPECT_EQ(shown.find('\x1b'), std::string::npos);
  EXPECT_EQ(shown.find('\a'), std::string::npos);
}

}  // namespace
}  // namespace accdec
