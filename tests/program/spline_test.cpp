#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>

#include <accdec/gcode/spline.hpp>

#include "reader_harness.hpp"

namespace accdec::spline_test {
namespace {

using Point = std::array<double, 2>;

double distance_to(const std::vector<Point>& polyline, const Point& p) {
  double least = 1e300;
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const double dx = polyline[i + 1][0] - polyline[i][0], dy = polyline[i + 1][1] - polyline[i][1];
    const double x = p[0] - polyline[i][0], y = p[1] - polyline[i][1], length2 = dx * dx + dy * dy;
    const double t = length2 > 0.0 ? std::clamp((x * dx + y * dy) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, std::hypot(x - t * dx, y - t * dy));
  }
  return least;
}

/// The definition: basis functions by the recursion of Cox and de Boor, which shares nothing with blossoms.
Point by_definition(const std::vector<ControlPoint>& control, int order, double u) {
  const int n = static_cast<int>(control.size()), top = n - order + 1;
  const auto knot = [&](int i) { return static_cast<double>(std::clamp(i - order + 1, 0, top)); };
  const std::function<double(int, int)> basis = [&](int i, int k) -> double {
    if (k == 1) {
      const bool last = u == top && knot(i + 1) == top && knot(i) < top;
      return (knot(i) <= u && u < knot(i + 1)) || last ? 1.0 : 0.0;
    }
    double sum = 0.0;
    if (const double d = knot(i + k - 1) - knot(i); d > 0.0) sum += (u - knot(i)) / d * basis(i, k - 1);
    if (const double d = knot(i + k) - knot(i + 1); d > 0.0) sum += (knot(i + k) - u) / d * basis(i + 1, k - 1);
    return sum;
  };
  double x = 0.0, y = 0.0, w = 0.0;
  for (int i = 0; i < n; ++i) {
    const double b = basis(i, order) * control[static_cast<std::size_t>(i)].weight;
    x += b * control[static_cast<std::size_t>(i)].x;
    y += b * control[static_cast<std::size_t>(i)].y;
    w += b;
  }
  return {x / w, y / w};
}

TEST(Spline, ChordsStayWithinTheToleranceOfTheDefinition) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 30; ++trial) {
    const int order = 2 + trial % 5, count = order + trial % 7;
    std::vector<ControlPoint> control;
    for (int i = 0; i < count; ++i)
      control.push_back({20e-3 * unit(random), 20e-3 * unit(random), 0.2 + 3.0 * unit(random)});
    const double tolerance = 2e-6;
    std::vector<Point> polyline = flatten_spline(control, order, tolerance);
    EXPECT_NEAR(polyline.back()[0], control.back().x, 1e-15);
    polyline.insert(polyline.begin(), Point{control.front().x, control.front().y});
    std::vector<Point> dense;
    const int steps = 400 * (count - order + 1);
    for (int i = 0; i <= steps; ++i) {
      dense.push_back(by_definition(control, order, static_cast<double>(count - order + 1) * i / steps));
      ASSERT_LE(distance_to(polyline, dense.back()), tolerance + 1e-12) << "trial " << trial << " step " << i;
    }
    // And every end of a chord lies on the curve; the dense polyline is within its own sagitta of it.
    for (const Point& p : polyline) ASSERT_LE(distance_to(dense, p), 20e-6) << "trial " << trial;
  }
}

TEST(Spline, AQuarterCircleIsOneWithItsWeights) {
  const double r = 10e-3;
  const std::vector<ControlPoint> control{{r, 0.0, 1.0}, {r, r, std::numbers::sqrt2 / 2.0}, {0.0, r, 1.0}};
  const auto points = flatten_spline(control, 3, 1e-6);
  ASSERT_GT(points.size(), 10U);
  for (const Point& p : points) EXPECT_NEAR(std::hypot(p[0], p[1]), r, 1e-16 * 100.0);
}

