// Programs that LinuxCNC's rs274 reads for us. If it is not installed, they are skipped.

#include <cstdlib>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <accdec/gcode/run_rs274.hpp>
#include <accdec/simulate.hpp>

#include "program_command.hpp"

namespace accdec::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Interpreter : public ProgramCommand {
 protected:
  void SetUp() override {
    if (std::system("command -v rs274 > /dev/null") != 0) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
    ProgramCommand::SetUp();
  }
  double seconds_of(const std::string& name, const std::string& text, const std::string& options = "") {
    write(name, text);
    EXPECT_EQ(run("program " + name + " --task task.toml --json r.json " + options).code, 0) << read("err");
    EXPECT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
    return number_of("r.json", "cycle_time_s");
  }
  /// The largest tolerance of a result's corners, m.
  double tolerance_of(const std::string& name) {
    const nlohmann::json result = nlohmann::json::parse(read(name));
    double largest = 0.0;
    for (const auto& corner : result.at("worst_corners"))
      largest = std::max(largest, corner.at("error_max_m").get<double>());
    return largest;
  }
};

TEST(NumberedLines, HaveTheirNumberAsTheirNWord) {
  EXPECT_EQ(numbered_lines("%\nG1 X1\n N20 G1 X2\r\n(only a comment)\n; one more\n/G1 X9\no100 sub\n\nn3X4"),
            "%\nN0000000002G1 X1\nN0000000003G1 X2\n(only a comment)\n; one more\n\no100 sub\n\nN0000000009X4\n");
  const std::string longest(244, ' ');
  EXPECT_EQ(numbered_lines("X1" + longest), "X1" + longest + "\n") << "rs274 reads no more than 255 characters";
}

// A cycle takes as long as its moves written out.
TEST_F(Interpreter, CyclesOffsetsAndHomesAreThoseWrittenOut) {
  const std::string start = "G21 G90 G17 G61 F300\nG0 Z5\n";  // in force inside cycles
  const std::string by_hand = "G0 X10 Y10\nZ2\nG1 Z-3\nG0 Z5\nX30\nZ2\nG1 Z-3\nG0 Z5\n";
  EXPECT_NEAR(seconds_of("cycle.ngc", start + "G98 G81 X10 Y10 Z-3 R2\nX30\nG80\nM2\n"),
              seconds_of("hand.ngc", start + by_hand + "M2\n"), 2e-3);
  const std::string plain = "G0 X10\nG1 X20 Y5\nY20\n";
  const double time = seconds_of("plain.ngc", start + plain + "M2\n");
  for (const char* same : {"G0 X10\nG92 X0\nG1 X10 Y5\nG92.1\nY20\n", "G0 X10\nG10 L2 P1 X10 Y5\nG1 X10 Y0\nY15\n",
                           "G0 X10\nG53 G1 X20 Y5\nY20\n", "G0 X10\nM70\nG1 X20 Y5\nM72\nY20\n"}) {
    EXPECT_NEAR(seconds_of("same.ngc", start + same + "M2\n"), time, 2e-3) << same;
  }
}

// rs274 prints the number of G64 P again behind a cycle, whatever unit is in force then.
TEST_F(Interpreter, TheToleranceBehindACycleHasTheUnitOfItsG64) {
  const std::string moves = "F1000\nG1 X1\nY1\nX2\nM2\n";
  const std::string cycle = "G81 X0 Y0 Z-.1 R0 F60\nG80\n";
  seconds_of("by-mm.ngc", "G21 G64 P0.05\nG20 G90\n" + cycle + moves);
  EXPECT_NEAR(tolerance_of("r.json"), 50e-6, 1e-12);
  seconds_of("by-inch.ngc", "G20 G64 P0.002\nG21 G90\n" + cycle + moves);
  EXPECT_NEAR(tolerance_of("r.json"), 50.8e-6, 1e-12);
  seconds_of("again.ngc", "G21 G64 P0.05\nG20 G90 G61\n" + cycle + "G64 P0.05\n" + moves);
  EXPECT_NEAR(tolerance_of("r.json"), 1.27e-3, 1e-12);
}

