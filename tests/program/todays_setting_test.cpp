#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/program.hpp>
#include <accdec/task/settings_text.hpp>

#include "corner_program.hpp"
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
  settings.free_taps_limit = 10.0;
  EXPECT_THAT(program_settings_answer(result), HasSubstr("or less, as found in a search of at most 10 s."));
  settings.free_taps = 65.772;
  EXPECT_THAT(program_settings_answer(result), HasSubstr("no faster plan was found in a search of at most 10 s."));
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
              HasSubstr("its own limit of work, 8.2 s of one core; --time-limit 50 searches twice as long."));
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

/// Three averages are none of a control with two. The time of today's setting is planned again: it cannot be forged.
TEST_F(ProgramCommand, ATodayThatTheControlCannotHaveIsSaidAndItsTimeIsPlannedAgain) {
  write("part.ngc", "G21 G90 G64 P0.02 F6000\nG1 X20\nG1 Y20\nG1 X0\nM2\n");
  const std::string head =
      "sample_period_ms = 1\n[design]\norder_max = 60\n[[axis]]\nvelocity_max_mm_s = 500\n"
      "acceleration_max_mm_s2 = 6000\n[controller]\nname = \"sinumerik-840d\"\n[filter]\nkind = \"averages\"\n";
  write("t.toml", head + "lengths = [30, 10, 5]\n");
  ASSERT_EQ(run("program part.ngc --task t.toml --json r.json --figure r.html").code, 0) << read("err");
  const std::string said =
      "Today's setting is none of this control: averages of 30 ms, 10 ms and 5 ms, and the control has 2 averages.";
  EXPECT_THAT(read("out"), HasSubstr(said));
  EXPECT_THAT(read("r.html"), HasSubstr("averages of 30 ms, 10 ms and 5 ms, and the control has 2 averages."));
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  const double time = record["cycle_time_s"], today = record["settings"]["today_s"];
  EXPECT_GT(today, time);
  Output verified = run("verify r.json");
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("; planned again with today's setting, "));
  EXPECT_THAT(verified.out, testing::Not(HasSubstr("settings.today_s")));
  const double forged = today + 0.1;
  record["settings"]["today_s"] = forged;
  std::string answer = record["settings"]["answer"];
  const std::size_t from = answer.find(" Today's setting takes"), to = answer.find(said);
  answer = answer.substr(0, from) +
           fmt::format(" Today's setting takes {:.6g} s as planned here; retuning saves {:.4g} s ({}). ", forged,
                       forged - time, percent_in_words((forged - time) / forged)) +
           answer.substr(to);
  record["settings"]["answer"] = answer;
  write("forged.json", record.dump());
  verified = run("verify forged.json");
  EXPECT_EQ(verified.code, 1);
  EXPECT_THAT(verified.out, HasSubstr(fmt::format("settings.today_s is recorded as {:.9g}, planned again it is {:.9g}",
                                                  forged, today)));
  write("t.toml", head + "lengths = [30, 10]\n");
  ASSERT_EQ(run("program part.ngc --task t.toml").code, 0) << read("err");
  EXPECT_THAT(read("out"), testing::Not(HasSubstr("none of this control")));
}

