#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program_command.hpp"

// The output of `accdec program --emit`, and that it plans to the same motion.

namespace {

using accdec::test::ProgramCommand;
using testing::HasSubstr;

/// Without the remark of how to read it back: of feeds that are kept it says so, whoever chose them once.
std::string without_command(std::string text) {
  const std::size_t at = text.find("(read back by: ");
  return text.erase(at, text.find('\n', at) - at);
}

TEST_F(ProgramCommand, EmittedProgramKeepsWhatIsNotAboutMotion) {
  write("part.ngc",
        "%\nN10 G21 G90 G64 P0.05 (start)\nT1 M6\nG54 G43 H1\nS12000 M3\nM8\nG0 X10 Y10\nG1 X60 F3000\nG4 P0.5\nY30 "
        "M1\nG61.1\n"
        "Y60\nG61\nG64 P0.02\nX10 S8000.5\nG20\nG1 X1 F100\nM5 M9\nM30\n");
  ASSERT_EQ(run("program part.ngc --feeds keep --task task.toml --tool-length 0 --json r.json --emit e.ngc").code, 0)
      << read("err");
  const std::string text = read("e.ngc");
  std::size_t at = 0;
  for (const char* words :
       {"%\n", "\nN10 (start)\n", "\nT1 M6\n", "\nG54 G43 H1\n", "\nS12000 M3\n", "\nM8\n", "\nG1 X10 Y10 F",
        "\nG61.1\n", "\nG1 X60 F3000\n", "\nG4 P0.5\n", "\nG1 Y30\n", "\nM1\n", "\nG1 Y60\n", "\nS8000.5\n",
        "\nG64 P0.02\n", "\nG1 X10\n", "\nG1 X25.4 F", "\nM5 M9\n", "\nM30\n%\n"}) {
    const std::size_t found = text.find(words, at);
    ASSERT_NE(found, std::string::npos) << words << "in\n" << text;
    at = found + 1;
  }
  EXPECT_THAT(text, ::testing::Not(::testing::ContainsRegex("[0-9]e-"))) << "numbers of programs have no exponents";
  EXPECT_THAT(text, HasSubstr("--feeds keep --tool-length 0)"));
  const std::string again = "program e.ngc --feeds keep --tool-length 0 --task task.toml ";
  ASSERT_EQ(run(again + "--dwells-before-filter --json again.json --emit again.ngc").code, 0) << read("err");
  EXPECT_EQ(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"));
  EXPECT_EQ(read("again.ngc"), text);
  // Read as any program, a dwell is an exact stop as well.
  ASSERT_EQ(run(again + "--json stops.json").code, 0) << read("err");
  EXPECT_GT(number_of("stops.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"));
}

// Steps of feed inside blocks lose nothing of what acts on the whole program.
TEST_F(ProgramCommand, ChosenFeedsKeepPlaneAndToolLength) {
  write("part.ngc", "G21 G90 G18 G64 P0.05\nG54 G43 H1\nG1 X60 F12000\nX61 Z2\nX62 Z0\nX63 Z2\nX64 Z0\nX120\nM2\n");
  write("slow.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "[filter]\nkind = \"boxcar\"\norder = 99\n");
  ASSERT_EQ(run("program part.ngc --task slow.toml --tool-length 0 --json r.json --emit e.ngc --figure r.svg").code, 0)
      << read("err");
  const std::string text = read("e.ngc");
  EXPECT_GT(std::count(text.begin(), text.end(), 'F'), 4) << "no feed is stepped inside a block:\n" << text;
  EXPECT_THAT(text, HasSubstr(" --tool-length 0)"));
  EXPECT_THAT(read("r.svg"), HasSubstr("z / mm"));
  const std::string again = "program e.ngc --feeds keep --tool-length 0 --dwells-before-filter --task slow.toml ";
  ASSERT_EQ(run(again + "--json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.5e-3);
}

// A limit on jerk spans several samples, so that a stop may ask for more rest than the filter; a dwell is this rest.
TEST_F(ProgramCommand, EmittedDwellsAtStopsTakeNoMoreThanBefore) {
  write("jerk.toml", "sample_period_ms = 2\n[[axis]]\nvelocity_max_mm_s = 300\njerk_max_mm_s3 = 50000\n" +
                         std::string("[filter]\nkind = \"trapezoid\"\norder = 39\nramp = 17\n"));
  const std::string before = "G21 G90 G64 P0.05 F1000\nG1 X20 Y7\n";
  const std::string after = "G1 X-0.460 Y-2.535\nX-5.024 Y1.455\nM2\n";
  write("part.ngc", before + "G4 P0.5\n" + after);
  write("stop.ngc", before + "G61.1\nG1 X21 Y7\nG64 P0.05\n" + after);
  ASSERT_EQ(run("program part.ngc --task jerk.toml --feeds keep --emit e.ngc --json r.json").code, 0) << read("err");
  ASSERT_EQ(run("program e.ngc --task jerk.toml --feeds keep --dwells-before-filter --json again.json").code, 0)
      << read("err");
  EXPECT_EQ(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"));
}

// Legs shorter than the filter may need no more rest between them than the filter, though longer ones would.
TEST_F(ProgramCommand, EmittedStopsBetweenShortLegsTakeNoMoreThanBefore) {
  write("short.toml",
        "sample_period_ms = 10\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 50000\n[filter]\nkind = \"averages\"\nlengths = [5, 2]\n");
  write("part.ngc", "G64 P0.005\nF3000\nG1 X0.3\nG1 X0\nG61.1\nG1 X0.0151 Y-0.0147\nG1 X0.0154 Y-0.0146\nM2\n");
  ASSERT_EQ(run("program part.ngc --task short.toml --feeds keep --emit e.ngc --json r.json").code, 0) << read("err");
  ASSERT_EQ(run("program e.ngc --task short.toml --feeds keep --dwells-before-filter --json again.json").code, 0)
      << read("err");
  EXPECT_EQ(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"));
}

// A block that G61 ends and a move in inverse time lose a sample each in LinuxCNC: 20 ms of delay are a move of 18.
/// If feeds step just behind a corner, the joint of the two parts is straight and has no tolerance. Rounding may
/// turn it, and the tolerance in force is then that of the corner before, which the motion into the arc exceeds.
TEST_F(ProgramCommand, EmittedStraightJointsHaveTheToleranceOfWhatFollows) {
  write("uneven.toml",
        "sample_period_ms = 4\n[filter]\nkind = \"taps\"\ntaps = [0.096, 0.628, 0.56, 0.142, 0.369]\n"
        "[program]\nerror_max_um = 5\n[[axis]]\nvelocity_max_mm_s = 50\nacceleration_max_mm_s2 = 3000\n"
        "jerk_max_mm_s3 = 500000\n");
  write("part.ngc",
        "G21 G90 G94 G17\nG0 X0 Y0 Z5\nF30000\nG64\nG1 X-1.728 Y5.273 Z0.766\nG64 P0.2\n"
        "G91 G2 I0.2979 J-0.0357 Z-2.770 P3\nG90\nG1 X1 Y2 Z3\nM2\n");
  ASSERT_EQ(run("program part.ngc --task uneven.toml --emit e.ngc --json a.json").code, 0) << read("err");
  ASSERT_EQ(run("program e.ngc --task uneven.toml --plan fixed --dwells-before-filter --json b.json").code, 0)
      << read("err");
  EXPECT_NEAR(number_of("b.json", "cycle_time_s"), number_of("a.json", "cycle_time_s"), 1.01 * 0.004);
}

TEST_F(ProgramCommand, EmittedForLinuxcncTimesDelaysByMoves) {
  write("one.toml",
        "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[filter]\nkind = \"boxcar\"\n"
        "order = 24\n");
  write("part.ngc", "G21 G90 G64 P0.01 F6000\nG1 X20\nG1 Y20\nM2\n");
  ASSERT_EQ(run("program part.ngc --task one.toml --feeds keep --emit e.ngc --delays d.csv").code, 0) << read("err");
  const std::string dwell = read("e.ngc");
  const std::size_t at = dwell.find("G4 P0.0");
  ASSERT_NE(at, std::string::npos) << dwell;
  const int delay = std::stoi(dwell.substr(at + 7));
  ASSERT_GT(delay, 10);
  ASSERT_EQ(run("program part.ngc --task one.toml --feeds keep --emit a.ngc --dwell-axis A").code, 0) << read("err");
  const std::string text = read("a.ngc");
  const std::string move = "\nG93\nG1 A0.01 F";
  const std::size_t feed = text.find(move);
  ASSERT_NE(feed, std::string::npos) << text;
  EXPECT_NEAR(60e3 / std::stod(text.substr(feed + move.size())), delay - 2, 1e-6);
  EXPECT_THAT(text, HasSubstr("\nG0 A0\nG61\nG1 X20 F6000\nG93"));
  EXPECT_THAT(text, HasSubstr("\nG94\nG1 Y20 F6000\nM2"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("G4")));
  write("third.ngc", "G21 G90 G64 P0.01 F6000\nG1 X20\nG1 U20\nM2\n");
  EXPECT_NE(run("program third.ngc --task one.toml --feeds keep --emit b.ngc --dwell-axis U").code, 0);
  EXPECT_THAT(read("err"), HasSubstr("axis U cannot time delays"));
  write("dwells.ngc", "G21 G90 G64 P0.01 F6000\nG1 X20\nG4 P1\nG1 Y20\nM2\n");
  EXPECT_NE(run("program dwells.ngc --task one.toml --feeds keep --emit b.ngc --dwell-axis A").code, 0);
  EXPECT_THAT(read("err"), HasSubstr("the program dwells"));
  EXPECT_NE(run("program part.ngc --task one.toml --dwell-axis A").code, 0) << "needs --emit";
}

// A control that delays in another way has no use for moves of an unused axis.
TEST_F(ProgramCommand, EmittedForLinuxcncNeedsAControlThatCanTimeAMove) {
  write("other.toml",
        "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[controller]\ndelays = [\"exact-stop\"]\n");
  write("part.ngc", "G21 G90 G64 P0.01 F6000\nG1 X20\nG1 Y20\nM2\n");
  EXPECT_NE(run("program part.ngc --task other.toml --emit a.ngc --dwell-axis A").code, 0);
  EXPECT_THAT(read("err"), HasSubstr("other.toml:5:10: `delays` has no \"timed-axis\""));
}

// G4 is no timed move. Without the axis nothing is planned or written.
TEST_F(ProgramCommand, AControlOfTimedMovesNeedsTheirAxis) {
  write("part.ngc", "G21 G90 G64 P0.01 F6000\nG1 X20\nG1 Y20\nM2\n");
  const std::string head =
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[filter]\nkind = \"boxcar\"\n"
      "order = 24\n[controller]\n";
  write("own.toml", head + "delays = [\"timed-axis\"]\n");
  EXPECT_EQ(run("program part.ngc --task own.toml --emit e.ngc").code, 2);
  EXPECT_THAT(read("err"),
              HasSubstr("own.toml:8:10: `delays` has \"timed-axis\" and no \"dwell\": --emit needs --dwell-"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("e.ngc")));
  ASSERT_EQ(run("program part.ngc --task own.toml --emit e.ngc --dwell-axis A").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr("\nG93\nG1 A0.01 F"));
  write("named.toml", head + "name = \"linuxcnc\"\n");
  EXPECT_EQ(run("program part.ngc --task named.toml --emit n.ngc").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("named.toml:8:8: `delays` has \"timed-axis\""));
  write("both.toml", head + "delays = [\"timed-axis\", \"dwell\"]\n");
  ASSERT_EQ(run("program part.ngc --task both.toml --emit b.ngc").code, 0) << read("err");
  EXPECT_THAT(read("b.ngc"), HasSubstr("\nG4 P0.0"));
}

// As rs274 reads it: a program's number moves nothing. With a word behind it, it is a loop or a subroutine.
TEST_F(ProgramCommand, AProgramsNumberIsReadAndKept) {
  const std::string rest = "N10 G21 G90 G64 P0.05 (start)\nG1 X60 F3000 (cut)\nY60\nM30\n%\n";
  write("plain.ngc", "%\n" + rest);
  ASSERT_EQ(run("program plain.ngc --feeds keep --task task.toml --json plain.json --emit plain-e.ngc").code, 0);
  for (const char* number : {"O0001", "o7", "  O0001 (PART) ; of two"}) {
    write("part.ngc", "%\n" + std::string(number) + "\n" + rest);
    ASSERT_EQ(run("program part.ngc --feeds keep --task task.toml --tool-length 0 --json r.json --emit e.ngc").code, 0)
        << read("err");
    EXPECT_EQ(read("err").find("rs274"), std::string::npos) << read("err");
    EXPECT_EQ(number_of("r.json", "cycle_time_s"), number_of("plain.json", "cycle_time_s"));
    const std::string text = read("e.ngc"), word = std::string(number).substr(std::string(number).find_first_of("Oo"));
    EXPECT_EQ(text.rfind("%\n" + word.substr(0, word.find(' ')) + "\n", 0), 0u) << text;
    EXPECT_THAT(text, HasSubstr("(cut)"));
    EXPECT_EQ(text.find("(PART) ; of two\n") != std::string::npos, word.size() > 5) << text;
  }
  for (const char* word : {"O", "O1 if [1 GT 0]", "N5 O1", "O1 G1", "O1.5"}) {
    write("part.ngc", "%\n" + std::string(word) + "\n" + rest);
    run("program part.ngc --feeds keep --task task.toml");
    EXPECT_THAT(read("err"), HasSubstr("part.ngc:2")) << word;
  }
}

// A G0 runs at the rapid rate: what the plan runs slower stands as G1, and the program says so.
TEST_F(ProgramCommand, EmittedRapidMovesThatAreSlowerThanG0AreNamed) {
  const std::string said = "(rapid moves stand as G1 where the plan runs them slower than G0";
  write("part.ngc", "G21 G90 G64 P0.05\nG0 X30 Y20\nG1 X60 F3000\nG0 Z50\nM2\n");
  for (const char* feeds : {"keep", "choose"}) {
    ASSERT_EQ(run(std::string("program part.ngc --task task.toml --json r.json --emit e.ngc --feeds ") + feeds).code, 0)
        << read("err");
    const std::string text = read("e.ngc");
    // Feeds in mm/min of G1 lines that cut nothing: z moves rapidly only, at less than 500 mm/s.
    const std::size_t z = text.find("G1 Z");
    EXPECT_EQ(text.find(said) != std::string::npos, z != std::string::npos) << text;
    EXPECT_EQ(text.find("G0 Z50") != std::string::npos, z == std::string::npos) << text;
    const std::string options =
        std::string(" --dwells-before-filter --json again.json --emit again.ngc --feeds ") + feeds;
    ASSERT_EQ(run("program e.ngc --task task.toml" + options).code, 0) << read("err");
    EXPECT_LE(number_of("again.json", "samples"), number_of("r.json", "samples") + 1.0);
    const std::string again = read("again.ngc");
    EXPECT_EQ(again.find(said), again.rfind(said)) << "said once, however often it is written";
  }
}

// Numbers and comments stay on the line of their block, on its first part where it was split; each stands once.
TEST_F(ProgramCommand, EmittedNumbersAndCommentsStayWithTheirBlocks) {
  write("part.ngc",
        "N5 (head)\nG21 G90 G64 P0.05\n(alone)\nN10 T1 M6 (tool)\nN20 G1 X60 F3000 (first) (cut)\n"
        "N25 X60\nN30 G3 X70 Y10 I0 J10 ; arc\n/N40 G1 Y40\nG1 Y60 M8 (coolant)\nN50 G4 P0.5 (wait)\nN60 M30 (end)\n");
  for (const char* feeds : {"keep", "choose"}) {
    ASSERT_EQ(run(std::string("program part.ngc --task task.toml --json r.json --emit e.ngc --feeds ") + feeds).code, 0)
        << read("err");
    const std::string text = read("e.ngc");
    for (const char* line : {"\nN5 (head)\n", "\n(alone)\n", "\nN10 T1 M6 (tool)\n", "\nN25\n", "\nN50 (wait)\n",
                             "\nM8\n", "\nN60 (end)\nM30\n"})
      EXPECT_THAT(text, HasSubstr(line));
    EXPECT_THAT(text, ::testing::ContainsRegex("\nN20 G1 X[0-9.]+( F[0-9.]+)? \\(first\\) \\(cut\\)\n"));
    EXPECT_THAT(text, ::testing::ContainsRegex("\nN30 G1 X[0-9.]+ Y[0-9.]+( F[0-9.]+)? ; arc\n"));
    EXPECT_THAT(text, ::testing::ContainsRegex("\nG1 (X[0-9.]+ )?Y[0-9.]+( F[0-9.]+)? \\(coolant\\)\n"));
    for (const char* once : {"N20", "(first)", "N30", "; arc", "(coolant)"})
      EXPECT_EQ(text.find(once), text.rfind(once)) << once;
    ASSERT_EQ(
        run(std::string("program e.ngc --task task.toml --dwells-before-filter --emit again.ngc --feeds ") + feeds)
            .code,
        0)
        << read("err");
    EXPECT_EQ(without_command(read("again.ngc")), without_command(text));
  }
}

// The header's own command line reads it back to the same time within a sample, though the task has no filter.
TEST_F(ProgramCommand, EmittedProgramNamesTheCommandThatReadsItBack) {
  std::string zigzag = "G21 G91 G64 P0.5 F6000\n";
  for (const char* leg : {"X10", "X7 Y7.2", "X0.8 Y-10", "X8 Y5.9", "X9.1 Y-4.1", "X4.2 Y9", "X9.4 Y-3.3", "X0.1 Y10",
                          "X8.1 Y-5.8", "X10 Y1", "X8.9 Y-4.6", "X-2.2 Y9.7", "X9.4 Y3.5", "X-1.9 Y-9.8"})
    zigzag += std::string("G1 ") + leg + "\n";
  write("part.ngc", zigzag + "M2\n");
  for (const char* jerk : {"", "jerk_max_mm_s3 = 500000\n"}) {
    write("free.toml", "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 5000\n" +
                           std::string(jerk));
    for (const char* how : {"fixed", "fixed --feeds keep"}) {
      ASSERT_EQ(run(std::string("program part.ngc --task free.toml --json r.json --emit e.ngc --plan ") + how).code, 0)
          << read("err");
      const std::string text = read("e.ngc"), begin = "(read back by: accdec ";
      const std::size_t at = text.find(begin) + begin.size();
      std::string line = text.substr(at, text.find(")\n", at) - at);
      line.replace(line.find("FILE"), 4, "e.ngc");
      line.replace(line.find("TASK.toml"), 9, "free.toml");
      ASSERT_EQ(run(line + " --json again.json").code, 0) << line << read("err");
      EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.0001e-3) << line;
    }
  }
}

// Blocks of some nanometres at millimetres an hour: coordinates are written finely enough to keep the samples. A
// program that holds as it is written is the plan, though a faster one may be found.
TEST_F(ProgramCommand, EmittedProgramsOfTinyBlocksTakeTheirSamples) {
  write("tiny.toml",
        "sample_period_ms = 2\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n"
        "jerk_max_mm_s3 = 5000\n");
  write("part.ngc",
        "G21 G90 G17\nG64 P0.0077\nF5\nG1 Y-0.032331\nG1 X0.000034 Y-0.032339\nG61\n"
        "G3 X-0.100688 Y0.032891 I-0.050361 J0.032615\nG1 X-0.112506 Y0.026712\nG1 X-0.113688 Y0.026094\n"
        "G3 I0.050429 J0.03251 P3\nG64 P0.02\nG1 X-0.113688\nG3 X0.733432 Y-0.823537 I0.415518 J-0.432834\nF10\n"
        "G1 X-0.112506 Y0.026712\nG1 X-0.093983 Y0.019779\nG61\nG91\nG1 X0.001852 Y-0.000693\nM2\n");
  for (const char* how : {"", " --compensate-arcs"}) {
    ASSERT_EQ(run(std::string("program part.ngc --task tiny.toml --json r.json --emit e.ngc") + how).code, 0);
    ASSERT_EQ(run("program e.ngc --task tiny.toml --plan fixed --dwells-before-filter --json again.json").code, 0);
    EXPECT_NEAR(number_of("again.json", "samples"), number_of("r.json", "samples"), 1.0) << how;
  }
}

TEST_F(ProgramCommand, RotaryAxesTakeNoLimitsOfLinearOnes) {
  write("part.ngc", "G21 G64 P0.05 F600\nG1 X20 A10\nM2\n");
  const std::string linear =
      "sample_period_ms = 1.0\n[[axis]]\nname = \"x\"\nvelocity_max_mm_s = 200\n"
      "acceleration_max_mm_s2 = 1000\n";
  write("linear.toml", linear);
  const auto refused = run("program part.ngc --task linear.toml");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("part.ngc:2:"));
  EXPECT_THAT(refused.err, HasSubstr("axis A is not among the axes of the task: it is rotary"));
  write("both.toml", linear + "[[axis]]\nname = \"a\"\nvelocity_max_mm_s = 90\nacceleration_max_mm_s2 = 300\n");
  const auto planned = run("program part.ngc --task both.toml");
  EXPECT_EQ(planned.code, 0) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("300 deg/s^2"));
}

TEST_F(ProgramCommand, PlotDrawsAResultAsTheProgramDid) {
  write("part.ngc", "G21 G64 P0.05 F6000\nG1 X20\nG1 Y20\nG3 X0 Y20 I-10 J0\nG1 Y0\nM2\n");
  for (const char* plan : {"fixed", "profiles"}) {
    ASSERT_EQ(run(std::string("program part.ngc --task task.toml --json r.json --figure a.svg --plan ") + plan).code, 0)
        << read("err");
    ASSERT_EQ(run("plot r.json --out b.svg").code, 0) << read("err");
    EXPECT_EQ(read("a.svg"), read("b.svg")) << plan;
  }
}

TEST_F(ProgramCommand, EmittedOrderAndAxes) {
  // A run-up of the spindle stays before the cut, Z retracts before X and Y move, and what does not move is not named.
  write("part.ngc", "G21 G64 P0.05\nS12000 M3\nG4 P2\nG1 X10 F600\nM5\nG4 P3\nM4\nG0 Z50\nG0 X100 Y50\nG4 P1\nM9\n");
  ASSERT_EQ(run("program part.ngc --feeds keep --task task.toml --emit e.ngc").code, 0) << read("err");
  const std::string text = read("e.ngc");
  EXPECT_THAT(text, HasSubstr("S12000 M3\nG4 P2\n"));
  EXPECT_THAT(text, HasSubstr("G1 X10 F600\nM5\nG4 P3\nM4\n"));
  // The filter starts no axis at its rapid rate within 6000 mm/s^2.
  EXPECT_THAT(text, testing::ContainsRegex("\nG1 Z50 F[0-9.]+\n"));
  EXPECT_THAT(text, testing::ContainsRegex("\nG1 X100 Y50 F[0-9.]+\nG4 P1\nM9\nM2\n"));
  ASSERT_EQ(run("program e.ngc --feeds keep --task task.toml --dwells-before-filter --emit again.ngc").code, 0)
      << read("err");
  EXPECT_EQ(read("again.ngc"), text);
}

TEST_F(ProgramCommand, CanonicalCallsThatAreNotMotionAreEmittedAsWords) {
  write("part.canon",
        "USE_LENGTH_UNITS(CANON_UNITS_MM)\nSELECT_TOOL(3)\nCHANGE_TOOL()\nSET_SPINDLE_SPEED(0, "
        "8000.0000)\nSTART_SPINDLE_CLOCKWISE(0)\nFLOOD_ON()\n"
        "SET_FEED_RATE(600)\nSTRAIGHT_FEED(10, 0, 0)\nPROGRAM_STOP()\nSTRAIGHT_FEED(20, 0, "
        "0)\nSTOP_SPINDLE_TURNING(0)\nPROGRAM_END()\n");
  ASSERT_EQ(run("program part.canon --feeds keep --task task.toml --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr("T3\nM6\nS8000\nM3\nM8\nG61.1\nG1 X10 F600\nM0\nG1 X20\nM5\nM2\n"));
}

TEST_F(ProgramCommand, WrittenFromCsvItGoesToItsBeginningFirst) {
  write("part.csv", "x_mm,y_mm,z_mm,feed_mm_min\n5,5,-1,600\n15,5,-1,600\n15,25,-1,600\n");
  ASSERT_EQ(run("program part.csv --feeds keep --task task.toml --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr("\nG61.1\nG0 X5 Y5 Z-1\nG64 P0.02\nG1 X15 F600\n"));
  write("free.toml",
        "sample_period_ms = 1.0\n[filter]\nkind = \"boxcar\"\norder = 40\n[[axis]]\nacceleration_max_mm_s2 = "
        "6000\n[program]\nerror_max_um = 20\n");
  ASSERT_EQ(run("program part.csv --feeds keep --task free.toml --emit e.ngc").code, 0) << read("err");
  EXPECT_THAT(read("e.ngc"), HasSubstr("\nG1 X5 Y5 Z-1 F600\n"));
  EXPECT_EQ(run("program e.ngc --feeds keep --task free.toml --dwells-before-filter").code, 0) << read("err");
}

// Runs between delays that exceed whole samples by rounding only: the plan snaps them as reading it back does.
TEST_F(ProgramCommand, EmittedRunsBetweenDelaysKeepTheirSamples) {
  const std::string limits = "velocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\njerk_max_mm_s3 = 5000\n";
  write("slow.toml", "sample_period_ms = 2\n[[axis]]\nname = \"x\"\n" + limits + "[[axis]]\nname = \"y\"\n" + limits);
  write("part.ngc",
        "G21 G90 G17\nG64 P0.0077\nF5\nG1 Y-0.032331\nG1 X0.000034 Y-0.032339\nG61\n"
        "G3 X-0.100688 Y0.032891 I-0.050361 J0.032615\nG1 X-0.112506 Y0.026712\nG1 X-0.113688 Y0.026094\n"
        "G3  I0.050429 J0.03251 P3\nG64 P0.02\nG1 X-0.113688\n"
        "G3 X0.733432 Y-0.823537 I0.415518 J-0.432834\nF10\nG1 X-0.112506 Y0.026712\n"
        "G1 X-0.093983 Y0.019779\nG61\nG91\nG1 X0.001852 Y-0.000693\nG4 P0\nG1 X0.029393 Y-0.006193\n"
        "G2 X-0.818197 Y-0.224841 I-0.521519 J0.296678\nG1 X-0.009946 Y0.009698\nG61\n"
        "G2 X0.647206 Y0.548748 I0.597977 J-0.049229\nG1 X0.000016 Y0.000003\n"
        "G3 X0.011352 Y-0.038356 I0.005676 J-0.019178\nG1 X0.011041 Y-0.010201\nG90\nF30\nF15\n"
        "G1 X-0.232307 Y0.308145\nG1 X-0.237828 Y0.313246\nG1 X-0.241772 Y0.326607\n"
        "G1 X-0.261867 Y0.350532\nG91\nG1 X0.006923 Y0.010253\nG1 X-0.014036\nG1 X0.000611 Y0.006116\n"
        "G1 X-0.028215 Y0.010097\nF7.5\nG3 X0.000024 Y0.000055 I-0.054787 J0.024462\nM2\n");
  ASSERT_EQ(run("program part.ngc --task slow.toml --plan fixed --json r.json --emit e.ngc").code, 0) << read("err");
  ASSERT_EQ(run("program e.ngc --task slow.toml --plan fixed --dwells-before-filter --json again.json").code, 0)
      << read("err");
  EXPECT_NEAR(number_of("again.json", "samples"), number_of("r.json", "samples"), 1.0);
}

// Behind a servo the motion leaves out some micrometres of a stop, and so some of a step of the feed soon after it. On
// a straight line that breaks nothing, but in the written text the line is bent by rounding.
TEST_F(ProgramCommand, EmittedStepsSoonAfterStopsHoldBehindAServo) {
  write("servo.toml",
        "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 3\n[[axis]]\nservo_gain_1_s = 80\n"
        "velocity_feedforward = 0.95\nvelocity_max_mm_s = 136.1\nacceleration_max_mm_s2 = 1005.3\n[program]\n"
        "error_max_um = 100\n");
  write("part.ngc",
        "G21 G90 G94 G17\nG61.1\nF3910\nG2 I0.6345 J-0.2951 P2\nG1 X-1.2615 Y-0.6062 Z0\nG1 X-1.399 Y-0.4014 Z0.375\n"
        "F1167\nG1 X-1.6752 Y-0.5902 Z0.375\nM2\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --plan fixed --arc-tolerance-um 1 --json r.json --emit e.ngc").code,
            0)
      << read("err");
  ASSERT_EQ(run("program e.ngc --task servo.toml --plan fixed --dwells-before-filter --json again.json").code, 0)
      << read("err");
  EXPECT_NEAR(number_of("again.json", "samples"), number_of("r.json", "samples"), 1.0);
}

}  // namespace
