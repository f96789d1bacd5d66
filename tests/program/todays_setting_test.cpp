#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/plan/filters/program_settings.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// The setting that a control has today, and what the answer says of the search for a better one.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::HasSubstr;
using testing::StartsWith;

/// One average of 9 ms is better for the zigzag than what a search finds at once. Another answer must not be slower.
TEST_F(ProgramCommand, AShortTimeLimitRecommendsNothingSlowerThanTodaysSetting) {
  const std::string zigzag = test_support::source_folder() + "/problems/program/zigzag.ngc";
  for (const std::string today :
       {"kind = \"averages\"\nlengths = [9]\n", "kind = \"exponential\"\norder = 82\nratio = 0.8948393168143698\n"}) {
    const bool pole = today.find("exponential") != std::string::npos;
    write("t.toml", std::string("sample_period_ms = 1\n[controller]\nname = \"") +
                        (pole ? "omron-g5" : "sinumerik-840d") + "\"\n[filter]\n" + today +
                        "[program]\nerror_max_um = 20\n[[axis]]\nvelocity_max_mm_s = 500\n"
                        "acceleration_max_mm_s2 = 6000\n");
    for (const char* feeds : {"keep", "choose"}) {
      ASSERT_EQ(run("program " + zigzag + " --task t.toml --time-limit 0.05 --json r.json --feeds " + feeds).code, 0)
          << read("err");
      const nlohmann::json record = nlohmann::json::parse(read("r.json"));
      const double time = record["cycle_time_s"], now = record["settings"]["today_s"];
      EXPECT_LE(time, now * (1.0 + 1e-9)) << today << feeds;
      const std::string kept = record["settings"]["tried"] == 1
                                   ? "The time was too short for an answer. Today's setting: "
                                   : "Keep today's setting: ";
      EXPECT_THAT(read("out"), StartsWith(time < now * (1.0 - 1e-9) ? "Set these: " : kept));
      const Output verified = run("verify r.json");
      EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
    }
  }
}

/// One plan is no search. A proof that no other setting is faster may need no other plan.
TEST(ProgramAnswer, AdvisesNothingWithoutASearch) {
  ProgramResult result;
  result.cycle_time = 10.0;
  ProgramSettings& settings = result.settings.emplace();
  settings.chosen = {.family = SettingFamily::averages, .values = {{"", 9.0, "ms"}}};
  settings.members = 40400, settings.tried = 1, settings.guessed = 1, settings.is_today = true;
  EXPECT_THAT(program_settings_answer(result),
              StartsWith("The time was too short for an answer. Today's setting: one average of 9 ms. 10 s for this "
                         "program, the only one tried: 1 of 40400 settings planned, 1 guessed. "));
  settings.tried = 2;
  EXPECT_THAT(program_settings_answer(result), StartsWith("Keep today's setting: "));
  settings.tried = 1, settings.complete = true;
  EXPECT_THAT(program_settings_answer(result), StartsWith("Keep today's setting: "));
}

/// 0.026 of 65.772 s are 0.0395 %.
TEST(ProgramAnswer, NamesSmallPartsByTheirFirstDigit) {
  ProgramResult result;
  result.cycle_time = 65.772;
  ProgramSettings& settings = result.settings.emplace();
  settings.chosen = {.family = SettingFamily::averages, .values = {{"", 9.0, "ms"}}};
  settings.free_taps = 65.746;
  EXPECT_THAT(program_settings_answer(result), HasSubstr("would take 65.746 s (0.04 % less) or less."));
}

/// A search without --time-limit has a limit of its own. Half of --time-limit goes to a search.
TEST(ProgramAnswer, NamesTheLimitThatEndedTheSearch) {
  ProgramResult result;
  result.cycle_time = 10.0;
  ProgramSettings& settings = result.settings.emplace();
  settings.chosen = {.family = SettingFamily::averages, .values = {{"", 9.0, "ms"}}};
  settings.members = 40400, settings.tried = 12, settings.guessed = 345;
  EXPECT_THAT(program_settings_answer(result),
              HasSubstr("12 of 40400 settings planned, 345 guessed. The time limit ended the"));
  settings.search_limit = 8.2;
  EXPECT_THAT(program_settings_answer(result),
              HasSubstr("its own limit of 8.2 s; --time-limit 33 searches twice as long."));
  settings.complete = true;
  EXPECT_THAT(program_settings_answer(result), HasSubstr("no other of 40400 settings is planned faster."));
  // The control of the comparison has fewer delays than free taps.
  settings.free_taps = 9.0;
  ControllerSettings control;
  control.delays = {DelayKind::in_position};
  settings.control = std::make_shared<const ControllerSettings>(control);
  EXPECT_THAT(program_settings_answer(result),
              HasSubstr("Free taps with delays of any number of samples would take 9"));
  control.delays = {DelayKind::dwell};
  settings.control = std::make_shared<const ControllerSettings>(control);
  EXPECT_THAT(program_settings_answer(result), HasSubstr(" Free taps would take 9 s (10.0 % less) or less."));
  // A plan of today's setting that is faster is not passed over in silence.
  result.today = 9.5;
  EXPECT_THAT(program_settings_answer(result),
              HasSubstr("Today's setting takes 9.5 s as planned here; it is the faster one, keep it."));
}

}  // namespace
}  // namespace accdec