TEST_F(Interpreter, LinesAreThoseOfTheProgram) {
  write("part.ngc",
        "%\n(a part)\nN900 G21 G90 G61.1 F600\n\no100 repeat [2]\n  G91 G1 X1 ; twice\no100 endrepeat\n"
        "G90\n/G1 X500\nN10 Y60000 F60000\nG1 A3\nM2\n%\n");
  EXPECT_EQ(run("program part.ngc --task task.toml").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("part.ngc:11:1: axis A is not among the axes of the task"));
  write("bad.ngc", "G21 F100\no100 if [1]\nG1 X[1\no100 endif\nM2\n");
  EXPECT_EQ(run("program bad.ngc --task task.toml").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("bad.ngc:3:1: refused by rs274: "));
  write("both.ngc", "G21 G61.1 F60000\nG81 X1 Y1 Z-1 R1\nG80\nG1 X50\nM2\n");
  EXPECT_EQ(run("program both.ngc --task task.toml").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("lines, the first 2"));
}

// A second % ends a program, too.
TEST_F(Interpreter, PolarCoordinatesAndProgramsWithoutM2AreRead) {
  const std::string start = "G21 G90 G61 F600\n";
  const double by_hand = seconds_of("hand.ngc", "%\n" + start + "G1 X10 Y0\nX0 Y10\nX-10 Y0\nM2\n%\n");
  EXPECT_NEAR(seconds_of("polar.ngc", "%\n" + start + "G1 @10 ^0\n^90\n^180\n%\n"), by_hand, 2e-3);
}

TEST_F(Interpreter, AFileIsNeverAnOptionOfIts) {
  write("-g.ngc", "G21 G61.1 F600\n#1=5\nG1 X#1\nM2\n");
  EXPECT_EQ(run("program --task task.toml --json r.json -- -g.ngc").code, 0) << read("err");
  EXPECT_EQ(number_of("r.json", "blocks"), 1);
}

TEST_F(Interpreter, LengthsAndDiametersComeFromATableThatIsGiven) {
  const std::string start = "G21 G90 G61.1 F300\n#1=1\nG0 Z10\n";
  const std::string plunge = "G43 H1\nG1 Z-5\nM2\n";
  write("length.ngc", start + plunge);
  EXPECT_EQ(run("program length.ngc --task task.toml").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("length.ngc:4:1: G43 takes the length of a tool"));
  EXPECT_THAT(read("err"), HasSubstr("--tool-table FILE; or --tool-length 0"));
  const double tip = seconds_of("tip.ngc", start + "G1 Z-5\nM2\n");
  EXPECT_NEAR(seconds_of("length.ngc", start + plunge, "--tool-length 0"), tip, 2e-3);
  // A tool of 4 mm: its tip is 4 mm lower, and has so much less to go.
  write("tools.tbl", "T1 P1 Z4 D6\n");
  const double shorter = seconds_of("tip.ngc", start + "G1 Z-1\nM2\n");
  EXPECT_NEAR(seconds_of("length.ngc", start + plunge, "--tool-table tools.tbl"), shorter, 2e-3);
  EXPECT_NEAR(seconds_of("length.ngc", start + plunge, "--tool-length 4"), shorter, 2e-3);
  write("inch.tbl", "t1 p1 z+0.15748 d.25 ; 4 mm\n");
  EXPECT_NEAR(seconds_of("length.ngc", start + plunge, "--tool-table inch.tbl --tool-table-inch"), shorter, 2e-3);
  EXPECT_NEAR(seconds_of("own.ngc", start + "G43.1 Z4\nG1 Z-5\nM2\n"), shorter, 2e-3);
  EXPECT_NE(run("program length.ngc --task task.toml --tool-length 0 --tool-table tools.tbl").code, 0);

  const std::string around = "G1 X20 Y20\nX40\nY60\nG40\nG1 X60\nM2\n";
  write("radius.ngc", "G21 G90 G61.1 F300\nG41 D1\n" + around);
  EXPECT_EQ(run("program radius.ngc --task task.toml --tool-length 0").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("radius.ngc:2:1: G41 and G42 take the diameter of a tool"));
  const double by_table = seconds_of("radius.ngc", read("radius.ngc"), "--tool-table tools.tbl");
  EXPECT_EQ(by_table, seconds_of("word.ngc", "G21 G90 G61.1 F300\nG41.1 D6\n" + around));
}

