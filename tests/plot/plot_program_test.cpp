#include <numeric>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/motion/shapes.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/program/write/generate.hpp>

namespace accdec {
namespace {

using testing::HasSubstr;

ProgramResult planned(const std::string& text, double tolerance = 20e-6) {
  Task task;
  ToolpathOptions options;
  options.error_max = tolerance;
  LineSource source("part.ngc", text);
  return run_program("folder/part.ngc", read_toolpath(source, {}, options), trapezoid(40, 10), task);
}

/// The largest value drawn within `radius` of a point.
double value_at(const Panel& panel, double x, double y, double radius) {
  double largest = -1.0;
  for (const ColouredLines::Piece& piece : panel.coloured->pieces) {
    for (std::size_t i = 0; i < piece.x.size(); ++i) {
      if (std::hypot(piece.x[i] - x, piece.y[i] - y) <= radius) largest = std::max(largest, piece.value);
    }
  }
  return largest;
}

TEST(PlotProgram, HalfOfEveryBlockHasTheColourOfItsCornersErrorOverTolerance) {
  // An exact stop in (50, 0), a corner within its tolerance in (50, 50).
  const ProgramResult result = planned("G61.1 G1 F6000 X50\nG64 P0.1 Y50\nX0\n");
  const Figure figure = plot_program(result);
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel& path = figure.panels[0];
  EXPECT_EQ(path.x.label, "x / mm");
  EXPECT_EQ(path.y.label, "y / mm");
  EXPECT_EQ(value_at(path, 25.0, 0.0, 25.1), 0.0);
  const double use = 100.0 * result.plan.errors[1] / 0.1e-3;
  EXPECT_NEAR(value_at(path, 50.0, 50.0, 0.1), use, 2.5 + 1e-9);  // a step of the colour bar is 5 %
  EXPECT_NEAR(value_at(path, 25.0, 50.0, 0.1), use, 2.5 + 1e-9);
  EXPECT_EQ(value_at(path, 0.0, 50.0, 0.1), 0.0);
  EXPECT_THAT(figure.title, HasSubstr("part.ngc"));
}

TEST(PlotProgram, TheHistogramCountsEveryCornerOnce) {
  std::ostringstream text;
  generate_program(GeneratedProgram::zigzag, {}, text);
  const ProgramResult result = planned(text.str());
  const Figure figure = plot_program(result);
  const Series& bars = figure.panels[1].series[0];
  EXPECT_EQ(std::accumulate(bars.y.begin(), bars.y.end(), 0.0), static_cast<double>(result.corners));
  double samples = 0.0;
  for (std::size_t i = 0; i < bars.x.size(); ++i) samples += bars.x[i] * bars.y[i];
  EXPECT_NEAR(samples * result.sample_period, result.delay_total, 1e-9);
}

TEST(PlotProgram, ADensePathStaysASmallDrawing) {
  std::ostringstream text;
  GenerateOptions options;
  options.blocks = 200000;
  generate_program(GeneratedProgram::raster, options, text);
  const ProgramResult result = planned(text.str());
  const Figure figure = plot_program(result);
  EXPECT_LT(render_svg(figure).size(), 3'000'000U);
  // The largest error is seen although most points are not.
  const auto& pieces = figure.panels[0].coloured->pieces;
  const double darkest = std::max_element(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) {
                           return a.value < b.value;
                         })->value;
  EXPECT_NEAR(darkest, 100.0 * result.worst_utilisation, 2.5 + 1e-9);
}

TEST(PlotProgram, DrawsOneAxisAndRotaryAxes) {
  EXPECT_THAT(render_svg(plot_program(planned("G1 F6000 X50\nX20\n"))), HasSubstr("x / mm"));
  const std::string svg = render_svg(plot_program(planned("G1 F6000 B50\nX5 B90\n")));
  EXPECT_THAT(svg, HasSubstr("x / mm"));
  EXPECT_THAT(svg, HasSubstr("b / deg"));
}

}  // namespace
}  // namespace accdec