TEST(Spline, WordsMeanWhatLinuxCncMakesOfThem) {
  // Points that the interpreter of LinuxCNC 2.9 evaluates of these splines (its python module gcode), mm.
  const Recorder r = read(
      "G21 G90 G64 P0.05\nG1 F1000 X1 Y0\nG5 I0 J3 P0 Q-3 X4 Y5\nG5.1 I1 J2 X8 Y5\nG5.2 L3 P1 X9 Y6\nX10 Y7 P1\n"
      "X11 Y5 P2\nX12 Y8 P1\nX13 Y9 P1\nG5.3\nG1 X15 Y9\n",
      "part.ngc", {.arc_tolerance = 1e-8});
  std::vector<Point> polyline{{0.0, 0.0}};
  for (const Move& move : r.moves) polyline.push_back({move.to[0], move.to[1]});
  for (const Point& p : {Point{1.777777778, 1.962962963},
                         {2.5, 2.5},
                         {3.777777778, 3.796296296},
                         {4.744691358, 5.821728395},
                         {6.018765432, 5.940246914},
                         {8.988641975, 5.988641975},
                         {10.068136273, 6.478957916},
                         {10.916464372, 5.349850064},
                         {11.353491480, 6.059806215},
                         {12.360339143, 8.175694772}}) {
    EXPECT_LE(distance_to(polyline, {p[0] * 1e-3, p[1] * 1e-3}), 1e-8 + 1e-12) << p[0];
  }
  EXPECT_EQ(r.moves.back().to[0], 0.015);
  EXPECT_TRUE(r.moves[5].inside_arc);
  double length = 0.0, time = 0.0;
  for (std::size_t i = 1; i < r.moves.size(); ++i) {
    length += std::hypot(r.moves[i].to[0] - r.moves[i - 1].to[0], r.moves[i].to[1] - r.moves[i - 1].to[1]);
    time += r.moves[i].duration;
  }
  EXPECT_NEAR(time, length / (1.0 / 60.0), 1e-9);
}

TEST(Spline, ASecondCubicGoesOnSmoothly) {
  const std::string first = "G1 F1000 X1\nG5 X4 Y5 I0 J3 P-1 Q-2\n";
  const Recorder a = read(first + "G5 X9 Y5 P0 Q3\n"), b = read(first + "G5 X9 Y5 I1 J2 P0 Q3\n");
  ASSERT_EQ(a.moves.size(), b.moves.size());
  for (std::size_t i = 0; i < a.moves.size(); ++i) EXPECT_EQ(a.moves[i].to, b.moves[i].to);
}

TEST(Spline, WrongWordsAreRefusedWithTheirPlace) {
  const std::string feed = "G1 F1000 X1\n";
  expect_error(feed + "G5 X1 Y1 I1 J1\n", "2:4", "both P and Q");
  expect_error(feed + "G5 X1 Y1 I1 P1 Q1\n", "2:4", "both I and J");
  expect_error(feed + "G5 X1 Y1 P1 Q1\n", "2:4", "the first G5 needs I and J");
  expect_error(feed + "G5 X1 Y1 I1 J1 P1 Q1\nG1 X5\nG5 X1 Y1 P1 Q1\n", "4:4", "the first G5 needs I and J");
  expect_error(feed + "G5 X1 Y1 Z1 I1 J1 P1 Q1\n", "2:10", "X and Y only");
  expect_error(feed + "G18 G5 X1 Y1 I1 J1 P1 Q1\n", "2:8", "XY plane");
  expect_error(feed + "G5.1 X1 Y1 I1\n", "2:6", "both I and J");
  expect_error(feed + "G5.3\n", "2:1", "G5.2 must begin");
  expect_error(feed + "G5.2 X1 Y1 P1\nG5.3\n", "3:1", "order 3");
  expect_error(feed + "G5.2 X1 Y1 P1\nX2 P1\n", "3:1", "both X and Y");
  expect_error(feed + "G5.2 X1 Y1 P1\nX2 Y2 P0\n", "3:7", "above 0");
  expect_error(feed + "G5.2 X1 Y1 P1\nX2 Y2\n", "3:1", "weight P");
  expect_error(feed + "G5.2 X1 Y1 P1 L2.5\n", "2:15", "order L");
  expect_error(feed + "G5.2 X1 Y1 P1\nG1 X2\n", "3:4", "G5.3 must close");
  expect_error(feed + "G5.2 X1 Y1 P1\nM2\n", "3:1", "G5.3 must close");
  expect_error("G5 X1 Y1 I1 J1 P1 Q1\n", "1:4", "no feed");
}

}  // namespace
}  // namespace accdec::spline_test