// rs274 reads such a subroutine by itself: its lines have no numbers of the program.
TEST_F(Interpreter, SubroutinesInFilesOfTheirOwnTakeNoToolThatNobodyGave) {
  const std::string start = "G21 G90 G61.1 F300\n", call = start + "o<pick> call\nG1 Z-5\nM2\n";
  const double tip = seconds_of("tip.ngc", start + "G1 Z-5\nM2\n");
  write("pick.ngc", "o<pick> sub\nG43 H1\no<pick> endsub\nM2\n");
  write("part.ngc", call);
  EXPECT_EQ(run("program part.ngc --task task.toml --json none.json").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("part.ngc: a subroutine in a file of its own: G43 takes the length of a tool"));
  EXPECT_THAT(read("err"), HasSubstr("--tool-table FILE; or --tool-length 0"));
  EXPECT_EQ(read("none.json"), "");
  EXPECT_NEAR(seconds_of("part.ngc", call, "--tool-length 0"), tip, 2e-3);
  write("pick.ngc", "o<pick> sub\nG41 D1\no<pick> endsub\nM2\n");
  write("part.ngc", start + "o<pick> call\nG1 X20 Y20\nX40\nY60\nG40\nG1 X60\nM2\n");
  EXPECT_EQ(run("program part.ngc --task task.toml").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("a subroutine in a file of its own: G41 and G42 take the diameter of a tool"));
  // The parameters that hold the tool's length are named where they stand.
  write("pick.ngc", "o<pick> sub\nT1 M6\nG1 Z[#5403]\no<pick> endsub\nM2\n");
  EXPECT_EQ(run("program part.ngc --task task.toml --json none.json").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("pick.ngc:3:6: #5401 to #5413 are lengths and diameters of a tool"));
}

// Offsets are in the coordinates and their words are gone: whoever runs the program must not let them act again.
TEST_F(Interpreter, AnEmittedProgramSaysWhichOffsetsAreInItsCoordinates) {
  write("tools.tbl", "T1 P1 Z30\n");
  write("part.ngc", "G21 G90 G61 F300\nG10 L2 P1 X100\nT1 M6\nG0 G43 H1 Z10\nG1 X5\nM2\n");
  const std::string in = "(tool lengths by G43 are in the coordinates",
                    out = "(tool lengths are not in the coordinates";
  for (const bool by_table : {true, false}) {
    const std::string tools = by_table ? " --tool-table tools.tbl" : " --tool-length 0";
    ASSERT_EQ(run("program part.ngc --feeds keep --task task.toml --emit e.ngc" + tools).code, 0) << read("err");
    const std::string text = read("e.ngc");
    EXPECT_THAT(text, ::testing::ContainsRegex(by_table ? "Z40[ \n]" : "Z10[ \n]"));
    EXPECT_THAT(text, HasSubstr("G1 X105"));
    EXPECT_THAT(text, HasSubstr("(offsets that the program sets"));
    EXPECT_EQ(text.find(in) != std::string::npos, by_table) << text;
    EXPECT_EQ(text.find(out) != std::string::npos, !by_table) << text;
    ASSERT_EQ(run("program e.ngc --feeds keep --dwells-before-filter --task task.toml --emit again.ngc").code, 0);
    const std::string again = read("again.ngc");
    EXPECT_THAT(again, HasSubstr(by_table ? in : out));
    EXPECT_EQ(again.find("(offsets that"), again.rfind("(offsets that")) << "said once, however often it is written";
  }
}

TEST_F(Interpreter, RefusalsAreInTheWordsOfTheProgram) {
  const std::string parameter = "G21 G61.1 F300\n#1=1\n";
  const auto refused = [&](const std::string& lines, const std::string& message) {
    write("part.ngc", parameter + lines + "M2\n");
    EXPECT_EQ(run("program part.ngc --task task.toml").code, 2) << lines;
    EXPECT_THAT(read("err"), HasSubstr(message));
    EXPECT_THAT(read("err"), Not(HasSubstr(".part")));
    EXPECT_THAT(read("err"), Not(HasSubstr("STRAIGHT_TRAVERSE")));
  };
  refused("M98 P100\n", "EOF in file:part.ngc");
  refused("G38.2 Z-5\n", "part.ngc:3:1: G38.2 to G38.5 end where the probe touches");
  refused("G17.1\nG1 X1\n", "part.ngc:3:1: G17.1, G18.1 and G19.1");
  refused("G[4+1] X#1 Y2 I1 J1 P1 Q1\n", "part.ngc:3:1: rs274 prints G5 to G5.3");
}

