#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

using testing::HasSubstr;

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

/// The curve of an axis in the panel of a quantity.
const Series& curve(const Figure& figure, const std::string& quantity, const std::string& label) {
  const Panel& p = panel(figure, quantity);
  const auto found = std::ranges::find(p.series, label, &Series::label);
  if (found == p.series.end()) throw std::out_of_range(label);
  return *found;
}

double largest(const Series& series) {
  return std::ranges::max(series.y);
}

TEST(PlotResult, DrawsTheClosedFormOfLinearAccDec) {
  const Figure figure = plot_result(result());
  EXPECT_NEAR(largest(curve(figure, "velocity", "x")), 100.0, 1e-9);
  EXPECT_NEAR(largest(curve(figure, "acceleration", "x")), 5000.0, 1e-6);
  EXPECT_NEAR(largest(curve(figure, "acceleration", "y")), 5000.0, 1e-6);
  EXPECT_NEAR(largest(curve(figure, "force", "x")), 50.0, 1e-9);
  EXPECT_NEAR(largest(curve(figure, "power", "x")), 5.0, 1e-9);
  // Axes of one colour differ by their dashes.
  EXPECT_EQ(curve(figure, "acceleration", "x").style, curve(figure, "acceleration", "y").style);
  EXPECT_NE(curve(figure, "acceleration", "x").dash, curve(figure, "acceleration", "y").dash);
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
  EXPECT_EQ(panel(figure, "velocity").limits.size(), 2u);
  const auto& limits = panel(figure, "acceleration").limits;
  ASSERT_EQ(limits.size(), 2u) << "those of y are ten times what is used";
  EXPECT_DOUBLE_EQ(limits[0].y, 6000.0);
  EXPECT_DOUBLE_EQ(limits[1].y, -6000.0);
  EXPECT_EQ(limits[0].name + limits[1].name, "x") << "of x only, at the upper line";
  EXPECT_EQ(panel(figure, "acceleration").title,
            "acceleration / mm/s²: x 83.3 %, y 10.0 % used; limit ±50000 of y, off scale");
  const auto& power = panel(figure, "power").limits;
  ASSERT_EQ(power.size(), 2u);
  EXPECT_DOUBLE_EQ(power[0].y, 8.0);
  EXPECT_DOUBLE_EQ(power[1].y, -6.0);
  const auto& bands = panel(figure, "residual vibration").bands;
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_DOUBLE_EQ(bands[0].from, 45.0);
  EXPECT_DOUBLE_EQ(bands[0].to, 55.0);
}

TEST(PlotResult, TheAxisThatBindsIsNamed) {
  DesignResult two = result();  // both axes change their acceleration by 5 m/s^2 within a sample
  two.task.machine.axes[0].jerk_max = 5000.0, two.task.machine.axes[1].jerk_max = 6000.0;
  const Panel jerk = panel(plot_result(two), "jerk");
  EXPECT_THAT(jerk.title, HasSubstr(": x binds; x 100.0 %, y 83.3 % used"));
  EXPECT_FALSE(jerk.notes.empty());
  std::vector<std::string> names;
  for (const LimitLine& limit : jerk.limits) names.push_back(limit.name);
  EXPECT_EQ(names, (std::vector<std::string>{"x", "", "y", ""}));
  for (const Note& note : jerk.notes) EXPECT_EQ(note.text, "x");
}

TEST(PlotResult, TheWorstSampleIsMarkedAndTheBindingLimitNamed) {
  // In closed form 50 N of the allowed 60 N are used, which is 83.3 %. Power is 5 of 8 W, and braking is 5 - v F at the
  // first sample.
  const Figure figure = plot_result(result());
  const Panel& force = panel(figure, "force");
  EXPECT_THAT(force.title, HasSubstr("x 83.3 % used"));
  EXPECT_THAT(force.title, testing::Not(HasSubstr("binding")));
  ASSERT_EQ(force.series.size(), 2u);
  EXPECT_NEAR(std::abs(force.series[1].y.at(0)), 50.0, 1e-9);
  DesignResult tight = result();
  tight.task.machine.axes[0].force_max = 50.0;
  tight.task.machine.axes[0].jerk_max = 50000.0;
  EXPECT_THAT(panel(plot_result(tight), "force").title, HasSubstr("x 100.0 % used, binding"));
  EXPECT_THAT(panel(plot_result(tight), "jerk").title, HasSubstr("x 10.0 % used"));  // 5 m/s^2 in one sample of 1 ms
  EXPECT_THROW(curve(plot_result(tight), "jerk", "y"), std::out_of_range);           // not limited: not drawn
}

