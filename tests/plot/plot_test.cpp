#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files/process.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// Linear Acc/Dec in closed form: 100 mm/s in 20 ms are 5 m/s^2 on either axis, 50 N with 10 kg, at most 5 W.
constexpr const char* task_text = R"(
title = "It's `a` \"test\" \\ <&>"
sample_period_ms = 1.0
[filter]
kind = "boxcar"
order = 19
[[axis]]
name = "x"
velocity_max_mm_s = 120
acceleration_max_mm_s2 = 6000
mass_kg = 10
force_max_N = 60
power_max_W = 8
regeneration_max_W = 6
[[axis]]
name = "y"
acceleration_max_mm_s2 = 50000
mass_kg = 10
[[corner]]
name = "first one"
angle_deg = 90
feed_in_mm_min = 6000
feed_out_mm_min = 6000
error_max_um = 400
delay_samples = 0
[[corner]]
name = "second"
angle_deg = 90
feed_in_mm_min = 6000
feed_out_mm_min = 6000
delay_samples = 20
[[mode]]
frequency_Hz = [45, 55]
residual_max = 0.2
)";

DesignResult result() {
  return evaluate_task(parse_task(task_text, "task.toml"));
}

const Panel& panel(const Figure& figure, const std::string& title) {
  for (const Panel& p : figure.panels) {
    if (p.title.starts_with(title)) return p;
  }
  throw std::out_of_range(title);
}

double largest(const Series& series) {
  return std::ranges::max(series.y);
}

TEST(PlotResult, DrawsTheClosedFormOfLinearAccDec) {
  const Figure figure = plot_result(result());
  EXPECT_NEAR(largest(panel(figure, "velocity x").series.at(0)), 100.0, 1e-9);
  EXPECT_NEAR(largest(panel(figure, "acceleration x").series.at(0)), 5000.0, 1e-6);
  EXPECT_NEAR(largest(panel(figure, "acceleration y").series.at(0)), 5000.0, 1e-6);
  EXPECT_NEAR(largest(panel(figure, "force x").series.at(0)), 50.0, 1e-9);
  EXPECT_NEAR(largest(panel(figure, "power x").series.at(0)), 5.0, 1e-9);
  // The zeros of a moving average of 20 ms: 50 Hz and its multiples.
  const Series& response = panel(figure, "residual vibration").series.back();
  ASSERT_GT(response.x.size(), 100u);
  EXPECT_NEAR(response.y.front(), 1.0, 1e-12);
  for (std::size_t i = 0; i < response.x.size(); ++i) {
    const double x = M_PI * response.x[i] * 1e-3;
    const double exact = x == 0.0 ? 1.0 : std::abs(std::sin(20.0 * x) / (20.0 * std::sin(x)));
    if (exact < 1e-3) continue;  // the drawing has a floor
    EXPECT_NEAR(response.y[i], exact, 1e-9);
  }
}

TEST(PlotResult, LimitsAreDrawnOrNamed) {
  const Figure figure = plot_result(result());
  EXPECT_EQ(panel(figure, "velocity x").limits.size(), 2u);
  const auto& limits = panel(figure, "acceleration x").limits;
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_DOUBLE_EQ(limits[0].y, 6000.0);
  EXPECT_DOUBLE_EQ(limits[1].y, -6000.0);
  EXPECT_TRUE(panel(figure, "acceleration y").limits.empty());  // ten times what is used
  EXPECT_THAT(panel(figure, "acceleration y").title, HasSubstr("50000 and -50000"));
  const auto& power = panel(figure, "power x").limits;
  ASSERT_EQ(power.size(), 2u);
  EXPECT_DOUBLE_EQ(power[0].y, 8.0);
  EXPECT_DOUBLE_EQ(power[1].y, -6.0);
  const auto& bands = panel(figure, "residual vibration").bands;
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_DOUBLE_EQ(bands[0].from, 45.0);
  EXPECT_DOUBLE_EQ(bands[0].to, 55.0);
}

TEST(PlotResult, TheWorstSampleIsMarkedAndTheBindingLimitNamed) {
  // In closed form 50 N of the allowed 60 N are used, which is 83.3 %. Power is 5 of 8 W, and braking is 5 - v F at the
  // first sample.
  const Figure figure = plot_result(result());
  const Panel& force = panel(figure, "force x");
  EXPECT_THAT(force.title, HasSubstr("83.3 % used"));
  EXPECT_THAT(force.title, testing::Not(HasSubstr("binding")));
  ASSERT_EQ(force.series.size(), 2u);
  EXPECT_NEAR(std::abs(force.series[1].y.at(0)), 50.0, 1e-9);
  DesignResult tight = result();
  tight.task.machine.axes[0].force_max = 50.0;
  tight.task.machine.axes[0].jerk_max = 50000.0;
  EXPECT_THAT(panel(plot_result(tight), "force x").title, HasSubstr("100.0 % used, binding"));
  EXPECT_THAT(panel(plot_result(tight), "jerk x").title, HasSubstr("10.0 % used"));  // 5 m/s^2 in one sample of 1 ms
  EXPECT_THROW(panel(plot_result(tight), "jerk y"), std::out_of_range);              // not limited: not drawn
}

TEST(PlotResult, EverySampleThatBindsIsMarked) {
  DesignResult tight = result();
  tight.task.machine.axes[0].force_max = 50.0;  // reached during all 20 samples of both ramps, see above
  const Figure figure = plot_result(tight);
  const Panel& force = panel(figure, "force x");
  const Series& curve = force.series.at(0);
  const Series& binds = force.series.at(1);
  EXPECT_EQ(binds.label, "binds");
  ASSERT_EQ(binds.y.size(), curve.y.size());
  for (std::size_t n = 0; n < curve.y.size(); ++n) {
    if (std::abs(curve.y[n]) < 0.99 * 50.0) continue;
    EXPECT_DOUBLE_EQ(binds.y[n], std::copysign(50.0, curve.y[n])) << n;
  }
  const auto marked = std::count_if(binds.y.begin(), binds.y.end(), [](double y) { return std::isfinite(y); });
  EXPECT_LT(static_cast<std::size_t>(marked), binds.y.size());
}

