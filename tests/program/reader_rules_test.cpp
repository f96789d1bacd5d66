// Which text is a block and which is not, as LinuxCNC 2.9's rs274 decides: every case here was tried with it.

#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include <accdec/gcode/modal_groups.hpp>

#include "reader_harness.hpp"

namespace accdec {
namespace {

double path_length(const Recorder& r, std::size_t first = 0) {
  double length = 0.0;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < r.moves.size(); ++i) {
    const ProgramPoint &a = r.moves[i - 1].to, &b = r.moves[i].to;
    length += std::sqrt(std::pow(b[0] - a[0], 2) + std::pow(b[1] - a[1], 2) + std::pow(b[2] - a[2], 2));
  }
  return length;
}

/// How much shorter chords with a sagitta of 2 um are than their arc. It is h^2/24 of the arc, where r h^2/8 is the
/// sagitta, plus 1 % for the higher orders.
double shortening(double radius) {
  return 1.01 * 2e-6 / (3.0 * radius);
}

/// "G54 to G59.3" is in tenths 540, 550 .. 590 and 591 to 593.
std::set<int> codes_in(const std::string& text, char letter) {
  std::set<int> codes;
  std::istringstream words(text);
  bool range = false;
  for (std::string word; words >> word;) {
    if (word == "to") range = true;
    if (word.front() != letter) continue;
    const int last = static_cast<int>(std::lround(10.0 * std::stod(word.substr(1))));
    for (int code = last; range && code % 10 > 0; --code) codes.insert(code);
    for (int code = last / 10 * 10; range && !codes.contains(code); code -= 10) codes.insert(code);
    codes.insert(last);
    range = false;
  }
  return codes;
}

TEST(ReaderRules, TheMessageNamesTheCodesThatAreRead) {
  const std::set<int> g = codes_in(g_supported, 'G'), m = codes_in(m_supported, 'M');
  for (int code = 0; code < 1000; ++code) {
    EXPECT_EQ(g.contains(code), g_group(code) != g_unknown) << code_name('G', code);
    EXPECT_EQ(m.contains(code), m_group(code) != m_unknown) << code_name('M', code);
  }
}

TEST(ReaderRules, ArcsWithoutEndWordsAreFullCircles) {
  for (const char* circle : {"G2 I10", "G3 J-6 I8", "G18 G2 K10", "G18 G3 I10", "G19 G2 J10", "G90.1 G2 I20 J0",
                             "G2 X10 I10", "G2 Y0 I10", "G2 I10 P1"}) {
    const Recorder r = read(std::string("G21 G90\nG1 X10 F1000\n") + circle + "\nM2\n");
    EXPECT_NEAR(path_length(r), 0.02 * std::numbers::pi, 0.02 * std::numbers::pi * shortening(0.01)) << circle;
    EXPECT_DOUBLE_EQ(r.moves.back().to[0], 0.01);
    EXPECT_EQ(r.moves.back().line, 3);
  }
  EXPECT_NEAR(path_length(read("G1 X10 F1000\nG2 I10 P3\n")), 0.06 * std::numbers::pi,
              0.06 * std::numbers::pi * shortening(0.01));
  EXPECT_NEAR(path_length(read("G1 X10 F1000\nG2 X10 I10\nI10\n")), 0.04 * std::numbers::pi,
              0.04 * std::numbers::pi * shortening(0.01));  // modal
  expect_error("G1 X10 F1000\nG2 R10\n", "2:4", "full circle");
  expect_error("G1 X10 F1000\nG90.1 G2 I10\n", "2:10", "both I and J");
  expect_error("G1 X10 F1000\nG2 I10 K1\n", "2:8", "word K");
  expect_error("G1 X10 F1000\nI10\n", "2:1", "word I");
  expect_error("I10 F1\n", "1:1", "word I");
}

TEST(ReaderRules, RoundingErrorsDoNotLoseCircles) {
  // 80.2 + 0.7 + 0.4 and 81.3 differ in their last bits; so do inches and millimetres.
  const double circle = std::numbers::pi * 1e-3;
  for (const char* program :
       {"G91 G1 F1000 X80.2\nX.7\nX.4\nG90 G2 X81.3 Y0 J.5\n", "G91 G1 F1000 X80.2\nX.7\nX.4\nG90 G3 X81.3 Y0 J.5\n",
        "G1 F1000 X80.2\nX80\nG20 X3.15748\nG21 G2 X80.2 J.5\n",
        "G1 F1000 X80.2\nX80\nG20 X3.15748\nG21 G3 X80.2 J.5\n",
        "G1 F1000 X80.2\nX80\nG20 X3.157480315\nG21 G2 X80.2 J.5\n",
        "G1 F1000 X80.2\nX80\nG20 X3.157480315\nG21 G3 X80.2 J.5\n",
        // In print, 0.0001 inch is 2.5 um.
        "SET_FEED_RATE(1000)\nSTRAIGHT_FEED(80, 0, 0)\nUSE_LENGTH_UNITS(CANON_UNITS_INCHES)\nSTRAIGHT_FEED(3.1575, 0, "
        "0)\n"
        "USE_LENGTH_UNITS(CANON_UNITS_MM)\nARC_FEED(80.2000, 0, 80.2000, 0.5000, -1, 0)\n",
        "SET_FEED_RATE(1000)\nSTRAIGHT_FEED(80, 0, 0)\nUSE_LENGTH_UNITS(CANON_UNITS_INCHES)\nSTRAIGHT_FEED(3.1575, 0, "
        "0)\n"
        "USE_LENGTH_UNITS(CANON_UNITS_MM)\nARC_FEED(80.2000, 0, 80.2000, 0.5000, 1, 0)\n"}) {
    const Recorder r = read(program);
    double length = 0.0;
    for (std::size_t i = 1; i < r.moves.size(); ++i) {
      if (r.moves[i].line != r.moves.back().line) continue;
      length += std::hypot(r.moves[i].to[0] - r.moves[i - 1].to[0], r.moves[i].to[1] - r.moves[i - 1].to[1]);
    }
    EXPECT_NEAR(length, circle, circle * shortening(5e-4) + 2e-6) << program;
  }
  // A short arc stays one: 1 um on a radius of 0.5 mm, ahead in this direction, and almost all of the circle in the
  // other.
  const Recorder ahead = read("G1 F1000 X1\nG3 X1.001 Y0 J.5\n"), behind = read("G1 F1000 X1\nG2 X1.001 Y0 J.5\n");
  EXPECT_EQ(ahead.moves.size(), 2U);
  EXPECT_NEAR(path_length(behind), circle, circle * shortening(5e-4) + 1e-6);
  // So does one of 1 um on a large circle given by its radius.
  EXPECT_EQ(read("G1 F1000 X1\nG3 X1.001 Y0 R1000000\n").moves.size(), 2U);
}

TEST(ReaderRules, PrintedCoordinatesThatDoNotMoveStayWhereTheyAre) {
  // 3 mm print as 0.1181 inch, 2.9997 mm: the move of A is a rotary one, at 60 degrees a minute whatever the unit was
  // when set.
  const Recorder r = read(
      "SET_FEED_RATE(600)\nSTRAIGHT_FEED(3.0000, 2.0000, 0.0000, "
      "0.0000)\nUSE_LENGTH_UNITS(CANON_UNITS_INCHES)\nSET_FEED_RATE(60)\n"
      "STRAIGHT_FEED(0.1181, 0.0787, 0.0000, 10.0000)\nSTRAIGHT_FEED(0.1181, 0.0787, 0.0000, 20.0000)\n"
      "STRAIGHT_FEED(0.1182, 0.0787, 0.0000, 20.0000)\nUSE_LENGTH_UNITS(CANON_UNITS_MM)\nSTRAIGHT_FEED(3.0023, 2.0000, "
      "0.0000, 20.0000)\n");
  ASSERT_EQ(r.moves.size(), 5U);
  EXPECT_NEAR(r.moves[1].duration, 10.0, 1e-9);
  EXPECT_NEAR(r.moves[2].duration, 10.0, 1e-9);
  EXPECT_DOUBLE_EQ(r.moves[2].to[0], 3e-3);
  EXPECT_DOUBLE_EQ(r.moves[3].to[0], 0.1182 * 0.0254);
  EXPECT_EQ(r.moves[4].duration, 0.0);
}

TEST(ReaderRules, RadiiMayDifferByTheRoundingOfTheirEnds) {
  // LinuxCNC's limits: 2 sqrt(2) of 0.01 mm or 0.001 inch, or 0.1 % up to 100 times as much.
  EXPECT_GT(read("F100\nG2 X10.02 I5\n").moves.size(), 10U);
  EXPECT_GT(read("F100\nG2 X10.0282 I5\n").moves.size(), 10U);
  EXPECT_GT(read("F100\nG2 X200.09 I100\n").moves.size(), 10U);
  EXPECT_GT(read("F100\nG20 G2 X1.0009 I.5\n").moves.size(), 10U);
  EXPECT_GT(read("F100\nG20 G2 X1.0028 I.5\n").moves.size(), 10U);
  EXPECT_GT(read("F100\nG2 X10002.82 I5000\n").moves.size(), 10U);
  expect_error("F100\nG2 X10.0283 I5\n", "2:4", "radius 5.000000 at its start, 5.028300 at its end");
  expect_error("F100\nG2 X200.21 I100\n", "2:4", "at its end");
  expect_error("F100\nG20 G2 X1.0029 I.5\n", "2:8", "at its end");
  expect_error("F100\nG2 X10002.84 I5000\n", "2:4", "at its end");
  expect_error("F100\nG2 X.02 I.001\n", "2:4", "radius is 0");
  // The difference is spread over the arc: at half the angle, half of it.
  const Recorder r = read("F100\nG2 X10.02 I5\n");
  for (const Move& m : r.moves) {
    const double x = m.to[0] - 5e-3, y = m.to[1];
    const double turned = std::numbers::pi - std::atan2(y, x);
    EXPECT_NEAR(std::hypot(x, y), 5e-3 + 0.02e-3 * turned / std::numbers::pi, 1e-12);
  }
}

TEST(ReaderRules, WordsBeforeACommentAreNoCanonicalCall) {
  for (const char* first :
       {"T1M6(6MM ENDMILL)", "G21G90(METRIC)", "G0X0Y0Z5(START)", "N10(ABCD)", "N10 G21(A)G90(B)"}) {
    LineSource source("part.ngc", std::string_view(first));
    Recorder recorder;
    EXPECT_EQ(read_program(source, {}, recorder), ProgramFormat::rs274) << first;
  }
  for (const char* first : {"COMMENT(\"a\")", "    1 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)", "    1 N10    MIST_ON()",
                            "LOG(\"a\")", "7 N5 SPINDLE.0.WAIT_ORIENT_COMPLETE(0.0000)"}) {
    LineSource source("part.ngc", std::string_view(first));
    Recorder recorder;
    EXPECT_EQ(read_program(source, {}, recorder), ProgramFormat::canonical) << first;
  }
  expect_error("STRAIGHT_FEEED(1, 2, 3)\n", "1:1", "STRAIGHT_FEEED is an unknown call; allowed: STRAIGHT_TRAVERSE");
}

TEST(ReaderRules, FeedsAreOfTheUnitBeforeTheBlock) {
  const Recorder r = read("G21\nG20 G1 X1 F10\nG1 X2\nG21 X76.2 F10\nX101.6 F10\n");
  ASSERT_EQ(r.moves.size(), 4U);
  EXPECT_DOUBLE_EQ(r.moves[0].duration, 60.0 * 25.4 / 10.0);  // millimetres
  EXPECT_DOUBLE_EQ(r.moves[1].duration, 60.0 * 25.4 / 10.0);  // and that feed stays
  EXPECT_DOUBLE_EQ(r.moves[2].duration, 60.0 / 10.0);         // inches
  EXPECT_DOUBLE_EQ(r.moves[3].duration, 60.0 * 25.4 / 10.0);
}

TEST(ReaderRules, CanonicalCallsAreKnownOrRefused) {
  const std::string feed = "SET_FEED_RATE(100)\n";
  expect_error(feed + "STRAIGHT_FEEED(1,2,3)\n", "2:1", "unknown call; allowed: ");
  expect_error(feed + "SPLINE_FEED(1,2,3)\n", "2:1", "unknown call");
  expect_error(feed + "  3 N..... ARC_FEED_X(1,2,3)\n", "2:12", "unknown call");
  expect_error(feed + "NURBS_FEED(3, ...)\n", "2:1", "(NURBS_FEED) without their control points");
  expect_error(feed + "START_SPEED_FEED_SYNC(1.000000,0)\n", "2:1", "moves with the spindle");
  expect_error(feed + "CANON_ERROR(bad)\n", "2:1", "not supported");
  expect_error(feed + "STRAIGHT_FEED(1,2,3) STRAIGHT_FEED(2,2,3)\n", "2:22", "one call a line");
  expect_error(feed + "STRAIGHT_FEED(1,2,3)x\n", "2:21", "one call a line");
  expect_error(feed + "COMMENT(\"a\") STRAIGHT_FEED(2,2,3)\n", "2:14", "one call a line");
  expect_error(feed + "MIST_ON() STRAIGHT_FEED(2,2,3)\n", "2:11", "one call a line");
  expect_error(feed + "SELECT_PLANE(CANON_PLANE_XY)) \n", "2:29", "one call a line");
  expect_error(feed + "PROGRAM_END() 1\n", "2:15", "one call a line");
  expect_error(feed + "MIST_ON(\n", "2:9", "without its ')'");
  expect_error(feed + "G1 X1\n", "2:1", "no canonical call in this line; allowed: ");
  expect_error(feed + "SET_FEED_MODE(0, 1)\n", "2:1", "feed per minute");
  expect_error(feed + "SET_G92_OFFSET(0 1)\n", "2:18", "',' or ')' expected");
  EXPECT_EQ(read(feed + "COMMENT(\"say \"(hi\"\")\nMESSAGE(\" a \"b\"\")\nSTRAIGHT_FEED(1,2,3) \t\n"
                        "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 1.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 0.0000)\n"
                        "SET_SPINDLE_MODE(0 0.0000)\nSTRAIGHT_FEED(1,2,4)\n")
                .moves.size(),
            2U);
}

// As LinuxCNC's task does it: the offset of G92, the rotation, the coordinate system's and the tool's.
TEST(ReaderRules, OffsetsMoveTheProgramsCoordinatesAndNotTheMachine) {
  const Recorder r = read(
      "SET_FEED_RATE(600)\nSTRAIGHT_FEED(10, 20, 0)\nSET_G92_OFFSET(9, 0, 0)\nSTRAIGHT_FEED(2, 20, 0)\n"
      "SET_G5X_OFFSET(1, 5, 7, 0)\nSET_XY_ROTATION(30)\nSTRAIGHT_FEED(10, 0, 0)\n"
      "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 5.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 0.0000)\n"
      "STRAIGHT_FEED(10, 1, -5)\nSTRAIGHT_FEED(10, 1, -3)\nARC_FEED(10, 21, 10, 11, 1, -3)\n");
  const auto turned = [](double x, double y) {  // mm; with the offset of G92 in x
    const double c = std::sqrt(0.75), s = 0.5;
    return std::array<double, 2>{c * (x + 9.0) - s * y + 5.0, s * (x + 9.0) + c * y + 7.0};
  };
  const auto expect_at = [&](std::size_t i, double x, double y, double z) {
    EXPECT_NEAR(r.moves.at(i).to[0], 1e-3 * x, 1e-12) << i;
    EXPECT_NEAR(r.moves.at(i).to[1], 1e-3 * y, 1e-12) << i;
    EXPECT_NEAR(r.moves.at(i).to[2], 1e-3 * z, 1e-12) << i;
  };
  expect_at(0, 10.0, 20.0, 0.0);
  expect_at(1, 11.0, 20.0, 0.0);
  expect_at(2, turned(10.0, 0.0)[0], turned(10.0, 0.0)[1], 0.0);
  // The tool's length is printed in z, which does not move.
  expect_at(3, turned(10.0, 1.0)[0], turned(10.0, 1.0)[1], 0.0);
  expect_at(4, turned(10.0, 1.0)[0], turned(10.0, 1.0)[1], 2.0);
  const std::size_t last = r.moves.size() - 1;
  expect_at(last, turned(10.0, 21.0)[0], turned(10.0, 21.0)[1], 2.0);
  const std::array<double, 2> center = turned(10.0, 11.0);
  for (std::size_t i = 5; i < last; ++i) {
    EXPECT_NEAR(std::hypot(r.moves[i].to[0] - 1e-3 * center[0], r.moves[i].to[1] - 1e-3 * center[1]), 0.01, 1e-12);
  }
}

TEST(ReaderRules, ArcsAroundWhereTheyStandAreLinesAlongTheirAxis) {
  const Recorder r = read("SET_FEED_RATE(600)\nSTRAIGHT_FEED(10, 20, 0)\nARC_FEED(10, 20, 10, 20, 1, -3)\n");
  ASSERT_EQ(r.moves.size(), 2U);
  EXPECT_NEAR(r.moves[1].to[2], -3e-3, 1e-15);
  EXPECT_NEAR(r.moves[1].duration, 3.0 / 10.0, 1e-12);
}

TEST(ReaderRules, ContradictionsInABlockAreRefused) {
  for (const char* block :
       {"G54 G55", "G43 G49", "G40 G40", "G96 G97", "G98 G99", "G61 G64", "G90 G91", "G17 G18", "G0 G1",  "G20 G21",
        "G21 G21", "M3 M5",   "M3 M4",   "M7 M8",   "M8 M9",   "M48 M49", "M0 M2",   "M0 M1",   "M2 M30", "M3 M3"}) {
    const std::string_view text(block);
    expect_error(text, fmt::format("1:{}", text.find(' ') + 2), "of its group in this block");
  }
  expect_error("G1 S-5\n", "1:4", "S must be");
  expect_error("T-1\n", "1:1", "T must be a whole number");
  expect_error("T1.5\n", "1:1", "T must be a whole number");
  expect_error("G43 H-1\n", "1:5", "H must be");
  expect_error("N-5 G1\n", "1:1", "N must be");
  expect_error("F100\nG4 G2 X1 I.5 P2\n", "2:4", "G4 cannot stand in one block with G2, G3 or G5");
  expect_error("F100\nG80 X2\n", "2:5", "without a motion");
  EXPECT_EQ(
      read("G40 G54 G94 G97 G98 G49 G80 G90 G17 G21\nM3 M8 M6 M48 T1\nG0 G80 X1\nG80 G1 X2 F1\nX3 M0\n").moves.size(),
      3U);
  expect_error("G6 X1\n", "1:1", "LinuxCNC's interpreter is needed for G6");
  expect_error("M98 P1\n", "1:1", "LinuxCNC's interpreter is needed for M98");
}

TEST(ReaderRules, BlanksInsideNumbersMeanNothing) {
  const Recorder r = read("F5\nG1 X1 0.5\nx 1 2 Y- 3\n G 6 1 . 1\nN1 0 X+1 . 5Y\t.\t5\n");
  ASSERT_EQ(r.moves.size(), 3U);
  EXPECT_DOUBLE_EQ(r.moves[0].to[0], 10.5e-3);
  EXPECT_DOUBLE_EQ(r.moves[1].to[0], 12e-3);
  EXPECT_DOUBLE_EQ(r.moves[1].to[1], -3e-3);
  EXPECT_DOUBLE_EQ(r.moves[2].to[0], 1.5e-3);
  EXPECT_DOUBLE_EQ(r.moves[2].to[1], 0.5e-3);
  EXPECT_EQ(r.moves[2].control, PathControl::exact_stop);
  expect_error("F5 G1 X1 -5\n", "1:7", "word X has no number");
  expect_error("F5 G1 X1 .5 .5\n", "1:7", "word X has no number");
  expect_error("F5 G1 X1(c)0\n", "1:12", "a number without its letter");
  expect_error("F5 G1 X2.5.5\n", "1:11", "a number without its letter");
  expect_error("1 X1\n", "1:1", "a number without its letter");
  expect_error("(c) / X1\n", "1:5", "'/' deletes a block only as its first character");
}

TEST(ReaderRules, G64P0GivesNoTolerance) {
  const Recorder r = read("F5 G1 G64 P.1\nX1\nG64 P0\nX2\nG64 P.2\nX3\nG64\nX4\n");
  ASSERT_EQ(r.moves.size(), 4U);
  EXPECT_DOUBLE_EQ(r.moves[0].tolerance, 1e-4);
  EXPECT_LT(r.moves[1].tolerance, 0.0);
  EXPECT_DOUBLE_EQ(r.moves[2].tolerance, 2e-4);
  EXPECT_LT(r.moves[3].tolerance, 0.0);
}

}  // namespace
}  // namespace accdec