TEST(PlotResult, EverySampleThatBindsIsMarked) {
  DesignResult tight = result();
  tight.task.machine.axes[0].force_max = 50.0;  // reached during all 20 samples of both ramps, see above
  const Figure figure = plot_result(tight);
  const Panel& force = panel(figure, "force");
  const Series& curve = force.series.at(0);
  // The upper limit and the lower one are apart: nothing joins them.
  const Series &upper = force.series.at(1), &lower = force.series.at(2);
  EXPECT_EQ(upper.label, "binds");
  ASSERT_EQ(upper.y.size(), curve.y.size());
  ASSERT_EQ(lower.y.size(), curve.y.size());
  for (std::size_t n = 0; n < curve.y.size(); ++n) {
    if (std::abs(curve.y[n]) >= 0.99 * 50.0) {
      EXPECT_DOUBLE_EQ((curve.y[n] > 0.0 ? upper : lower).y[n], std::copysign(50.0, curve.y[n])) << n;
    }
    EXPECT_FALSE(upper.y[n] < 0.0 || lower.y[n] > 0.0) << n;
  }
  for (const Series* bars : {&upper, &lower}) {
    const auto marked = std::count_if(bars->y.begin(), bars->y.end(), [](double y) { return std::isfinite(y); });
    EXPECT_EQ(marked, 21) << "20 samples of a ramp, from the end of the one before";
  }
}

TEST(PlotResult, AnExactStopIsDrawnInAWindowThatCanBeSeen) {
  DesignResult r = result();
  r.task.corners[0].error_max.reset();
  r.task.corners[0].delay = r.corners[0].delay = 20;  // the order is 19
  r.corners[0].corner_error = 0.0;
  const Figure figure = plot_result(r);
  const Panel& path = panel(figure, "path around corner first one");
  EXPECT_GT(*path.x.max - *path.x.min, 10.0) << path.x.label;
  EXPECT_THROW(panel(figure, "distance"), std::out_of_range);
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
  EXPECT_NEAR(largest(curve(figure, "velocity", "x today")), 100.0, 1e-9);
  EXPECT_NEAR(largest(curve(figure, "acceleration", "x today")), 2500.0, 1e-6);  // 100 mm/s in 40 ms
  EXPECT_EQ(panel(figure, "path around corner first one").series.at(0).label, "today");
  // Every panel has both, grey below, with words for both.
  for (const Panel& p : figure.panels) {
    const auto of_today = std::ranges::find_if(p.series, [](const Series& s) { return s.label.ends_with("today"); });
    const auto designed = [](const Series& s) { return s.style == figure_style::design_style; };
    ASSERT_NE(of_today, p.series.end()) << p.title;
    EXPECT_LT(of_today, std::ranges::find_if(p.series, designed)) << p.title;
  }
  const Panel& taps = panel(figure, "weights of the filter taps");
  EXPECT_EQ(taps.title, "weights of the filter taps, order 19; today 39");
  EXPECT_EQ(taps.series.at(0).x.back(), 39.0);
  EXPECT_NEAR(taps.series.at(0).y.at(5), 1.0 / 40, 1e-12);
  EXPECT_GT(*taps.x.max, 39.0);
  // The first zero of 40 ms lies at 25 Hz.
  const auto& vibration = panel(figure, "residual vibration").series;
  const Series& before = *std::ranges::find(vibration, "today", &Series::label);
  for (std::size_t i = 0; i < before.x.size(); ++i) {
    const double x = M_PI * before.x[i] * 1e-3;
    const double exact = x == 0.0 ? 1.0 : std::abs(std::sin(40.0 * x) / (40.0 * std::sin(x)));
    if (exact < 1e-3) continue;
    EXPECT_NEAR(before.y[i], exact, 1e-9);
  }
}

