#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

#include "reader_harness.hpp"
#include "support/paths.hpp"

namespace accdec {
namespace {

double distance(const ProgramPoint& a, const ProgramPoint& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

TEST(Reader, AgreesWithTheCanonicalOutputOfLinuxCnc) {
  // dialect.canon was printed by rs274 2.9.0 from dialect.ngc; it rounds to 4 decimals, of a millimetre or of an inch.
  const std::filesystem::path folder =
      std::filesystem::path(accdec::test_support::source_folder()) / "problems/program/reader";
  Recorder ours, theirs;
  LineSource program(folder / "dialect.ngc"), canonical(folder / "dialect.canon");
  EXPECT_EQ(read_program(program, {}, ours), ProgramFormat::rs274);
  EXPECT_EQ(read_program(canonical, {}, theirs), ProgramFormat::canonical);
  ASSERT_EQ(ours.moves.size(), theirs.moves.size());
  EXPECT_EQ(ours.dwells, theirs.dwells);
  for (std::size_t i = 0; i < ours.moves.size(); ++i) {
    const Move &a = ours.moves[i], &b = theirs.moves[i];
    // Half a unit of the last decimal in each coordinate of ends and centres: 0.00005 inch, times root 3, and twice for
    // the centre.
    EXPECT_LT(distance(a.to, b.to), 0.00005 * 0.0254 * std::sqrt(3.0) * 2.0) << "line " << a.line;
    // Durations differ by the rounding of the length, at feeds of 5 mm/s and more.
    EXPECT_NEAR(a.duration, b.duration, 4.4e-6 / 5e-3) << "line " << a.line;
    EXPECT_EQ(a.rapid, b.rapid);
    EXPECT_EQ(a.control, b.control);
    EXPECT_EQ(a.inside_arc, b.inside_arc);
    EXPECT_DOUBLE_EQ(a.tolerance, b.tolerance) << "line " << a.line;
  }
  EXPECT_GT(ours.moves.size(), 300U);
}

TEST(Reader, ScalesUnitsAndFeeds) {
  const Recorder r = read("G20\nG1 X1 F60\nG21 X50.8\nG91 G1 X10 F600\nA90 F180\n");
  ASSERT_EQ(r.moves.size(), 4U);
  EXPECT_DOUBLE_EQ(r.moves[0].to[0], 0.0254);
  EXPECT_DOUBLE_EQ(r.moves[0].duration, 1.0);  // 1 inch at 60 inch/min
  EXPECT_DOUBLE_EQ(r.moves[1].duration, 1.0);  // the feed survives the change of unit
  EXPECT_DOUBLE_EQ(r.moves[2].duration, 1.0);
  EXPECT_DOUBLE_EQ(r.moves[3].to[3], 0.09);
  EXPECT_NEAR(r.moves[3].duration, 30.0, 1e-12);  // 90 degrees at 180 degrees a minute
}

TEST(Reader, ChordsStayWithinTheArcTolerance) {
  for (const double tolerance : {1e-6, 1e-5, 1e-4}) {
    const Recorder r = read("G1 F600 X10\nG3 X-10 Y0 I-10 J0\n", "a.ngc", {tolerance});
    ProgramPoint previous = r.moves[0].to;
    double largest = 0.0, time = 0.0;
    for (std::size_t i = 1; i < r.moves.size(); ++i) {
      const ProgramPoint& p = r.moves[i].to;
      EXPECT_NEAR(std::hypot(p[0], p[1]), 0.01, 1e-15);
      EXPECT_GE(p[1], 0.0);  // counterclockwise from +x to -x
      largest = std::max(largest, 0.01 - std::hypot(0.5 * (p[0] + previous[0]), 0.5 * (p[1] + previous[1])));
      time += r.moves[i].duration;
      previous = p;
    }
    EXPECT_LE(largest, tolerance * (1.0 + 1e-9));
    EXPECT_GT(largest, 0.5 * tolerance);  // and no finer than needed
    EXPECT_NEAR(time, std::numbers::pi, std::numbers::pi * tolerance / 0.01);
  }
}

TEST(Reader, RadiusFormChoosesTheShortOrLongArc) {
  // Quarter circle from (0,0) to (10,10), counterclockwise about (0,10); its middle is (10 sin 45, 10 - 10 cos 45).
  const auto middle = [](const char* line) {
    const Recorder r = read(std::string("G1 F100 X0\n") + line, "a.ngc", {1.0});
    return r.moves;
  };
  const auto short_ccw = middle("G3 X10 Y10 R10\n");
  ASSERT_EQ(short_ccw.size(), 2U);  // one chord a quarter turn at least
  EXPECT_EQ(middle("G3 X10 Y10 R-10\n").size(), 4U);
  const auto long_cw = middle("G2 X10 Y10 R-10\n");  // three quarters clockwise about (0,10): by (-10,10), (0,20)
  ASSERT_EQ(long_cw.size(), 4U);
  EXPECT_NEAR(long_cw[1].to[0], -0.01, 1e-15);
  EXPECT_NEAR(long_cw[1].to[1], 0.01, 1e-15);
  EXPECT_NEAR(long_cw[2].to[1], 0.02, 1e-15);
}

TEST(Reader, ReadsCsv) {
  const Recorder r = read("# a path\ny_mm, x_mm,feed_mm_min\n1,2,\n1,12,600\n\n1,12,600\n", "path.csv");
  EXPECT_DOUBLE_EQ(r.start[0], 2e-3);
  EXPECT_DOUBLE_EQ(r.start[1], 1e-3);
  ASSERT_EQ(r.moves.size(), 2U);
  EXPECT_DOUBLE_EQ(r.moves[0].duration, 1.0);
  EXPECT_EQ(r.moves[0].line, 4);
  EXPECT_EQ(r.moves[1].duration, 0.0);
}

TEST(Reader, ReadsWhatNumpyWrites) {
  // np.savetxt(f, a, header="x_mm y_mm feed_mm_min"), and the same with delimiter="," and comments="".
  const std::string blanks =
      "# made by numpy\n# x_mm y_mm feed_mm_min\n0.000000000000000000e+00 0.000000000000000000e+00 "
      "0.000000000000000000e+00\n"
      "1.000000000000000000e+01 -2.500000000000000139e-03 6.000000000000000000e+02\n";
  std::string commas = blanks.substr(blanks.find("x_mm"));
  for (char& c : commas) c = c == ' ' ? ',' : c;
  for (const std::string& text : {blanks, commas, "# " + commas, "\xef\xbb\xbf" + commas, "\xef\xbb\xbf" + blanks}) {
    const Recorder r = read(text, "path.csv");
    ASSERT_EQ(r.moves.size(), 1U) << text;
    EXPECT_DOUBLE_EQ(r.moves[0].to[0], 0.01);
    EXPECT_DOUBLE_EQ(r.moves[0].to[1], -2.5e-6);
    EXPECT_NEAR(r.moves[0].duration, 1.0, 1e-7);
  }
  const Recorder r = read("x_mm,feed_mm_min\n0,\n1e1,6E2\n+1.5e+1,600\n1e-400,600.\n", "path.csv");
  ASSERT_EQ(r.moves.size(), 3U);
  EXPECT_DOUBLE_EQ(r.moves[0].to[0], 0.01);
  EXPECT_DOUBLE_EQ(r.moves[1].to[0], 0.015);
  EXPECT_DOUBLE_EQ(r.moves[2].to[0], 0.0);
  expect_error("x_mm,feed_mm_min\n0,0\n1e13,100\n", "3:1", "not a number", "p.csv");
  expect_error("x_mm,feed_mm_min\n0,0\n1e400,100\n", "3:1", "not a number", "p.csv");
  expect_error("x_mm,feed_mm_min\n0,0\n1e,100\n", "3:2", "2 values", "p.csv");
  expect_error("x_mm,feed_mm_min\n0,0\n1 100\n", "3:3", "commas between", "p.csv");
  expect_error("x_mm feed_mm_min\n0 0\n1,100\n", "3:2", "2 values", "p.csv");
  expect_error("x_mm feed_mm_min\n0 0\ninf 100\n", "3:1", "not a number", "p.csv");
  expect_error("x_mm feed_mm_min x_mm\n", "1:18", "twice", "p.csv");
  expect_error("# x_mm\n1,2\n", "2:1", "unknown column '1'", "p.csv");
  expect_error("x_mm\n", "1:1", "needs a column feed_mm_min", "p.csv");
}

TEST(Reader, PassesOverAByteOrderMark) {
  EXPECT_EQ(read("\xef\xbb\xbfG1 F1 X1\n").moves.size(), 1U);
  EXPECT_EQ(read("\xef\xbb\xbfSET_FEED_RATE(1)\nSTRAIGHT_FEED(1, 2, 3)\n").moves.size(), 1U);
  expect_error("\xef\xbb\xbfG1 F1 Y\n", "1:7", "word Y");
  expect_error("G1 F1\n\xef\xbb\xbfX1\n", "2:1", "byte 0xef");
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("accdec_mark_" + std::to_string(::getpid()) + ".ngc");
  std::ofstream(file) << "\xef\xbb\xbfG1 F1 X1\n";
  LineSource source(file);
  Recorder recorder;
  read_program(source, {}, recorder);
  EXPECT_EQ(recorder.moves.size(), 1U);
  std::filesystem::remove(file);
}

TEST(Reader, StopsAtTheProgramEnd) {
  EXPECT_EQ(read("G1 F1 X1\nM30\nX2\n").moves.size(), 1U);
  EXPECT_EQ(read("%\nG1 F1 X1\n%\nX2\n").moves.size(), 1U);
  EXPECT_EQ(read("G1F1X1").moves.size(), 1U);  // no line end
  EXPECT_EQ(read("G1 F1 X1 \r\n x2 \r\n").moves.size(), 2U);
  EXPECT_EQ(read("").moves.size(), 0U);
}

TEST(Reader, NamesTheErrorAndItsPlace) {
  expect_error("G1 X1\n", "1:4", "no feed");
  expect_error("G1 F100 X\n", "1:9", "word X has no number");
  expect_error("G1 F100 Xnan\n", "1:9", "word X has no number");
  expect_error("G1 F100\n X1 X2\n", "2:5", "twice");
  expect_error("G1 F-5 X1\n", "1:4", "negative");
  // As in rs274: no feed may be set, but nothing moves with it, and G94 forgets the feed.
  expect_error("G1 F0 X1\n", "1:7", "the feed is zero");
  expect_error("F600\nG94\nG1 X1\n", "3:4", "no feed");
  EXPECT_EQ(read("G94 F600\nG1 X1\nF0\nG0 X2\n").moves.size(), 2U);
  expect_error("G1 N5 F600 X1\n", "1:4", "first word");
  expect_error("G33 Z-1 K1\n", "1:1", "spindle");
  expect_error("G1 F600 X1\nG95 F0.1\n", "2:1", "spindle");
  expect_error("G1 F1 X1e400\n", "1:9", "word E");
  expect_error("G1 F1 X" + std::string(400, '9') + "\n", "1:7", "word X has no number");
  expect_error("X1\n", "1:1", "without a motion");
  expect_error("G6 X1\n", "1:1", "interpreter is needed for G6");
  expect_error("G61.3\n", "1:1", "interpreter is needed for G61.3");
  expect_error("M98 P1\n", "1:1", "interpreter is needed for M98");
  expect_error("G1 G2 X1 F1\n", "1:4", "contradicts");
  expect_error("#1=2\n", "1:1", "parameters");
  expect_error("G1 X#1\n", "1:5", "parameters");
  expect_error("G1 X[1+2]\n", "1:5", "expressions");
  expect_error("O100 sub\n", "1:1", "O words");
  expect_error("G1 (a (b)\n", "1:7", "inside a comment");
  expect_error("G1 (a\n", "1:4", "without its ')'");
  expect_error(std::string("G1 F1\nX1\0Y2\n", 13), "2:3", "byte 0x00");
  expect_error("\x7f\x45\x4c\x46\n", "1:1", "byte 0x7f");
  expect_error("G1 F1 X1 I3\n", "1:10", "word I");
  expect_error("G2 F1 X1 Y1\n", "1:7", "needs R, or I and J");
  expect_error("G18 G2 F1 X1 Z1\n", "1:11", "needs R, or K and I");
  expect_error("G2 F1 X1 Y1 I5 J0\n", "1:7", "impossible arc: radius");
  expect_error("G2 F1 X10 Y0 R4\n", "1:7", "twice the radius");
  expect_error("G2 F1 X0 Y0 R4\n", "1:7", "full circle");
  expect_error("G2 F1 X0 Y0 I0 J0\n", "1:7", "radius is 0");
  expect_error("G2 F1 X1 Y1 R1 P1.5\n", "1:16", "whole number");
  expect_error("G64 P-0.1\n", "1:5", "cannot be negative");
  expect_error("G4\n", "1:1", "needs its time");
  expect_error("G1 F1 X1\n/X2 /\nX3 / Y4\n", "3:4", "'/'");
  expect_error("x_mm,feed_mm_min\n0,\n1,100\n2\n", "4:2", "2 values", "p.csv");
  expect_error("x_mm,feed\n", "1:6", "unknown column", "p.csv");
  expect_error("x_mm,feed_mm_min\n0,0\n1,nan\n", "3:3", "not a number", "p.csv");
  expect_error("x_mm,feed_mm_min\n0,0\n1,0\n", "3:3", "positive", "p.csv");
  expect_error("SET_FEED_RATE(100)\nSTRAIGHT_FEED(1, 2)\n", "2:19", "fewer than 3");
  expect_error("SET_FEED_RATE(100)\nSTRAIGHT_FEED(1, x, 2)\n", "2:18", "not a number");
  expect_error("USE_LENGTH_UNITS(CANON_UNITS_CM)\n", "1:18", "CANON_UNITS_INCHES");
  expect_error("STRAIGHT_PROBE(0, 0, 0)\n", "1:1", "G38.2 to G38.5 end where the probe touches");
}

TEST(Reader, RefusesEndlessLinesInConstantMemory) {
  const std::string text = "G1 F1 X1\n(" + std::string(1 << 20, 'x');
  expect_error(text, "2:65537", "longer than 65536");
}

}  // namespace
}  // namespace accdec
