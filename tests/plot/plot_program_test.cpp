#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/gcode/generate.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/plot/program_view.hpp>

namespace accdec {
namespace {

using testing::HasSubstr;

ProgramResult planned(const std::string& text, double tolerance = 20e-6) {
  Task task;
  ToolpathOptions options;
  options.error_max = tolerance;
  LineSource source("part.ngc", text);
  return run_program({"folder/part.ngc", read_toolpath(source, {}, options), task}, trapezoid(40, 10));
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
  EXPECT_DOUBLE_EQ(value_at(path, 50.0, 50.0, 1.0), 100.0 * result.errors[1] / 0.1e-3);
  EXPECT_EQ(value_at(path, 25.0, 50.0, 20.0), -1.0) << "a leg has no colour";
  EXPECT_THAT(figure.title, HasSubstr("part.ngc"));
  EXPECT_THAT(figure.title, HasSubstr(fmt::format("; at least {:.5g} s (way over feed)", result.lower_bound)));
  ProgramResult bounded = result;
  bounded.corner_bound.emplace();
  bounded.corner_bound->time = 1.25;
  bounded.corner_bound->any_motion = 1.125;
  EXPECT_THAT(plot_program(bounded).title, HasSubstr("; at least 1.125 s (any motion), 1.25 s (monotone legs)"));
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
  const Panel drawn = plot_program(run_program({"part.ngc", rapid, task}, trapezoid(40, 10))).panels[1];
  ASSERT_EQ(drawn.series.size(), 1U) << "the rapid move by itself";
  EXPECT_THAT(drawn.series[0].x, testing::ElementsAre(50.0, 0.0));
  EXPECT_EQ(value_at(drawn, 25.0, 25.0, 20.0), -1.0);
}

// The power of all axes together from the velocities: m a v of each.
TEST(PlotProgram, TheSupplyOfAllAxesBindsByName) {
  Task task;
  task.machine.axes.assign(2, {});
  task.machine.axes[0].name = "x", task.machine.axes[1].name = "y";
  for (Axis& axis : task.machine.axes) axis.mass = 30.0, axis.force_max = 1e6;
  LineSource source("part.ngc", "G1 F6000 X50\nX80 Y40\nY70\n");
  ToolpathOptions options;
  options.error_max = 20e-6;
  const ProgramResult result =
      run_program({"part.ngc", read_toolpath(source, task.machine, options), task}, trapezoid(40, 10));
  std::vector<double> powers, before(2, 0.0);
  std::vector<int> binds;
  const auto visit = [&](std::int64_t, const double*, const double* v, int binding) {
    double power = 0.0;
    for (std::size_t a = 0; a < 2; ++a)
      power += 30.0 * (v[a] - std::exchange(before[a], v[a])) / result.sample_period * v[a];
    powers.push_back(power), binds.push_back(binding);
  };
  visit_velocities(task.machine, motion_of(result), visit);
  const auto [most_braking, most] = std::ranges::minmax(powers);
  ASSERT_GT(most, 0.0);
  ASSERT_LT(most_braking, 0.0);
  EXPECT_THAT(binds, testing::Each(-1));

  task.machine.power_total_max = most, task.machine.regeneration_total_max = -most_braking;
  powers.clear(), binds.clear(), before.assign(2, 0.0);
  visit_velocities(task.machine, motion_of(result), visit);
  std::array<int, 3> seen{};
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const double motoring = powers[i] / most, braking = powers[i] / most_braking;
    if (std::abs(std::max(motoring, braking) - 0.98) < 1e-6) continue;
    const bool draws = motoring > 0.98, gives = braking > 0.98;
    ++seen.at(draws ? 0 : gives ? 1 : 2);
    EXPECT_EQ(binding_name(binds[i]), binding_name(draws ? 7 : gives ? 8 : -1)) << i;
  }
  EXPECT_THAT(seen, testing::Each(testing::Gt(0)));
  EXPECT_EQ(binding_name(7), "power_total");
  EXPECT_EQ(binding_name(8), "regeneration_total");
  const auto styles = binding_styles(task.machine);
  EXPECT_NE(styles[7], styles[8]);
}

// At corners feeds are chosen in short slow parts of blocks; the drawing's pixel is 0.08 mm here.
TEST(PlotProgram, AShortSlowMoveGivesTheLongOneBehindItNeitherItsSpeedNorItsPlace) {
  const Panel path = plot_program(planned("G1 F600 Y0.03\nF6000 X50\n")).panels[1];
  EXPECT_NEAR(value_at(path, 50.0, 0.03, 0.01), 100.0, 1e-9);  // 6000 mm/min
  EXPECT_NEAR(value_at(path, 0.0, 0.03, 0.001), 100.0, 1e-9) << "begins where its block does";
  EXPECT_NEAR(value_at(path, 0.0, 0.0, 0.001), 10.0, 1e-9);
}

TEST(PlotProgram, ChordsOfArcsAreNoCorners) {
  const ProgramResult result = planned("G17 G1 F3000 X10\nG3 X20 Y10 J10\nG1 Y20\n", 50e-6);
  const Panel path = plot_program(result).panels[0];
  ASSERT_GT(result.plan.path.blocks(), 10U);
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

TEST(PlotProgram, ALongThinPathFillsItsPanelAndTheAxisSaysSo) {
  // 20 mm by 2000 mm: true to scale 4 of 640 px.
  std::string text = "G1 F6000 X20\n";
  for (int i = 1; i <= 20; ++i) text += fmt::format("X{} Y{}\n", i % 2 == 0 ? 20 : 0, 100 * i);
  const Figure figure = plot_program(planned(text));
  for (const Panel* panel : {&figure.panels[0], &figure.panels[1]}) {
    EXPECT_EQ(panel->x.label, "x / mm, drawn 100 times as long");
    EXPECT_EQ(panel->y.label, "y / mm");
    EXPECT_FALSE(panel->equal_aspect);
    EXPECT_LE(*panel->x.max - *panel->x.min, 2.0 * 20.0) << "at least half of the panel";
    EXPECT_LE(*panel->y.max - *panel->y.min, 2.0 * 2000.0);
  }
  // Places stay in mm.
  double left = INFINITY, right = -INFINITY;
  for (const double x : figure.panels[0].series.at(0).x) left = std::min(left, x), right = std::max(right, x);
  EXPECT_NEAR(left, 0.0, 1e-9);
  EXPECT_NEAR(right, 20.0, 1e-9);
  EXPECT_GE(value_at(figure.panels[0], 0.0, 100.0, 0.5), 0.0) << "a corner's square";
  // Neither a path of usual proportions nor a straight one is stretched.
  EXPECT_EQ(plot_program(planned("G1 F6000 X50\nY20\n")).panels[0].x.label, "x / mm");
  EXPECT_EQ(plot_program(planned("G1 F6000 X50\nX20\n")).panels[0].y.label.find("times"), std::string::npos);
}

TEST(PlotProgram, APathOfAnyProportionFillsAThirdOfItsPanel) {
  // A plot that leaves no empty side is 640 px wide and 160 to 390 px high, less the air of 8 px around the path.
  for (const double height : {1.0, 4.0, 8.0, 20.0, 60.0, 100.0, 150.0, 200.0, 300.0, 500.0, 1000.0, 5000.0}) {
    const Figure figure = plot_program(planned(fmt::format("G1 F6000 X100\nY{}\nX0\n", height)));
    const Panel& panel = figure.panels[0];
    const double wide = *panel.x.max - *panel.x.min, high = *panel.y.max - *panel.y.min;
    EXPECT_GE(height / high, 1.0 / 3.0) << height;
    EXPECT_GE(100.0 / wide, 1.0 / 3.0) << height;
    if (!panel.equal_aspect) continue;
    const double pixel = std::max(wide / 640.0, high / 390.0), plot = std::max(160.0, high / pixel);
    EXPECT_GE(100.0 / pixel, 640.0 / 3.0) << height << ": no empty sides";
    EXPECT_GE(height / pixel, plot / 3.0) << height << ": nor above and below";
  }
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

// One corner: ticks between whole delays or numbers of corners would mean nothing. Without corners there is none.
TEST(PlotProgram, AHistogramOfOneValueHasWholeTicks) {
  Figure figure = plot_program(planned("G64 P0.01 F6000 G1 X50\nY50\n"));
  const Panel& delays = figure.panels.back();
  EXPECT_THAT(delays.title, HasSubstr("delays of 1 joint,"));
  ASSERT_EQ(delays.series[0].x.size(), 1U);
  EXPECT_EQ(delays.series[0].y[0], 1.0);
  EXPECT_THAT(figure.panels.front().title, HasSubstr("1 corner by its error"));
  figure.panels = {delays};
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("set xtics 1\n"));
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("set ytics 1\n"));
  for (const Panel& panel : plot_program(planned("F6000 G1 X50\n")).panels)
    EXPECT_EQ(panel.title.find("delays"), std::string::npos) << panel.title;
}

TEST(PlotProgram, SpeedsOverTimeHaveTheNameOfTheLimitThatBinds) {
  // 60 mm at 100 mm/s and 1 m/s^2: ramps of 0.1 s, 0.7 s in all.
  Task task;
  task.machine.axes.resize(1);
  task.machine.axes[0].acceleration_max = 1.0;
  LineSource source("part.ngc", "G1 F6000 X60\n");
  const Toolpath path = read_toolpath(source, task.machine, {});
  const ProgramResult result = run_profiles({"part.ngc", path, task});
  ASSERT_TRUE(result.verification.feasible);
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
  const Figure figure = plot_program(result, result.plan.path, {});
  ASSERT_EQ(figure.panels.size(), 5U);
  std::vector<double> speeds;  // mm/s
  visit_samples(result,
                [&](std::int64_t, const double*, const double* v) { speeds.push_back(1e3 * std::hypot(v[0], v[1])); });
  // Samples are drawn, and no sample lies more than a few pixels outside the drawing.
  const auto reach = static_cast<std::ptrdiff_t>(speeds.size() / 200);
  std::vector<double> low(speeds.size(), INFINITY), high(speeds.size(), -INFINITY);
  for (const Series& s : figure.panels[3].series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (std::isnan(s.x[i])) continue;
      const auto at = std::lround(s.x[i] / result.sample_period), end = std::ssize(speeds);
      EXPECT_NEAR(s.y[i], speeds.at(static_cast<std::size_t>(at)), 1e-9);
      // Between two points the line is drawn, along which steady motion needs no others.
      const bool goes_on = i > 0 && !std::isnan(s.x[i - 1]);
      for (auto k = goes_on ? std::lround(s.x[i - 1] / result.sample_period) : at; k < at; ++k) {
        const double part = 1.0 - (s.x[i] - static_cast<double>(k) * result.sample_period) / (s.x[i] - s.x[i - 1]);
        const double drawn = s.y[i - 1] + part * (s.y[i] - s.y[i - 1]);
        low[static_cast<std::size_t>(k)] = std::min(low[static_cast<std::size_t>(k)], drawn);
        high[static_cast<std::size_t>(k)] = std::max(high[static_cast<std::size_t>(k)], drawn);
      }
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
  const std::vector<CornerLoss> classes = time_lost(result.plan.path, motion_of(result));
  ASSERT_EQ(lost.x.names.size(), lost.series[0].y.size());
  for (std::size_t i = 0; i < lost.x.names.size(); ++i) {
    const auto loss = std::find_if(classes.begin(), classes.end(),
                                   [&](const CornerLoss& c) { return class_name(c) == lost.x.names[i]; });
    ASSERT_NE(loss, classes.end());
    EXPECT_EQ(lost.series[0].y[i], loss->time);
  }
  EXPECT_TRUE(std::is_sorted(lost.series[0].y.rbegin(), lost.series[0].y.rend()));
  EXPECT_EQ(*lost.x.max, 0.5 + std::max<std::size_t>(2, lost.x.names.size())) << "no room without bars";
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

/// A machine that also moves rapidly.
Toolpath with_rapids(const std::string& text) {
  Machine machine;
  machine.axes.resize(1);
  machine.axes[0].velocity_max = 0.5;
  ToolpathOptions options;
  options.error_max = 20e-6;
  LineSource source("part.ngc", text);
  return read_toolpath(source, machine, options);
}

TEST(PlotProgram, IsSeenFromWhereItsFeedMovesShowMost) {
  struct Case {
    std::string text, across, up;
    bool over_time = false;
  };
  const std::string contour = "G0 Z300\nX10 Y10\nG1 Z-1 F600\nX20 F3000\nY15\nX10\nY10\nG0 Z300\n";
  for (const Case& c :
       {Case{contour, "x", "y"}, Case{"G0 Y400\nZ300\n" + contour, "x", "y"},
        // A relief whose cuts lie in x and z, but under G17.
        Case{"G1 F3000 X50 Z20\nX100 Z0\nY1\nX50 Z30\nX0 Z0\n", "x", "y"},
        // A lathe's, and one that cuts in y and z only.
        Case{"G18 G0 Y300\nG1 F3000 X50 Z20\nX100 Z0\n", "x", "z"}, Case{"G0 X900\nG1 F3000 Y50 Z20\nZ0\n", "y", "z"},
        Case{"G19 G0 X3\nG1 F600 X0\nG1 F3000 Y50 Z20 X1\nZ0\n", "y", "z"},
        Case{"G0 X30 Y20\nG1 Z-9 F300\nG0 Z5\nX60\nG1 Z-9\nG0 Z5\n", "x", "y", true},
        Case{"G0 X30\nG1 Z-9 F300\nG0 Z5\n", "x", "z", true}, Case{"G1 Z-9 F300\nG0 Z5\n", "z", "", true}}) {
    const ProgramView view = whole_view(with_rapids(c.text));
    EXPECT_EQ(view.names[0], c.across) << c.text;
    EXPECT_EQ(view.names[1], c.up) << c.text;
    EXPECT_EQ(view.over_time.has_value(), c.over_time) << c.text;
  }
}

TEST(PlotProgram, IsSeenFromWhereItIsAskedFor) {
  const Toolpath path = with_rapids("G1 F3000 X10\nY20\nZ30\n");
  const double end[] = {0.01, 0.02, 0.03};
  EXPECT_THAT(whole_view(path, view_from("xz")).at(end), testing::ElementsAre(0.01, 0.03));
  EXPECT_THAT(whole_view(path, view_from("yz")).at(end), testing::ElementsAre(0.02, 0.03));
  // Isometric drawings keep lengths along the axes, which are drawn 120 degrees apart.
  const ProgramView iso = whole_view(path, view_from("iso"));
  for (const std::size_t a : {0U, 1U, 2U}) {
    double unit[3] = {}, next[3] = {};
    unit[a] = next[(a + 1) % 3] = 1.0;
    const auto p = iso.at(unit), q = iso.at(next);
    EXPECT_NEAR(std::hypot(p[0], p[1]), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(p[0] * q[0] + p[1] * q[1]), 0.5, 1e-12);
  }
  EXPECT_NEAR(iso.at(end)[0], std::sqrt(0.75) * 0.03, 1e-15) << "x and y to the right, z upwards";
  EXPECT_THROW(view_from("zx"), std::invalid_argument);
  EXPECT_EQ(whole_view(with_rapids("G1 F3000 X10\n"), ViewFrom::yz).names[0], "y") << "an axis that never moves";
}

TEST(PlotProgram, DrillingIsDrawnAsDepthOverTime) {
  Task task;
  task.machine.axes.resize(1);
  task.machine.axes[0].velocity_max = 0.5;
  task.machine.axes[0].acceleration_max = 2.0;
  const Toolpath path = with_rapids("G0 X30\nG1 Z-9 F300\nG0 Z5\nX60\nG1 Z-9\nG0 Z5\n");
  const ProgramResult result = run_profiles({"drill.ngc", path, task});
  ASSERT_TRUE(result.verification.feasible);
  const Figure figure = plot_program(result, path, task.machine);
  const Panel& depth = figure.panels[1];
  EXPECT_EQ(depth.title, "z over time");
  ASSERT_EQ(depth.series.size(), 2U);
  const Series& feed = depth.series[0];
  const auto [deepest, highest] = std::minmax_element(feed.y.begin(), feed.y.end());
  EXPECT_NEAR(*deepest, -9.0, 0.03);
  // 14 and 9 mm at 5 mm/s.
  EXPECT_NEAR(*std::max_element(feed.x.begin(), feed.x.end()) - feed.x.front(), 2.8 + 1.8, 0.6);
  EXPECT_EQ(depth.series[1].label, "rapid moves");
  EXPECT_EQ(plot_program(result, path, task.machine, ViewFrom::xz).panels[1].title.rfind("speed", 0), 0U);
}

TEST(PlotProgram, DrawsOneAxisAndRotaryAxes) {
  EXPECT_THAT(render_svg(plot_program(planned("G1 F6000 X50\nX20\n"))), HasSubstr("x / mm"));
  const std::string svg = render_svg(plot_program(planned("G1 F6000 B50\nX5 B90\n")));
  EXPECT_THAT(svg, HasSubstr("x / mm"));
  EXPECT_THAT(svg, HasSubstr("b / deg"));
}

}  // namespace
}  // namespace accdec