TEST(PlotResult, TheTitleSaysWhyTodayIsNotDrawn) {
  DesignResult r = result();
  r.task.baseline = r.task.filter;
  r.task.baseline->order = 9;  // 100 mm/s in 10 ms are 10 m/s^2 of the allowed 6
  const Figure figure = plot_result(r);
  EXPECT_THAT(figure.title, HasSubstr("today's filter breaks a limit"));
  for (const Panel& p : figure.panels) {
    for (const Series& s : p.series) EXPECT_EQ(s.label.find("today"), s.label.npos) << p.title;
  }
}

TEST(PlotResult, NoPanelShowsMoreThanHappensAndNoneHides) {
  const Figure figure = plot_result(result());
  // The motion ends 20 ms after its command; before it and behind it nothing happens.
  for (const char* title : {"velocity", "acceleration", "force"}) {
    const Panel& p = panel(figure, title);
    double first = INFINITY, last = -INFINITY;
    for (const char* axis : {"x", "y"}) {
      const Series& speed = curve(figure, "velocity", axis);
      for (std::size_t n = 0; n < speed.x.size(); ++n) {
        if (std::abs(speed.y[n]) < 1e-9) continue;
        first = std::min(first, speed.x[n]), last = std::max(last, speed.x[n]);
      }
    }
    EXPECT_LE(*p.x.min, first) << title;
    EXPECT_GE(*p.x.max, last) << title;
    EXPECT_LE(first - *p.x.min + *p.x.max - last, 0.15 * (last - first)) << title;
  }
  // The distance begins and ends in the panel at zero, and what is less than a picometre is zero.
  const Panel& distance = panel(figure, "distance from the programmed path");
  const Series& off = distance.series.at(0);
  for (std::size_t n = 0; n < off.x.size(); ++n) {
    if (off.y[n] == 0.0) continue;
    EXPECT_GE(off.y[n], 1e-6) << off.x[n];
    EXPECT_GT(off.x[n], *distance.x.min);
    EXPECT_LT(off.x[n], *distance.x.max);
  }
  // The path fills its panel: at least half of the width and of the height is the blend.
  const Panel& path = panel(figure, "path around corner first one");
  const Series& programmed = *std::ranges::find(path.series, "programmed", &Series::label);
  ASSERT_EQ(programmed.x.size(), 3U);
  EXPECT_LT(*path.x.max - *path.x.min, 8.0 * 400.0);
  ASSERT_EQ(path.circles.size(), 1U);
  EXPECT_EQ(path.circles[0].label, "tolerance 400 µm");
  EXPECT_NEAR(path.circles[0].radius, 400.0, 1e-9);
  EXPECT_LT(std::min({-*path.x.min, *path.x.max, -*path.y.min, *path.y.max}), 400.0) << "no empty half of its circle";
}

TEST(PlotResult, ContourOfTheTaskIsALimitOfTheDistance) {
  DesignResult r = result();
  r.task.corners[0].contour_max = 250e-6 * (1.0 + 1e-10);  // closed form below
  const Figure figure = plot_result(evaluate_task(r.task));
  const Panel& distance = panel(figure, "distance from the programmed path");
  EXPECT_THAT(distance.title, HasSubstr("100.0 % used, binding"));
  ASSERT_EQ(distance.limits.size(), 1U);
  EXPECT_NEAR(distance.limits[0].y, 250.0, 1e-6);
  const Series& mark = distance.series.back();
  EXPECT_EQ(mark.label, "binds");
  EXPECT_NEAR(mark.y.at(0), 250.0, 1e-6);
}