TEST_F(Interpreter, OneLengthForEveryToolLeavesNoneToTheProgram) {
  for (const char* set : {"L1 P1 Z10", "L10 P1 Z10", "L11 P1 Z10"}) {
    write("part.ngc", std::string("G21 G90 G61.1 F300\nT1 M6\nG10 ") + set + "\nG43\nG1 Z-5\nM2\n");
    EXPECT_EQ(run("program part.ngc --task task.toml --tool-length 0").code, 2) << set;
    EXPECT_THAT(read("err"), HasSubstr("part.ngc:3:1: G10 L1, L10 and L11 set tools"));
  }
  write("tools.tbl", "T1 P1 Z4\n");
  EXPECT_EQ(run("program part.ngc --task task.toml --tool-table tools.tbl").code, 0) << read("err");
}

TEST_F(Interpreter, ATableIsUsedWhereAProgramTakesItsLengths) {
  write("tools.tbl", "T1 P1 Z4\n");
  const std::string start = "G21 G90 G61.1 F300\nG0 Z5\n";
  const std::string text = start + "G43 H1\nG1 Z-1\nM2\n";
  const double tip = seconds_of("tip.ngc", start + "G1 Z-1\nM2\n"),
               longer = seconds_of("to.ngc", start + "G1 Z3\nM2\n");
  EXPECT_NEAR(seconds_of("part.ngc", text, "--tool-table tools.tbl"), longer, 2e-3);
  EXPECT_NEAR(seconds_of("part.ngc", text, "--tool-length 4"), longer, 2e-3);
  EXPECT_NEAR(seconds_of("part.ngc", text, "--tool-length 0"), tip, 2e-3);
  EXPECT_THAT(read("err"), Not(HasSubstr("count as 0")));
}

