#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plot/plot_result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A boxcar of 20 samples of 1 ms at a corner passed at 100 mm/s.
DesignResult boxcar(const std::string& axis, const std::string& corner) {
  return evaluate_task(parse_task("sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 19\n[[axis]]\n" + axis +
                                      "[[corner]]\nfeed_in_mm_min = 6000\ndelay_samples = 0\n" + corner,
                                  "task.toml", {.response = Considered::all}));
}

// Back on itself, the velocity falls from 100 to -100 mm/s by 10 mm/s a sample. The axis stops 0.45 or 0.5 mm before
// the corner, by where a sample begins.
TEST(PlotDrawnMotion, PathOfReversalShowsWhereItTurns) {
  const Panel path = plot_result(boxcar("", "direction_in = [1]\ndirection_out = [-1]\n"), "").panels.front();
  ASSERT_TRUE(path.x.min && path.x.max);
  double turns = -1e9;
  for (const Series& series : path.series) {
    if (series.label == "path") turns = *std::max_element(series.x.begin(), series.x.end());
  }
  EXPECT_NEAR(turns, -475.0, 26.0);
  EXPECT_LT(*path.x.min, turns);
  EXPECT_GT(*path.x.max, 0.0);
  EXPECT_THAT(path.x.label, testing::StartsWith("along the motion"));
  EXPECT_EQ(path.stretch, 1.0);
  EXPECT_THAT(path.y.label, testing::Not(testing::HasSubstr("times as long")));  // nothing moves there
}

// 10 kg at 5 m/s^2 and a damping of 100 N s/m: at 100 mm/s the force is 60 N. The curve |F| + 1000 N s/m |V| = 200 N is
// used to (60 + 100)/200.
TEST(PlotDrawnMotion, ForceAtSpeedIsDrawnAsUseOfTheCurve) {
  const DesignResult result = boxcar("mass_kg = 10\ndamping_N_s_m = 100\nforce_speed_N = [[0, 200], [150, 50]]\n",
                                     "direction_in = [1]\ndirection_out = [1]\n");
  const Figure figure = plot_result(result, "");
  const auto found = std::find_if(figure.panels.begin(), figure.panels.end(), [](const Panel& panel) {
    return panel.title.starts_with("use of the force-speed curve / %");
  });
  ASSERT_NE(found, figure.panels.end());
  EXPECT_THAT(found->title, testing::HasSubstr("80.0 % used"));
  ASSERT_EQ(found->limits.size(), 1);
  EXPECT_EQ(found->limits.front().y, 100.0);
  double most = 0.0;
  for (const Series& series : found->series) {
    if (series.label == "x") most = *std::max_element(series.y.begin(), series.y.end());
  }
  EXPECT_NEAR(most, 80.0, 1e-6);
}

}  // namespace
}  // namespace accdec
