// Programs of users that are written for other controls.

#include <cstdlib>

#include <gmock/gmock.h>

#include <accdec/gcode/dialects.hpp>

#include "program_command.hpp"

namespace accdec::test {
namespace {

using testing::HasSubstr;

TEST(ForeignWords, AreNamedWithTheirDialect) {
  EXPECT_THAT(foreign_words("N10 G68 X0 Y0 R30"), HasSubstr("FANUC, HEIDENHAIN and Mach G68 turns the coordinates"));
  EXPECT_THAT(foreign_words("g 16"), HasSubstr("G16 starts polar coordinates"));
  EXPECT_THAT(foreign_words("IF[#1EQ0]GOTO10"), HasSubstr("FANUC IF["));
  EXPECT_THAT(foreign_words("while [#1 lt 5] do1"), HasSubstr("O100 while"));
  EXPECT_THAT(foreign_words("G1 X50. ,R2."), HasSubstr("rounds a corner"));
  EXPECT_THAT(foreign_words("$H"), HasSubstr("GRBL"));
  EXPECT_THAT(foreign_words("%TEST G71 *"), HasSubstr("HEIDENHAIN ISO"));
  EXPECT_THAT(foreign_words("G83 X10 Z-9 R2 Q3 K2"), HasSubstr("FANUC G83 repeats the cycle K times: write L"));
  EXPECT_EQ(foreign_words("G83 X10 Z-9 R2 Q3 L2"), "");
  EXPECT_THAT(foreign_words("M97 P100"), HasSubstr("Haas M97"));
  EXPECT_THAT(foreign_words("G150 P1"), HasSubstr("Haas G150 mills a pocket: let the post-processor"));
  EXPECT_THAT(foreign_words("N40 G98 L1 *"), HasSubstr("HEIDENHAIN ISO G98L begins a subroutine"));
  EXPECT_EQ(foreign_words("G98 G81 X1 Z-1 R1 L3"), "");
  EXPECT_THAT(foreign_words("G200 Q200=2"), HasSubstr("HEIDENHAIN ISO Q200= defines a cycle"));
  EXPECT_THAT(foreign_words("D00 Q1 P01 +5"), HasSubstr("LinuxCNC writes #1 = 5"));
  EXPECT_THAT(foreign_words("BEGIN PGM TEST MM"), HasSubstr("have it written in ISO"));
  EXPECT_THAT(foreign_words("5 L X+10 Y+10 F600"), HasSubstr("HEIDENHAIN's own language L moves along a line"));
  EXPECT_THAT(foreign_words("C X+10 Y+0 DR-"), HasSubstr("HEIDENHAIN's own language DR-"));
  EXPECT_THAT(foreign_words("M104 S200"), HasSubstr("Klipper"));
  EXPECT_THAT(foreign_words("G51 X0 Y0 P2"), HasSubstr("let the post-processor write moves without it"));
}

TEST(ForeignWords, AreNoWordsOfLinuxcncAndNoComments) {
  for (const char* own :
       {"G1 X1 (G68 turns)", "G61.1", "G6", "G680", "G16.5", "G5 X1 Y1 P1 Q1", "G5.1 I1 J1 X1 Y1", "G8", "G4 P1",
        "G30 Z1", "G10 L2 P1 X0", "O100 if [#1 EQ 0]", "O100 while [#<goto> LT 5]", "%", "; $H", "M10", ""})
    EXPECT_EQ(foreign_words(own), "") << own;
}

TEST_F(ProgramCommand, WordsOfOtherControlsAreRefusedByTheirDialect) {
  const auto refused = [&](const char* text, const char* place, const char* what) {
    write("part.ngc", std::string("G21 G90 F600\nG1 X5\n") + text + "\nM30\n");
    EXPECT_EQ(run("program part.ngc --task task.toml --json r.json").code, 2) << text;
    EXPECT_THAT(read("err"), HasSubstr(place));
    EXPECT_THAT(read("err"), HasSubstr(what));
  };
  refused("G68 X0 Y0 R30", "part.ngc:3:1: neither accdec nor LinuxCNC reads this: ", "LinuxCNC writes G10 L2 P1 R");
  refused("G31 Z-5", "part.ngc:3:1: ", "moves until a probe touches: such moves cannot be planned by time");
  refused("X9 M104", "part.ngc:3:4: ", "in the dialect of Marlin and Klipper");
  refused("$J=G91 X10", "part.ngc:3:1: '$' is no word", "in the dialect of GRBL");
  refused("L X+10 Y+10 F600", "part.ngc:3:1: word L has no number", "in the dialect of HEIDENHAIN's own language L");
  refused("G05.1 Q1", "part.ngc:3:1: G5.1 needs both I and J", "FANUC G5.1 switches look-ahead");
  refused("G4 X1.5", "part.ngc:3:1: G4 needs its time in P, in seconds", "FANUC G4 dwells by X");
}

TEST_F(ProgramCommand, FeedsOfZeroAreNoMissingFeeds) {
  const auto refused = [&](const char* text, const char* what) {
    write("part.ngc", std::string("G21 G90\n") + text + "\nM30\n");
    EXPECT_EQ(run("program part.ngc --task task.toml").code, 2) << text;
    EXPECT_THAT(read("err"), HasSubstr(what)) << text;
  };
  for (const char* zero : {"G1 X10 F0", "F0\nG2 X2 I1"}) refused(zero, "the feed is zero: F must be greater");
  for (const char* none : {"G1 X10", "F0 G94\nG94\nG1 X10"}) refused(none, "no feed: an F word must come before");
}

TEST_F(ProgramCommand, DwellsThatMayBeMeantInMillisecondsAreNamed) {
  write("part.ngc", "G21 G90 F600\nG1 X5\nG4 P500\nX10\nM30\n");
  EXPECT_EQ(run("program part.ngc --task task.toml").code, 0);
  EXPECT_THAT(read("err"), HasSubstr("part.ngc: a G4 dwells 500 s; FANUC, Haas and Marlin read P as ms"));
}

class UsersPrograms : public ProgramCommand {
 protected:
  void SetUp() override {
    if (std::system("command -v rs274 > /dev/null") != 0) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
    ProgramCommand::SetUp();
  }
  double seconds_of(const std::string& text) {
    write("part.ngc", "G21 G90 G17 G61 F600\nG0 Z5\n" + text + "M2\n");
    EXPECT_EQ(run("program part.ngc --task task.toml --json r.json").code, 0) << text << read("err");
    EXPECT_EQ(run("verify r.json").code, 0) << text << read("out") << read("err");
    return number_of("r.json", "cycle_time_s");
  }
};

// Every cycle takes as long as its moves, written out by the manual of LinuxCNC.
TEST_F(UsersPrograms, CyclesTakeAsLongAsTheirMoves) {
  const std::string there = "G0 X10 Y10\nZ2\n";
  const std::string pecks = "G1 Z1\nG0 Z1.254\nG1 Z0\nG0 Z0.254\nG1 Z-1\n";
  const std::string deep = "G1 Z1\nG0 Z2\nZ1.254\nG1 Z0\nG0 Z2\nZ0.254\nG1 Z-1\n";
  const auto same = [&](const char* cycle, const std::string& moves) {
    EXPECT_NEAR(seconds_of(std::string("G98 ") + cycle + "\nG80\n"), seconds_of(there + moves), 6e-3) << cycle;
  };
  same("G73 X10 Y10 Z-1 R2 Q1", pecks + "G0 Z5\n");
  same("G81 X10 Y10 Z-3 R2", "G1 Z-3\nG0 Z5\n");
  same("G82 X10 Y10 Z-3 R2 P0.2", "G1 Z-3\nG4 P0.2\nG0 Z5\n");
  same("G83 X10 Y10 Z-1 R2 Q1", deep + "G0 Z5\n");
  same("G85 X10 Y10 Z-3 R2", "G1 Z-3\nZ2\nG0 Z5\n");
  same("G89 X10 Y10 Z-3 R2 P0.2", "G1 Z-3\nG4 P0.2\nG1 Z5\n");
}

TEST_F(UsersPrograms, SubroutinesParametersAndRotationsTakeAsLongAsTheirMoves) {
  const double twice = seconds_of("G91\nG1 X10\nY10\nX10\nY10\n");
  EXPECT_NEAR(seconds_of("O100 sub\nG91\nG1 X10\nY10\nO100 endsub\nO100 call\nO100 call\n"), twice, 2e-3);
  EXPECT_NEAR(seconds_of("#1=10\nG91\nG1 X#1\nY[#1]\nX[#1*1]\nY[2*#1-10]\n"), twice, 2e-3);
  EXPECT_NEAR(seconds_of("M98 P100 L2\nM2\nO100\nG91\nG1 X10\nY10\nM99\n"), twice, 2e-3);
  EXPECT_NEAR(seconds_of("G10 L2 P1 R90\nG1 X10\nY10\n"), seconds_of("G1 Y10\nX-10\n"), 2e-3);
  EXPECT_NEAR(seconds_of("G1 X10\nG28\nG1 X5\n"), seconds_of("G1 X10\nG0 X0 Y0 Z0\nG1 X5\n"), 2e-3);
}

}  // namespace
}  // namespace accdec::test
