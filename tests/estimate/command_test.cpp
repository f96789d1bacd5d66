#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program/program_command.hpp"

namespace {

using accdec::test::Output;
using testing::HasSubstr;

class EstimateCommand : public accdec::test::ProgramCommand {
 protected:
  void SetUp() override {
    ProgramCommand::SetUp();
    // 100 mm at 100 mm/s and 6000 mm/s^2, from rest to rest.
    write("part.ngc", "G21 G90 G61.1\nG1 X100 F6000\nM2\n");
  }
  Output estimate(const std::string& words) const {
    return run("program part.ngc --task task.toml --json r.json " + words);
  }
};

constexpr double time = 1.0 + 100.0 / 6000.0;

TEST_F(EstimateCommand, IsInTheSummaryAndInTheResult) {
  const Output done = estimate("--as klipper --as grbl --as linuxcnc-2.9 --as-option square_corner_velocity=8");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("klipper would take 1.0167 s: an estimate with max_velocity 500 mm/s"));
  EXPECT_THAT(done.out, HasSubstr("square_corner_velocity 8 mm/s"));
  EXPECT_THAT(done.out, HasSubstr("grbl would take 1.0167 s"));
  EXPECT_THAT(done.out, HasSubstr("linuxcnc-2.9 would take 1.0167 s"));
  EXPECT_THAT(done.out, HasSubstr("klipper does not know the jerk limit"));
  EXPECT_NEAR(number_of("r.json", "time_s"), time, 1.0);
  EXPECT_THAT(read("r.json"), HasSubstr("\"estimates\": ["));
  EXPECT_THAT(read("r.json"), HasSubstr("\"from\": \"given\""));
}

TEST_F(EstimateCommand, IsVerifiedFromTheProgram) {
  ASSERT_EQ(estimate("--as grbl --as-option junction_deviation=0.05").code, 0);
  EXPECT_EQ(run("verify r.json").code, 0);
  const std::string text = read("r.json");
  const auto forge = [&](const std::string& what, const std::string& with) {
    std::string forged = text;
    const std::size_t at = forged.find(what, forged.find("\"estimates\""));
    ASSERT_NE(at, std::string::npos) << what;
    write("forged.json", forged.replace(at, what.size(), with));
    const Output done = run("verify forged.json");
    EXPECT_EQ(done.code, 1) << what << done.out << done.err;
    EXPECT_THAT(done.out, HasSubstr("estimates")) << what;
  };
  forge("\"time_s\": 1.", "\"time_s\": 0.");
  forge("\"value\": 250.0", "\"value\": 251.0");
  forge("\"control\": \"grbl\"", "\"control\": \"gerbil\"");
  forge("\"the jerk limit\"", "\"nothing\"");
}

TEST_F(EstimateCommand, RefusesMistakesBeforeItPlans) {
  const auto refused = [&](const std::string& words, const std::string& says) {
    const Output done = estimate(words);
    EXPECT_EQ(done.code, 2) << words;
    EXPECT_THAT(done.err, HasSubstr(says)) << words;
    EXPECT_EQ(done.out, "") << words;
  };
  refused("--as kliper", "klipper");
  refused("--as-option resolution=1", "--as");
  refused("--as klipper --as-option resolution", "--as-option takes NAME=NUMBER, got \"resolution\"");
  refused("--as klipper --as-option resolution=one", "--as-option takes NAME=NUMBER");
  refused("--as klipper --as-option resolution=nan", "--as-option takes NAME=NUMBER");
  refused("--as klipper --as-option junction_deviation=1", "parameter of klipper");
  refused("--as grbl --as-option junction_deviation=-1", "junction_deviation of grbl is -1; allowed is 0 to 1000 mm");
  refused("--as grbl --dwells-before-filter", "--as excludes --dwells-before-filter");
  write("part.ngc", "G21 G90 G61.1\nG1 A100 F6000\nM2\n");
  write("task.toml",
        "sample_period_ms = 1.0\n[[axis]]\nname = \"a\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\n");
  refused("--as grbl", "the estimate for grbl knows moves of X, Y and Z only; the program also moves A");
}

}  // namespace