TEST(PlotResult, TodayIsDrawnBelowTheDesignAndTheTitleSaysWhatIsSaved) {
  // Moving averages of 40 and 20 samples with the same delays: 20 samples of 1 ms are saved.
  DesignResult r = result();
  EXPECT_THAT(plot_result(r).title, testing::Not(HasSubstr("today")));
  r.task.baseline = r.task.filter;
  r.task.baseline->order = 39;
  r.task.corners[0].error_max.reset();
  const Figure figure = plot_result(r);
  EXPECT_THAT(figure.title, HasSubstr("20 ms less than today"));
  const Panel& speed = panel(figure, "velocity x");
  EXPECT_EQ(speed.series.at(0).label, "today");
  EXPECT_NEAR(largest(speed.series.at(0)), 100.0, 1e-9);
  EXPECT_NEAR(largest(panel(figure, "acceleration x").series.at(0)), 2500.0, 1e-6);  // 100 mm/s in 40 ms
  EXPECT_EQ(panel(figure, "path around corner first one").series.at(0).label, "today");
}

TEST(PlotResult, DistanceIsThatFromTheNearerLeg) {
  // The legs are square: the distances are v T p(k) and v T q(k), and 2.25 is the largest of min(p, q) at a sample.
  const Figure figure = plot_result(result());
  const Panel& distance = panel(figure, "distance from the programmed path");
  EXPECT_NEAR(largest(distance.series.at(0)), 225.0, 1e-9);
}

TEST(PlotResult, PathPassesTheCornerAtTheErrorItStates) {
  const DesignResult r = result();
  const Figure figure = plot_result(r);
  const Panel& path = panel(figure, "path around corner first one");
  ASSERT_EQ(path.x.label, "x / µm");
  const Series& samples = path.series.at(0);
  double nearest = INFINITY;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    nearest = std::min(nearest, std::hypot(samples.x[i], samples.y[i]));
  }
  EXPECT_NEAR(nearest, 1e6 * r.corners[0].corner_error, 1e-6);
  // Eq. (6) with tau = 20 ms, and the discrete sum's difference from it, below one part in tau/T.
  const double continuous = 1e6 * 0.1 * 0.02 / 4 * std::cos(M_PI / 4);
  EXPECT_NEAR(nearest, continuous, continuous / 20);
  EXPECT_NEAR(path.circles.at(0).radius, nearest, 1e-6);
}

TEST(PlotResult, LongCurvesKeepTheirEndsAndExtremes) {
  const Task task = parse_task(
      "sample_period_ms = 0.01\n[filter]\nkind = \"trapezoid\"\norder = 60000\nramp = 20000\n[[axis]]\n"
      "acceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 1000\n",
      "task.toml");
  const Figure figure = plot_result(evaluate_task(task), "");
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) EXPECT_LE(series.x.size(), 16'000U) << panel.title;
  }
  const Series& taps = figure.panels.back().series.back();
  EXPECT_EQ(taps.x.front(), 0.0);
  EXPECT_EQ(taps.x.back(), 60000.0);
  // The flat top of a trapezoid: 60 001 taps less a ramp of 20 000 at either end, of area 1.
  EXPECT_NEAR(*std::max_element(taps.y.begin(), taps.y.end()), 1.0 / 40001.0, 1e-9);
}

TEST(PlotResult, ChoosesTheCornerByName) {
  EXPECT_THAT(plot_result(result(), "second").title, HasSubstr("corner second, delay 20 samples"));
  EXPECT_THROW(plot_result(result(), "secnod"), std::invalid_argument);
  DesignResult without = result();
  without.filter.reset();
  EXPECT_THROW(plot_result(without), std::runtime_error);
}

class PlotCommand : public testing::Test {
 protected:
  ProcessOutput plot(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{accdec::test_support::program(), "plot", folder_.path("r.json"), "--out",
                                       folder_.path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(arguments, "", "accdec");
  }
  void SetUp() override { folder_.write("r.json", result_to_json(result())); }
  TemporaryFolder folder_;
};

TEST_F(PlotCommand, WritesEveryFormat) {
  const std::pair<const char*, const char*> formats[] = {
      {"p.svg", "<?xml"}, {"p.png", "\x89PNG"}, {"p.pdf", "%PDF-"}, {"p.html", "<!DOCTYPE html>"}};
  for (const auto& [name, start] : formats) {
    const ProcessOutput done = plot(name);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(folder_.read(name), StartsWith(start)) << name;
  }
}

TEST_F(PlotCommand, RefusesWithNothingWritten) {
  const ProcessOutput extension = plot("p.jpg");
  EXPECT_EQ(extension.exit_code, 2);
  EXPECT_THAT(extension.errors, HasSubstr(".svg, .png, .pdf or .html"));
  const ProcessOutput corner = plot("p.svg", {"--corner", "secnod"});
  EXPECT_EQ(corner.exit_code, 2);
  EXPECT_THAT(corner.errors, HasSubstr("it has: first one, second"));
  EXPECT_EQ(plot("nowhere/p.svg").exit_code, 2);
  folder_.write("r.json", "{}");
  EXPECT_EQ(plot("p.svg").exit_code, 2);
  EXPECT_EQ(folder_.count(), 1u);
}

}  // namespace
}  // namespace accdec
