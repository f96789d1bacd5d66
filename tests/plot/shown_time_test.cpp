#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plot/plot_result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

// 100 mm/s in 20 ms are 5 m/s^2 on either axis of a square corner.
constexpr const char* square_corner = R"(
sample_period_ms = 1.0
[filter]
kind = "boxcar"
order = 19
[[axis]]
acceleration_max_mm_s2 = 6000
[[corner]]
angle_deg = 90
feed_in_mm_min = 6000
delay_samples = 0
)";

/// @param servo_gain  1/s  @param today  order of the filter of today, which is drawn too; 0: none
Figure drawn(double servo_gain, int today = 0) {
  Task task = parse_task(square_corner, "task.toml");
  for (Axis& axis : task.machine.axes) axis.servo_gain = servo_gain, axis.velocity_feedforward = 0.0;
  if (today > 0) task.baseline = task.filter, task.baseline->order = today;
  return plot_result(evaluate_task(task));
}

const Panel& panel_of(const Figure& figure, const std::string& start) {
  return *std::ranges::find_if(figure.panels, [&](const Panel& panel) { return panel.title.starts_with(start); });
}

// The lag behind a ramp of 20 ms dies like e^(-t/20 ms) from 1.72 of the speed or less: in 150 ms to 0.1 % of it. So
// each of start, blend and stop takes at most 170 ms, and a leg keeps a tenth of that at either end of what is left
// out.
TEST(ShownTime, LegsBehindAServoAreDrawnAsLongAsTheySettle) {
  const Figure figure = drawn(50.0);
  EXPECT_THAT(figure.title, testing::HasSubstr("; steady parts of the legs are left out"));
  for (const char* title : {"velocity", "acceleration"}) {
    const Panel& panel = panel_of(figure, title);
    EXPECT_LT(*panel.x.max - *panel.x.min, 1.06 * (3 * 170 + 4 * 17 + 2)) << title;
    EXPECT_GT(*panel.x.max - *panel.x.min, 3 * 120) << title;
    for (const Series& series : panel.series) EXPECT_TRUE(std::ranges::is_sorted(series.x)) << series.label;
  }
  // All of both ramps of an axis is there, those of the blend at the time of the corner command.
  int samples = 0, in_blend = 0;
  for (const Series& series : panel_of(figure, "acceleration").series) {
    for (std::size_t n = 0; series.x.size() > 1 && n < series.x.size(); ++n) {
      if (std::abs(series.y[n]) < 1.0) continue;
      EXPECT_NEAR(std::abs(series.y[n]), 5000.0, 1e-6);
      ++samples;
      in_blend += series.x[n] > 0.0 && series.x[n] < 20.5 ? 1 : 0;
    }
  }
  EXPECT_EQ(samples, 4 * 20);
  EXPECT_EQ(in_blend, 2 * 20);
  // Curves go on where a part is left out: samples lie no sample apart there.
  for (const Series& series : panel_of(figure, "velocity").series) {
    for (std::size_t n = 1; n < series.x.size(); ++n) {
      const double later = series.x[n] - series.x[n - 1], change = std::abs(series.y[n] - series.y[n - 1]);
      EXPECT_LT(later, 2.0) << series.label << ' ' << series.x[n];
      EXPECT_LE(change, std::abs(later - 1.0) < 1e-6 ? 5.0 + 1e-9 : 0.1) << series.label << ' ' << series.x[n];
    }
  }
}

// Today's ramps of 40 ms are whole, too, and both motions leave out the same time.
TEST(ShownTime, TodayIsDrawnBesideTheDesign) {
  const Figure figure = drawn(50.0, 39);
  EXPECT_THAT(figure.title, testing::HasSubstr("left out"));
  int today = 0, designed = 0;
  for (const Series& series : panel_of(figure, "acceleration").series) {
    EXPECT_TRUE(std::ranges::is_sorted(series.x)) << series.label;
    const auto moving = std::ranges::count_if(series.y, [](double y) { return std::abs(y) > 1.0; });
    if (series.x.size() > 1) (series.label.ends_with("today") ? today : designed) += static_cast<int>(moving);
  }
  EXPECT_EQ(designed, 4 * 20);
  EXPECT_EQ(today, 4 * 40);
}

TEST(ShownTime, LegsOfIdealAxesAreDrawnWhole) {
  const Figure figure = drawn(unlimited);
  EXPECT_THAT(figure.title, testing::Not(testing::HasSubstr("left out")));
}

}  // namespace
}  // namespace accdec