TEST(PlotResult, LimitsOfTheCornerAndOfTheFilterAreMarkedWhereTheyBind) {
  DesignResult r = result();
  // The error by the discrete sum, as its tolerance; the residual at the edges of the band: 19.4 % at 55 Hz or less.
  r.task.corners[0].error_max = r.corners[0].corner_error;
  const auto marked = [&](const char* start) {
    const Figure figure = plot_result(evaluate_task(r.task));
    return panel(figure, start);
  };
  EXPECT_THAT(marked("path around").title, HasSubstr("100.0 % used, binding"));
  EXPECT_EQ(std::ranges::count(marked("path around").series, "binds", &Series::label), 1);
  const double edge = std::abs(std::sin(M_PI * 45 * 0.02) / (20.0 * std::sin(M_PI * 45e-3)));
  r.task.machine.modes[0].residual_max = edge * (1.0 + 1e-9);
  const Panel vibration = marked("residual vibration");
  EXPECT_THAT(vibration.title, HasSubstr("binding"));
  const Series& point = *std::ranges::find(vibration.series, "binds", &Series::label);
  EXPECT_NEAR(point.x.at(0), 45.0, 1e-6);
  EXPECT_NEAR(point.y.at(0), edge, 1e-6);
  r.task.machine.modes.push_back(r.task.machine.modes[0]);
  const Panel two = marked("residual vibration");
  EXPECT_EQ(std::ranges::count(two.series, "binds", &Series::label), 1) << "a legend names every mark once";
  r.task.machine.modes.pop_back();
  // Both axes brake and drive at once: 100 mm/s against and with 50 N each.
  r.task.machine.power_total_max = 10.0;
  EXPECT_THAT(marked("power of all axes").title, HasSubstr("% used"));
  // Crossing at right angles, the speed is least half-way: 1/sqrt(2) of 100 mm/s.
  r.task.corners[0].speed_min = 0.05;
  EXPECT_THAT(marked("velocity").limits.back().y, testing::DoubleNear(50.0, 1e-12));
  EXPECT_THAT(marked("velocity").title, HasSubstr("smallest speed:"));
}

TEST(PlotResult, DistanceIsThatFromTheNearerLeg) {
  // The legs are square: the distances are v T p(k) and v T q(k). The filter has 20 equal taps: p(9) = q(10) = 55/20
  // and q(9) = p(10) = 45/20. So the chord between these samples is farthest in its middle, by 50/20.
  const Figure figure = plot_result(result());
  const Panel& distance = panel(figure, "distance from the programmed path");
  const Series& drawn = distance.series.at(0);
  EXPECT_NEAR(largest(drawn), 250.0, 1e-9);
  const auto at = static_cast<std::size_t>(std::ranges::max_element(drawn.y) - drawn.y.begin());
  EXPECT_NEAR(drawn.x[at] - drawn.x[at - 1], 0.5, 1e-9);
  for (const std::size_t beside : {at - 1, at + 1}) EXPECT_NEAR(drawn.y[beside], 225.0, 1e-9);
  EXPECT_THAT(distance.title, testing::EndsWith(": largest 250"));
  EXPECT_NEAR(1e6 * result().corners[0].contour_deviation, 250.0, 1e-9) << "what the table says";
}

TEST(PlotResult, AStopHasNoDistanceToDrawAndItsSpeedFalls) {
  // 20 taps: the first leg slows down in 20 ms, and the second one begins 20 ms after the end of the first.
  const Figure figure = plot_result(result(), "second");
  EXPECT_THROW(panel(figure, "distance from the programmed path"), std::out_of_range);
  const Series& speed = curve(figure, "velocity", "speed");
  std::size_t compared = 0;
  for (std::size_t n = 0; n < speed.x.size(); ++n) {
    if (speed.x[n] < 0.0 || speed.x[n] > 40.0) continue;
    EXPECT_NEAR(speed.y[n], 5.0 * std::abs(20.0 - speed.x[n]), 1e-9) << speed.x[n];
    ++compared;
  }
  EXPECT_EQ(compared, 41U);
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
  const auto error = std::find_if(path.series.begin(), path.series.end(),
                                  [](const Series& s) { return s.label.starts_with("error "); });
  ASSERT_NE(error, path.series.end());
  EXPECT_EQ(std::hypot(error->x.at(0), error->y.at(0)), 0.0) << "a line from the corner to the path";
  EXPECT_NEAR(std::hypot(error->x.at(1), error->y.at(1)), nearest, 1e-6);
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
  const Series& taps = panel(figure, "weights of the filter taps").series.back();
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

}  // namespace
}  // namespace accdec
