// Splines of programs that LinuxCNC's rs274 runs. If it is not installed, most are skipped.

#include <cmath>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/gcode/run_rs274.hpp>
#include <accdec/simulate.hpp>

#include "program_command.hpp"

namespace accdec::printed_splines_test {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;

TEST(NumberedLines, OfSplinesMakeRs274PrintTheirNumbers) {
  const std::string message = "(debug,accdec spline G5.1 I#<accdec_I> J#<accdec_J> X#<_x> Y#<_y>)\n";
  const auto lines = [](const std::string& text) { return numbered_lines(text); };
  EXPECT_EQ(lines("G5.1 X[#1*2] Y1 I-#<a b> J[1/[2+3]] (c)"),
            "N0000000001#<accdec_I>=-#<AB>#<accdec_J>=[1/[2+3]]\n"
            "N0000000001G5.1 X[#1*2] Y1 I-#<a b> J[1/[2+3]] (c)\nN0000000001" +
                message);
  EXPECT_EQ(lines("g05.1 x1 y1 iatan[1]/[2] j##1 m30"),
            "N0000000001#<accdec_I>=ATAN[1]/[2]#<accdec_J>=##1\nN0000000001G05.1X1Y1IATAN[1]/[2]J##1\nN0000000001" +
                message + "N0000000001M30\n");
  for (const char* other : {"G54", "G5.1 X1 Y1 I1", "G55 I1 J1 P1 Q1", "G5.3", "G1 X5", "G5 X1 Y1 I1 P1 Q1"})
    EXPECT_EQ(lines(other), "N0000000001" + std::string(other) + "\n");
  EXPECT_EQ(lines("G5.2 X1 Y2 P1\nX3 Y4 P2\nG5.3\nX5"),
            "N0000000001#<accdec_X>=1#<accdec_Y>=2#<accdec_P>=1\n"
            "N0000000001(debug,accdec spline G5.2 X#<accdec_X> Y#<accdec_Y> P#<accdec_P> A#<_absolute>)\n"
            "N0000000001G5.2 X1 Y2 P1\n"
            "N0000000002#<accdec_X>=3#<accdec_Y>=4#<accdec_P>=2\n"
            "N0000000002(debug,accdec spline G5.2 X#<accdec_X> Y#<accdec_Y> P#<accdec_P> A#<_absolute>)\n"
            "N0000000002X3 Y4 P2\nN0000000003G5.3\nN0000000004X5\n");
}

class PrintedSplines : public ProgramCommand {
 protected:
  void SetUp() override {
    if (std::system("command -v rs274 > /dev/null") != 0) GTEST_SKIP() << "rs274 (linuxcnc-uspace) is not installed";
    ProgramCommand::SetUp();
  }
  Toolpath interpreted(const std::string& text) {
    write("part.ngc", text);
    return read_interpreted(folder_.path("part.ngc"), {}, machine_, {});
  }
  Toolpath own(const std::string& text) {
    LineSource source("part.ngc", text);
    return read_toolpath(source, machine_, {});
  }
  /// Both have the same points, but for the four decimals of straight moves and the six of control points.
  static void expect_same(const Toolpath& a, const Toolpath& b, double turn = 0.0) {
    ASSERT_EQ(a.blocks(), b.blocks());
    for (std::size_t i = 0; i <= a.blocks(); ++i) {
      const double x = b.point(i)[0], y = b.point(i)[1], c = std::cos(turn), s = std::sin(turn);
      EXPECT_NEAR(a.point(i)[0], c * x - s * y, 2e-9) << i;
      EXPECT_NEAR(a.point(i)[1], s * x + c * y, 2e-9) << i;
    }
  }
  const Machine machine_{};
};

constexpr const char* written =
    "G21 G90 G64 P0.05 F1000\nG1 X1 Y0\nG5 I0 J3 P0 Q-3 X4 Y5\nG5 X6.5 Y5.25 P1 Q-2\nG5.1 I1 J2 X8 Y5\nG5.2 L3 P1 X9 "
    "Y6\nX10 Y7 P1\nX11 Y5 P2\nX12 Y8 P1\nX13 Y9 P1\nG5.3\nG1 X15 Y9\n";

TEST_F(PrintedSplines, AreThoseWrittenInNumbers) {
  const std::string by_parameters =
      "#1=3 #<two>=2\nG21 G90 G64 P0.05 F[500*#<two>]\nG1 X1 Y0\nG5 I0 J#1 P0 Q-#1 X[#1+1] Y[10/#<two>]\n"
      "G5 X6.5 Y5.25 P1 Q-#<two>\nG5.1 I1 J#<two> X8 Y5 (note)\n#5=9\nG5.2 L3 P1 X#5 Y[#5-#1]\n"
      "X[#5+1] Y7 P1\nX11 Y5 P#<two>\nX12 Y8 P1\nX13 Y#5 P1\nG5.3\nG1 X15 Y9\nM2\n";
  const Toolpath path = interpreted(by_parameters);
  expect_same(path, own(written + std::string("M2\n")));
  EXPECT_EQ(path.line[path.blocks() - 1], 14);
  EXPECT_EQ(path.line[1], 4) << "lines are the program's";
}

TEST_F(PrintedSplines, FollowUnitsOffsetsAndDistances) {
  const std::string plain = "G21 G90 G64 P0.05 F1270\nG1 X2.54 Y0\nG5.1 X10.16 Y5.08 I2.54 J3.81\nG1 X20.32\nM2\n";
  const Toolpath path = own(plain);
  expect_same(interpreted("G20 G90 G64 P[0.05/25.4] F50\nG1 X.1 Y0\nG5.1 X.4 Y.2 I.1 J.15\nG1 X.8\nM2\n"), path);
  expect_same(interpreted("G21 G90 G64 P0.05 F1270\n#1=2.54\nG1 X#1 Y0\nG91 G5.1 X7.62 Y5.08 I#1 J3.81 M1\nG90 G1 "
                          "X20.32\nM2\n"),
              path);
  // The frame of the program is moved where the machine stands at (2.54, 0), then in the middle of the program.
  expect_same(interpreted("G21 G90 G64 P0.05 F1270\nG1 X2.54 Y0\nG92 X0 Y1\nG5.1 X7.62 Y6.08 I2.54 J3.81\nG92.1\nG1 "
                          "X20.32\nM2\n"),
              path);
  const double turn = 0.52359877559829887;  // 30 degrees
  expect_same(interpreted("G10 L2 P1 X0 Y0 R30\n" + plain), path, turn);
}

TEST_F(PrintedSplines, StandInLoopsAndBeforeTheEnd) {
  const std::string head = "G21 G90 G64 P0.05 F1000\nG1 X1 Y0\n";
  const Toolpath path = own(head + "G5.1 X3 Y1 I1 J0\nG5.1 X5 Y2 I1 J0\nM2\n");
  expect_same(interpreted(head + "#1=1\nO100 repeat [2]\n#1=[#1+2]\nG5.1 X#1 Y[[#1-1]/2] I1 J0\nO100 endrepeat\nM2\n"),
              path);
  expect_same(interpreted(head + "#1=3\nG5.1 X#1 Y1 I1 J0 M0\nG5.1 X5 Y2 I1 J0 M2\n"), path);
}

TEST_F(PrintedSplines, AreRefusedWhereNobodyKnowsThem) {
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      interpreted(text);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  };
  const std::string head = "G21 F1000\n#1=5\nG1 X#1\n";
  EXPECT_THAT(refusal(head + "G[5+0.1] X1 Y1 I1 J1\nG1 X5\nM2\n"), HasSubstr("part.ngc:4:1: rs274 prints G5 to G5.3"));
  EXPECT_THAT(refusal(head + "G5.1 X1 Y1 I1\nM2\n"), HasSubstr("part.ngc:4:1: refused by rs274"));
  EXPECT_THAT(refusal("G21 F1000\n#1=5\nG5.1 X1 Y1 I1 J1 G91 G18\nM2\n"), HasSubstr("part.ngc:3:1: "));
}

}  // namespace
}  // namespace accdec::printed_splines_test
