#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "corner_program.hpp"
#include "program_command.hpp"

// Programs for controls that take free taps.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::HasSubstr;

TEST_F(ProgramCommand, AControlThatTakesTapsIsToldToSetThem) {
  write("part.ngc", test::corner_program);
  write("control.toml", std::string(test::corner_machine) + "[controller]\nname = \"linuxcnc\"\n");
  ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json --figure r.html").code, 0)
      << read("err");
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  const std::string answer =
      fmt::format("Set these: the {} taps that `accdec export` writes", record["filter"]["taps"].size());
  EXPECT_EQ(read("out").find(answer), 0U) << read("out");
  EXPECT_THAT(read("r.html"), HasSubstr("Set these: the "));
  EXPECT_EQ(record["settings"]["answer"].get<std::string>().find(answer), 0U);
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  record["settings"]["answer"] = "Set these: 2 taps.";
  write("forged.json", record.dump());
  const Output forged = run("verify forged.json");
  EXPECT_NE(forged.code, 0);
  EXPECT_THAT(forged.err, HasSubstr("settings.answer: is not what the other members say"));
}

/// The control waits between two blocks of one line, too, where no motion of any kind has a corner.
TEST_F(ProgramCommand, EndsOfBlocksWithoutATurnAreNoCornersOfAnyMotion) {
  write("part.ngc", "G21 G90 G64 P0.1\nG1 X10 F3000\nX25\nY20\nM2\n");
  write("control.toml", std::string(test::corner_machine) +
                            "[controller]\ndelays = \"in-position\"\n[filter]\nkind = \"boxcar\"\norder = 24\n");
  ASSERT_EQ(run("program part.ngc --task control.toml --json r.json").code, 0) << read("err");
  EXPECT_EQ(nlohmann::json::parse(read("r.json"))["corner_bound"]["corners"], 1);
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
}

/// A filter that the task gives is set by the times that it was given by, whatever its family.
TEST_F(ProgramCommand, AGivenFilterIsSetByItsTimes) {
  write("part.ngc", test::corner_program);
  const std::pair<const char*, const char*> given[]{
      {"kind = \"averages\"\nlengths = [18, 12, 1]\n", "averages of 18 ms and 12 ms (the 29 taps"},
      {"kind = \"trapezoid\"\norder = 28\nramp = 11\n", "averages of 18 ms and 12 ms (the 29 taps"},
      {"kind = \"boxcar\"\norder = 24\n", "one average of 25 ms (the 25 taps"},
      {"kind = \"averages\"\nlengths = [18]\nshaper = \"zv\"\nshaper_delay = 12.5\n",
       "one average of 18 ms, ZV at 40 Hz (impulses 12.5 samples apart) (the 31 taps"},
      {"kind = \"hann\"\norder = 30\n", "a Hann filter of 31 ms (the 31 taps"},
      {"kind = \"gaussian\"\norder = 29\nalpha = 2.4\n", "a Gaussian of 30 ms, alpha 2.4 (the 30 taps"},
      {"kind = \"blackman-sinc\"\norder = 30\ncutoff = 0.05\n", "a windowed sinc of 31 ms, cut-off 25 Hz (the 31 taps"},
      {"kind = \"exponential\"\norder = 39\nratio = 0.8\n",
       "an exponential of 40 ms, time constant 4.48142012 ms (the 40 taps"},
      {"kind = \"taps\"\ntaps = [0.1, 0.2, 0.3, 0.4]\n", "the 4 taps"}};
  for (const std::string control : {"name = \"linuxcnc\"\n", "delays = \"in-position\"\n"}) {
    for (const auto& [filter, words] : given) {
      write("control.toml", fmt::format("{}[controller]\n{}[filter]\n{}", test::corner_machine, control, filter));
      run("program part.ngc --feeds keep --task control.toml --json r.json");
      const auto record = nlohmann::json::parse(read("r.json"));
      const bool width = control.starts_with("delays");
      // One width for all corners is more than the shortest filters have.
      if (width && record["status"] == "failed") continue;
      const std::string answer = record["settings"]["answer"];
      EXPECT_THAT(answer, testing::StartsWith(fmt::format("Set these: {} that `accdec export` writes", words)));
      const Output verified = run("verify r.json");
      EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
    }
  }
}