/// 100 mm/s with averages of 3 and 3 ms begin at 0.1/(3 3 1e-6) m/s^3 of jerk, 22 times the bound. Kept feeds are what
/// every setting is held to: a plan that lowers them shows nothing that a new setting saves.
TEST_F(ProgramCommand, ATodayThatBreaksALimitAtTheProgrammedFeedsIsNamedAndNothingIsSaved) {
  write("part.ngc", "G21 G90 G64 P0.05 F6000\nG1 X20\nG1 Y20\nG1 X0\nM2\n");
  write("t.toml",
        "sample_period_ms = 1\n[controller]\ndelays = [\"corner-feed\", \"exact-stop\"]\n[design]\n"
        "family = \"averages\"\norder_max = 40\n[filter]\nkind = \"averages\"\nlengths = [3, 3]\n[[axis]]\n"
        "acceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n");
  ASSERT_EQ(run("program part.ngc --task t.toml --feeds keep --json r.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr(" Today's setting breaks jerk x in line 2 at the programmed feeds."));
  EXPECT_THAT(read("out"), testing::Not(HasSubstr("retuning saves")));
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  EXPECT_TRUE(record["settings"]["today_s"].is_null());
  Output verified = run("verify r.json");
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("; planned again with today's setting, which breaks jerk x in line 2"));
  // Another limit, or a time at lowered feeds, is refused.
  std::string forged = record.dump();
  for (std::size_t at = 0; (at = forged.find("jerk x in line 2")) != std::string::npos;) forged[at] = 'J';
  write("forged.json", forged);
  verified = run("verify forged.json");
  EXPECT_EQ(verified.code, 1);
  EXPECT_THAT(verified.out, HasSubstr("today_breaks is recorded as"));
  // With averages of at most 4 and 4 ms every setting does: 12.5 times the bound.
  std::string small = read("t.toml");
  write("s.toml", small.replace(small.find("= 40"), 4, "= 6"));
  ASSERT_EQ(run("program part.ngc --task s.toml --feeds keep --json s.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr(" At the programmed feeds it breaks jerk x in line 2: blocks are slowed."));
  EXPECT_EQ(run("verify s.json").code, 0);
  // Feeds that may be chosen are lowered for every setting alike.
  ASSERT_EQ(run("program part.ngc --task t.toml --json r.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("retuning saves"));
  record = nlohmann::ordered_json::parse(read("r.json"));
  EXPECT_GT(record["settings"]["today_s"], record["cycle_time_s"]);
}

/// The work of a search is counted: a clock that does not end it changes nothing.
TEST_F(ProgramCommand, ASearchForSettingsEndsAtTheSamePlace) {
  const std::string program = test_support::source_folder() + "/problems/program/engraving.ngc";
  write("t.toml",
        "sample_period_ms = 1\n[controller]\nname = \"beckhoff-nc-ptp\"\n[program]\nerror_max_um = 20\n"
        "[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\n");
  const Task task = read_task(folder_.path("t.toml"), {.require_corners = false, .axes = 9});
  const Toolpath path = read_program_file(program, task, {}, {}).path;
  const auto found = [&](const Deadline& clock) {
    Effort effort(0.05, clock);
    const ProgramFilter choice = settings_filter(path, task, true, effort, {});
    return std::pair(choice.settings, effort.ended_by_clock());
  };
  const auto [first, first_late] = found({});
  const auto [second, second_late] = found(Deadline(1e6));
  ASSERT_TRUE(first && second && !first_late && !second_late);
  EXPECT_EQ(first->tried, second->tried);
  EXPECT_EQ(first->guessed, second->guessed);
  EXPECT_EQ(first->complete, second->complete);
  EXPECT_EQ(first->search_limit, second->search_limit);
  EXPECT_EQ(first->chosen.filter.lengths, second->chosen.filter.lengths);
  EXPECT_EQ(first->width, second->width);
}

TEST_F(ProgramCommand, APlanWithoutTheSettingsOfItsTaskIsRejected) {
  write("control.toml", std::string(test::corner_machine) + "[design]\nfamily = \"averages\"\nstages = 1\n");
  write("part.ngc", test::corner_program);
  ASSERT_EQ(run("program part.ngc --task control.toml --json r.json").code, 0) << read("err");
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  record.erase("settings");
  write("forged.json", record.dump());
  const Output verified = run("verify forged.json");
  EXPECT_EQ(verified.code, 1);
  EXPECT_THAT(verified.out + verified.err, HasSubstr("the task asks for settings, none are recorded"));
}

}  // namespace
}  // namespace accdec
