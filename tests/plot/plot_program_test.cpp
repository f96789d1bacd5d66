#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/motion/shapes.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_motion.hpp>
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

TEST(PlotProgram, CornersHaveTheColourOfTheirErrorOverTolerance) {
  // An exact stop in (50, 0), a corner within its tolerance in (50, 50).
  const ProgramResult result = planned("G61.1 G1 F6000 X50\nG64 P0.1 Y50\nX0\n");
  const Figure figure = plot_program(result);
  ASSERT_EQ(figure.panels.size(), 3U);
  const Panel& path = figure.panels[0];
  EXPECT_EQ(path.x.label, "x / mm");
  EXPECT_EQ(path.y.label, "y / mm");
  EXPECT_EQ(value_at(path, 50.0, 0.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(value_at(path, 50.0, 50.0, 1.0), 100.0 * result.plan.errors[1] / 0.1e-3);
  EXPECT_EQ(value_at(path, 25.0, 50.0, 20.0), -1.0) << "a leg has no colour";
  EXPECT_THAT(figure.title, HasSubstr("part.ngc"));
}

TEST(PlotProgram, LegsHaveTheColourOfTheirSpeedAndRapidMovesNone) {
  const ProgramResult result = planned("G1 F6000 X50\nF3000 Y50\n");
  const Panel path = plot_program(result).panels[1];
  EXPECT_NEAR(value_at(path, 0.0, 0.0, 0.1), 100.0, 1e-9);   // 6000 mm/min
  EXPECT_NEAR(value_at(path, 50.0, 50.0, 0.1), 50.0, 1e-9);  // 3000 mm/min
  EXPECT_TRUE(path.series.empty());

  Task task;
  task.machine.axes.resize(1);
  task.machine.axes[0].velocity_max = 0.5;
  LineSource source("part.ngc", "G1 F6000 X50\nG0 X0 Y50\nG1 X50\n");
  ToolpathOptions options;
  options.error_max = 20e-6;
  const Toolpath rapid = read_toolpath(source, task.machine, options);
  const Panel drawn = plot_program(run_program("part.ngc", rapid, trapezoid(40, 10), task)).panels[1];
  ASSERT_EQ(drawn.series.size(), 1U) << "the rapid move by itself";
  EXPECT_THAT(drawn.series[0].x, testing::ElementsAre(50.0, 0.0));
  EXPECT_EQ(value_at(drawn, 25.0, 25.0, 20.0), -1.0);
}

TEST(PlotProgram, ChordsOfArcsAreNoCorners) {
  const ProgramResult result = planned("G17 G1 F3000 X10\nG3 X20 Y10 J10\nG1 Y20\n", 50e-6);
  const Panel path = plot_program(result).panels[0];
  ASSERT_GT(result.path.blocks(), 10U);
  EXPECT_EQ(path.coloured->pieces.size(), 2U) << "the two ends of the arc";
  EXPECT_THAT(path.title, HasSubstr("inside arcs at most"));
}

TEST(PlotProgram, EnlargesThePartWithMostCorners) {
  // 80 corners in x = 90 to 98 of 100 mm.
  std::string text = "G1 F600 X90\n";
  for (int i = 0; i < 80; ++i) text += fmt::format("Y{} X{}\n", i % 2, 90.0 + 0.1 * i);
  const Figure figure = plot_program(planned(text + "X100 Y30\n"));
  ASSERT_EQ(figure.panels.size(), 4U);
  const Panel& part = figure.panels[1];
  EXPECT_LE(*part.x.min, 90.0);
  EXPECT_GE(*part.x.max, 98.0);
  EXPECT_LT(*part.x.max - *part.x.min, 0.3 * (*figure.panels[0].x.max - *figure.panels[0].x.min));
}

TEST(PlotProgram, TheHistogramCountsEveryCornerOnce) {
  std::ostringstream text;
  generate_program(GeneratedProgram::zigzag, {}, text);
  const ProgramResult result = planned(text.str());
  const Figure figure = plot_program(result);
  const Series& bars = figure.panels.back().series[0];
  EXPECT_EQ(std::accumulate(bars.y.begin(), bars.y.end(), 0.0), static_cast<double>(result.corners));
  double samples = 0.0;
  for (std::size_t i = 0; i < bars.x.size(); ++i) samples += bars.x[i] * bars.y[i];
  EXPECT_NEAR(samples * result.sample_period, result.delay_total, 1e-9);
}

TEST(PlotProgram, SpeedsOverTimeHaveTheNameOfTheLimitThatBinds) {
  // 60 mm at 100 mm/s and 1 m/s^2: ramps of 0.1 s, 0.7 s in all.
  Task task;
  task.machine.axes.resize(1);
  task.machine.axes[0].acceleration_max = 1.0;
  LineSource source("part.ngc", "G1 F6000 X60\n");
  const Toolpath path = read_toolpath(source, task.machine, {});
  const ProfileResult result = run_profiles("part.ngc", path, task);
  ASSERT_TRUE(result.plan.holds());
  const Figure figure = plot_program(result, path, task.machine);
  const Panel& speed = figure.panels[figure.panels.size() - 2];
  ASSERT_EQ(speed.series.size(), 2U);
  EXPECT_EQ(speed.series[0].label, "tolerance or programmed feed");
  EXPECT_EQ(speed.series[1].label, "acceleration");
  for (const Series& s : speed.series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (std::isnan(s.x[i])) continue;
      // A sample or two at the ends of the ramps are rounding.
      const double ramp = 1e3 * std::min(s.x[i], 0.7 - s.x[i]);
      EXPECT_NEAR(s.y[i], std::min(100.0, ramp), 2.0) << s.x[i];
      EXPECT_TRUE(std::abs(ramp - 100.0) < 3.0 || ramp < 3.0 || (ramp < 100.0) == (&s != speed.series.data()));
    }
  }
  // Each ramp takes 0.05 s longer than at the feed.
  const Panel& lost = figure.panels.back();
  ASSERT_EQ(lost.x.names, std::vector<std::string>{"stops, start and end"});
  EXPECT_NEAR(lost.series[0].y[0], 0.1, 2e-3);
}

TEST(PlotProgram, MotionPanelsShowWhatStandsInTheSamples) {
  const ProgramResult result = planned("G64 P0.1 G1 F6000 X50\nF3000 Y50\nX0 Y80\nX90\n", 50e-6);
  const Figure figure = plot_program(result, result.path, {});
  ASSERT_EQ(figure.panels.size(), 5U);
  std::vector<double> speeds;  // mm/s
  visit_samples(result,
                [&](std::int64_t, const double*, const double* v) { speeds.push_back(1e3 * std::hypot(v[0], v[1])); });
  // What is drawn are samples, and no sample lies beyond what is drawn a few pixels around it.
  const auto reach = static_cast<std::ptrdiff_t>(speeds.size() / 200);
  std::vector<double> low(speeds.size(), INFINITY), high(speeds.size(), -INFINITY);
  for (const Series& s : figure.panels[3].series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (std::isnan(s.x[i])) continue;
      const auto at = std::lround(s.x[i] / result.sample_period), end = std::ssize(speeds);
      EXPECT_NEAR(s.y[i], speeds.at(static_cast<std::size_t>(at)), 1e-9);
      for (auto k = std::max(0L, at - reach); k < std::min(end, at + reach); ++k) {
        low[static_cast<std::size_t>(k)] = std::min(low[static_cast<std::size_t>(k)], s.y[i]);
        high[static_cast<std::size_t>(k)] = std::max(high[static_cast<std::size_t>(k)], s.y[i]);
      }
    }
  }
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    EXPECT_GE(speeds[k], low[k] - 1e-9) << k;
    EXPECT_LE(speeds[k], high[k] + 1e-9) << k;
  }
  const Panel& lost = figure.panels[4];
  const std::vector<CornerLoss> classes = time_lost(result.path, motion_of(result));
  ASSERT_EQ(lost.x.names.size(), lost.series[0].y.size());
  for (std::size_t i = 0; i < lost.x.names.size(); ++i) {
    const auto loss = std::find_if(classes.begin(), classes.end(),
                                   [&](const CornerLoss& c) { return class_name(c) == lost.x.names[i]; });
    ASSERT_NE(loss, classes.end());
    EXPECT_EQ(lost.series[0].y[i], loss->time);
  }
  EXPECT_TRUE(std::is_sorted(lost.series[0].y.rbegin(), lost.series[0].y.rend()));
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
  EXPECT_NEAR(darkest, 100.0 * result.worst_utilisation, 1e-9);
}

TEST(PlotProgram, DrawsOneAxisAndRotaryAxes) {
  EXPECT_THAT(render_svg(plot_program(planned("G1 F6000 X50\nX20\n"))), HasSubstr("x / mm"));
  const std::string svg = render_svg(plot_program(planned("G1 F6000 B50\nX5 B90\n")));
  EXPECT_THAT(svg, HasSubstr("x / mm"));
  EXPECT_THAT(svg, HasSubstr("b / deg"));
}

}  // namespace
}  // namespace accdec