TEST_F(Interpreter, WordsOfWorkOffsetsThatAreLeftOutAreNamed) {
  write("part.ngc", "G21 G90 G61.1 F300\n#1=5\nG1 X#1\nG55\nG1 X9\nG56 G1 X3\nM2\n");
  ASSERT_EQ(run("program part.ngc --task task.toml --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("err"), HasSubstr("part.ngc:4: G55 selects a second work offset"));
  EXPECT_THAT(read("err"), HasSubstr("--emit leaves out G55 G56\n"));
  EXPECT_THAT(read("e.ngc"), HasSubstr("(left out of the program: G55 G56;"));
  EXPECT_THAT(read("e.ngc"), HasSubstr("(work offsets: line 4 selects G55;"));
}

TEST_F(ProgramCommand, WhatActsOnTheMachineAloneIsSaid) {
  const std::string start = "G21 G90 G61.1 F300\n";
  write("part.ngc", start + "G0 Z5\nG43 H1\nG55\nG1 Z-1\nG54 X1\nM2\n");
  ASSERT_EQ(run("program part.ngc --task task.toml --emit e.ngc").code, 2) << "no rs274 is needed for this";
  EXPECT_THAT(read("err"), HasSubstr("part.ngc:3:1: G43 takes the length of a tool"));
  EXPECT_THAT(read("err"), HasSubstr("--tool-table FILE; or --tool-length 0"));
  ASSERT_EQ(run("program part.ngc --task task.toml --tool-length 0 --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("err"), HasSubstr("part.ngc:4: G55 selects a second work offset"));
  const std::string text = read("e.ngc");
  for (const char* words : {"(G43: lengths", "(work offsets: line 4 selects G55;", "G43 H1\n", "G55\n", "G54\n"})
    EXPECT_THAT(text, HasSubstr(words));
  ASSERT_EQ(run("program e.ngc --task task.toml --dwells-before-filter --tool-length 0 --emit again.ngc").code, 0)
      << read("err");
  const std::string again = read("again.ngc");
  EXPECT_EQ(again.find("(work offsets"), again.rfind("(work offsets")) << "said once, however often it is written";
  EXPECT_NE(again.find("(work offsets: line 4"), std::string::npos);
  write("tools.tbl", "T1 P1 Z4\n");
  write("part.ngc", start + "G55\nG43 H0\nG1 Z-1\nG55 X1\nM2\n");
  ASSERT_EQ(run("program part.ngc --task task.toml").code, 0) << read("err");
  EXPECT_EQ(read("err").find("part.ngc:"), std::string::npos) << "one system, and no length";
  ASSERT_EQ(run("program part.ngc --task task.toml --tool-table tools.tbl").code, 0) << read("err");
  EXPECT_THAT(read("err"), HasSubstr("tools.tbl: not used"));
}

// rs274 has tools of its own, and gives these parameters in inch: Z#5403 would go to 0.511 mm.
TEST_F(ProgramCommand, ParametersOfAToolNeedATableInInch) {
  write("tools.tbl", "T1 P1 Z4\n");
  const auto refused = [&](const std::string& lines, const std::string& place) {
    write("part.ngc", "G21 G64 P0.01\nF600\nT1 M6\n" + lines + "G1 X10\nM2\n");
    for (const char* tools : {"", " --tool-length 0", " --tool-table tools.tbl"}) {
      EXPECT_EQ(run(std::string("program part.ngc --task task.toml") + tools).code, 2) << lines << tools;
      EXPECT_THAT(read("err"), HasSubstr("part.ngc:" + place + ": #5401 to #5413 are lengths and diameters of a tool"));
      EXPECT_THAT(read("err"), HasSubstr("--tool-table FILE --tool-table-inch"));
    }
  };
  refused("G1 Z#5403\n", "4:5");
  refused("(#5403) G1 X0 Y[ # 54 10 / 2]\n", "4:18");
  refused("#1=5403\nG1 Z##1\n", "4:4");
  refused("#<n>=2\nG1 Z#[5400 + 3]\n", "5:7");
  if (std::system("command -v rs274 > /dev/null") != 0) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
  write("inch.tbl", "T1 P1 Z4\n");
  write("part.ngc", "G20 G90 G61.1 F10\nT1 M6\nG43\nG1 Z#5403\nM2\n");
  EXPECT_EQ(run("program part.ngc --task task.toml --tool-table inch.tbl --tool-table-inch").code, 0) << read("err");
  for (const char* other : {"#5=5403\nG1 X#5\n", "G1 X[5403/1000] (#5403)\n", "#<a5403>=1\nG1 X#<a5403>\n",
                            "N5403 G1 X[#5400 + 1]\n", "/ G1 Z#5403\nG1 X[2*3]\n"}) {
    write("part.ngc", std::string("G21 G90 G61.1 F6000\n") + other + "M2\n");
    EXPECT_EQ(run("program part.ngc --task task.toml --tool-length 0").code, 0) << other << read("err");
  }
}

TEST_F(ProgramCommand, WordsThatAreNotReadHereNameThePackageThatReadsThem) {
  write("part.ngc", "G21 G61.1 F300\nG81 X1 Y1 Z-1 R1\nM2\n");
  const Output done = run("program part.ngc --task task.toml");
  const Output without = [&] {
    const std::string line = "cd '" + folder_.path("") + "' && PATH=/nowhere '" + test_support::program() +
                             "' program part.ngc --task task.toml";
    const int code = test_support::wait_for(test_support::start_shell(line, folder_.path("out"), folder_.path("err")));
    return Output{code, read("out"), read("err")};
  }();
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.err, HasSubstr("part.ngc:2:1: LinuxCNC's interpreter is needed for G81"));
  EXPECT_THAT(without.err, HasSubstr("apt-get install linuxcnc-uspace"));
  EXPECT_THAT(without.err, HasSubstr("G90.1 G91 G91.1 G94 G96 to G99"));
  if (std::system("command -v rs274 > /dev/null") == 0) {
    EXPECT_EQ(done.code, 0) << done.err;
  }
  for (const char* spindle : {"G33 Z-5 K1\n", "G76 P1 Z-1 I-.1 J.1 K.5\n", "G95 F0.1\n"}) {
    write("part.ngc", std::string("G21 G61.1 F300\n") + spindle + "M2\n");
    EXPECT_EQ(run("program part.ngc --task task.toml").code, 2);
    EXPECT_THAT(read("err"), HasSubstr("part.ngc:2:1: "));
    EXPECT_THAT(read("err"), HasSubstr("cannot be planned by time"));
  }
}

}  // namespace
}  // namespace accdec::test