/// Today's setting, given as the filter, takes the time that is said of it beside another one.
TEST_F(ProgramCommand, TapsOfAControlAreComparedWithTodaysSetting) {
  write("part.ngc", test::corner_program);
  const std::string today = "kind = \"averages\"\nlengths = [32, 32]\n",
                    given = "kind = \"averages\"\nlengths = [18, 12]\n";
  for (const std::string control :
       {"name = \"linuxcnc\"\n", "delays = \"in-position\"\n", "delays = [\"corner-feed\", \"in-position\"]\n"}) {
    const std::string head = std::string(test::corner_machine) + "[controller]\n" + control;
    write("today.toml", head + "[filter]\n" + today);
    ASSERT_EQ(run("program part.ngc --task today.toml --json today.json").code, 0) << read("err");
    const auto old = nlohmann::json::parse(read("today.json"));
    EXPECT_FALSE(old.contains("today_s") || (old.contains("settings") && old["settings"].contains("today_s")));
    for (const std::string& filter : {std::string(), "[filter]\n" + given}) {
      write("control.toml", head + "[baseline]\n" + today + filter);
      ASSERT_EQ(run("program part.ngc --task control.toml --json r.json --figure r.html").code, 0) << read("err");
      const auto record = nlohmann::json::parse(read("r.json"));
      const double time = record["cycle_time_s"], before = record["settings"]["today_s"];
      EXPECT_NEAR(before, old["cycle_time_s"].get<double>(), 1e-9) << control << filter;
      // Taps designed for any delays need not suit a control that waits in-position at every end: averages may.
      EXPECT_LE(time, before + 1e-9) << control << filter;
      const std::string saved =
          fmt::format("retuning saves {:.4g} s ({:.1f} %).", before - time, 100.0 * (1.0 - time / before));
      EXPECT_THAT(read("out"),
                  HasSubstr(fmt::format("Today's setting takes {:.6g} s as planned here; {}", before, saved)));
      EXPECT_THAT(read("r.html"), HasSubstr("retuning saves"));
      const Output verified = run("verify r.json");
      EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
      EXPECT_EQ(record["filter"]["taps"].size() == 29U, !filter.empty()) << "the task's own";
    }
  }
}

TEST_F(ProgramCommand, ATimeOfTodayBelowTheBoundOfAnyMotionIsRejected) {
  write("part.ngc", test::corner_program);
  write("control.toml", std::string(test::corner_machine) +
                            "[controller]\nname = \"linuxcnc\"\n[baseline]\nkind = \"averages\"\nlengths = [18, 12]\n");
  ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json").code, 0) << read("err");
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  const std::string answer = record["settings"]["answer"];
  const double forged = 0.99 * record["lower_bound_s"].get<double>();
  record["settings"]["today_s"] = forged;
  write("forged.json", record.dump());
  EXPECT_THAT(run("verify forged.json").err, HasSubstr("answer: is not what the other members say"));
  record["settings"]["answer"] =
      fmt::format("{} Today's setting takes {:.6g} s as planned here; it is the faster one, keep it.\n",
                  answer.substr(0, answer.find(" Today's")), forged);
  write("forged.json", record.dump());
  const Output verified = run("verify forged.json");
  EXPECT_EQ(verified.code, 1);
  EXPECT_THAT(verified.out, HasSubstr("today_s is below the bound of any motion"));
  EXPECT_EQ(verified.out.find("answer is not"), std::string::npos) << verified.out;
}

/// Each kind that is recorded must be one of the control's, and do what the plan does.
TEST_F(ProgramCommand, ForgedDelaysOfTapsAreRejected) {
  write("part.ngc", test::corner_program);
  write("control.toml",
        std::string(test::corner_machine) + "[controller]\ndelays = [\"corner-feed\", \"in-position\"]\n");
  ASSERT_EQ(run("program part.ngc --task control.toml --json r.json").code, 0) << read("err");
  const nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  const auto& kinds = record["settings"]["delays"];
  const auto slow = std::find(kinds.begin(), kinds.end(), "corner-feed");
  ASSERT_NE(slow, kinds.end()) << kinds.dump();
  nlohmann::ordered_json forged = record;
  forged["settings"]["delays"][static_cast<std::size_t>(slow - kinds.begin())] = "dwell";
  write("forged.json", forged.dump());
  EXPECT_THAT(run("verify forged.json").err, HasSubstr("settings.answer: is not what the other members say"));
  // With an answer in words that counts as it does.
  std::string answer = record["settings"]["answer"];
  const auto count = std::count(kinds.begin(), kinds.end(), "corner-feed");
  const std::size_t at = answer.find(fmt::format("; corner-feed at {} joints", count));
  ASSERT_TRUE(count > 2 && at != std::string::npos) << answer;
  answer.replace(at, answer.find(" joints", at) - at, fmt::format("; corner-feed at {}", count - 1));
  forged["settings"]["answer"] = answer;
  write("forged.json", forged.dump());
  const Output verified = run("verify forged.json");
  EXPECT_EQ(verified.code, 1) << verified.err;
  EXPECT_THAT(verified.out, HasSubstr("the control has no delay of kind dwell"));
}

}  // namespace
}  // namespace accdec
