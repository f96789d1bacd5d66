#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include <accdec/plot/plot_result.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

// Axes that turn have panels and units of their own, and every axis has its dashes in all panels.

namespace accdec {
namespace {

/// Linear Acc/Dec over 20 ms round a corner at 6000 mm/min.
std::string task_of(const std::string& axes, const std::string& in, const std::string& out) {
  return "sample_period_ms = 1\nfilter = { kind = \"boxcar\", order = 19 }\n" + axes +
         "[[corner]]\nname = \"A\"\nfeed_in_mm_min = 6000\nfeed_out_mm_min = 6000\ndelay_samples = 20\n"
         "direction_in = " +
         in + "\ndirection_out = " + out + "\n";
}

// Behind the corner b turns at 60 deg/s and z moves at 80 mm/s.
const std::string three_axes = task_of(R"(
[[axis]]
name = "x"
[[axis]]
name = "b"
velocity_max_deg_s = 90
inertia_kg_m2 = 0.1
torque_max_N_m = 9
[[axis]]
name = "z"
mass_kg = 10
force_max_N = 60
)",
                                       "[1, 0, 0]", "[0, 0.6, 0.8]");

const std::string two_axes = task_of("[[axis]]\nname = \"x\"\n[[axis]]\nname = \"b\"\n", "[1, 0]", "[0, 1]");

Figure figure_of(const std::string& text) {
  return plot_result(evaluate_task(parse_task(text, "task.toml")));
}

const Panel& panel_titled(const Figure& figure, const std::string& title) {
  for (const Panel& p : figure.panels) {
    if (p.title.starts_with(title)) return p;
  }
  throw std::out_of_range(title);
}

const Series& curve_of_axis(const Figure& figure, const std::string& title, const std::string& axis) {
  const Panel& p = panel_titled(figure, title);
  const auto found = std::ranges::find(p.series, axis, &Series::label);
  if (found == p.series.end()) throw std::out_of_range(axis);
  return *found;
}

TEST(PlotRotary, AxesThatTurnAreInDegrees) {
  const Figure figure = figure_of(three_axes);
  EXPECT_NEAR(std::ranges::max(curve_of_axis(figure, "velocity / mm/s", "z").y), 80.0, 1e-9);
  EXPECT_NEAR(std::ranges::max(curve_of_axis(figure, "velocity / deg/s", "b").y), 60.0, 1e-9);
  EXPECT_NEAR(std::ranges::max(curve_of_axis(figure, "acceleration / deg/s²", "b").y), 3000.0, 1e-6);
  EXPECT_NEAR(std::ranges::max(curve_of_axis(figure, "torque / N m", "b").y), 0.1 * 3000.0 * std::numbers::pi / 180.0,
              1e-9);
  EXPECT_NEAR(std::ranges::max(curve_of_axis(figure, "force / N", "z").y), 40.0, 1e-9);
  for (const Series& series : panel_titled(figure, "velocity / mm/s").series) EXPECT_NE(series.label, "b");
}

TEST(PlotRotary, AnAxisHasItsDashesInEveryPanel) {
  const Figure figure = figure_of(three_axes);
  const int x = curve_of_axis(figure, "velocity / mm/s", "x").dash,
            b = curve_of_axis(figure, "velocity / deg/s", "b").dash,
            z = curve_of_axis(figure, "velocity / mm/s", "z").dash;
  EXPECT_NE(x, b);
  EXPECT_NE(x, z);
  EXPECT_NE(b, z);
  EXPECT_EQ(curve_of_axis(figure, "force / N", "z").dash, z);
  EXPECT_EQ(curve_of_axis(figure, "torque / N m", "b").dash, b);
  EXPECT_EQ(curve_of_axis(figure, "acceleration / deg/s²", "b").dash, b);
}

TEST(PlotRotary, ThePathHasTheUnitOfEachDirection) {
  const Panel flat = panel_titled(figure_of(two_axes), "path");
  EXPECT_TRUE(flat.x.label.starts_with("x / µm")) << flat.x.label;
  EXPECT_TRUE(flat.y.label.starts_with("b / mdeg")) << flat.y.label;
  const Panel bent = panel_titled(figure_of(three_axes), "path");
  EXPECT_TRUE(bent.x.label.starts_with("along the motion / µm, mdeg")) << bent.x.label;
}

}  // namespace
}  // namespace accdec
