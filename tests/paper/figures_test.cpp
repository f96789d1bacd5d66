#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_circle.hpp>
#include <accdec/paper/paper_figures.hpp>

namespace accdec::paper {
namespace {

TEST(PaperFigures, Figure12ErrorsInMicrometres) {
  EXPECT_NEAR(figure12_error(Processor::fir, 0) * 1e6, 415.6, 0.05);
  EXPECT_NEAR(figure12_error(Processor::s_curve, 4) * 1e6, 412.5, 0.05);
  EXPECT_NEAR(figure12_error(Processor::linear, 14) * 1e6, 410.5, 0.05);
  EXPECT_NEAR(figure12_error(Processor::linear, 12) * 1e6, 472.1, 0.05);
}

TEST(PaperFigures, Figure12DelaysThatReachTheFirsAccuracy) {
  EXPECT_EQ(figure12_delay(Processor::s_curve), 4);
  EXPECT_EQ(figure12_delay(Processor::linear), 14);
  EXPECT_EQ(figure12_delay(Processor::fir), 0);
}

TEST(PaperFigures, Figure12NeedsFourteenSamplesAtEveryAngle) {
  for (const double degrees : {30.0, 45.0, 60.0, 75.0, 90.0, 95.0, 105.0, 120.0, 135.0, 150.0}) {
    const double theta = degrees / 180.0 * std::numbers::pi;
    EXPECT_EQ(figure12_delay(Processor::linear, theta), 14) << degrees;
    EXPECT_EQ(figure12_delay(Processor::s_curve, theta), 4) << degrees;
  }
}

TEST(PaperFigures, ColumnsOfAFigureAreEquallyLong) {
  for (const FigureData& data : {figure1(), figure2(), figure3(), figure4(), figure5(), figure6(), figure7(), figure8(),
                                 figure9(), figure10(), figure11(), figure12_paths(), figure12_errors()}) {
    for (const Column& column : data.columns)
      EXPECT_EQ(column.values.size(), data.columns.front().values.size()) << column.name;
    EXPECT_GT(data.columns.front().values.size(), 40u);
  }
  EXPECT_THROW(figure5()["nothing"], std::out_of_range);
}

TEST(PaperFigures, TheLegOfFigure2IsAsLongAfterAccDecAsBefore) {
  const FigureData data = figure2();
  EXPECT_NEAR(data["way_before_mm"].back(), 40.0, 1e-9);  // 100 samples of 1 ms at 400 mm/s
  EXPECT_NEAR(data["way_after_mm"].back(), 40.0, 1e-9);
  const std::vector<double>& after = data["after_mm_s"];
  EXPECT_EQ(std::count_if(after.begin(), after.end(), [](double v) { return v > 0.0; }), 100 + 41 - 1);
}

TEST(PaperFigures, Figure4ShowsTheSameErrorInBothFrames) {
  const FigureData data = figure4();
  const LinearCorner exact(angle, figure_feed, figure_feed, 41e-3, 0.0);
  double nearest_xy = INFINITY, nearest_b = INFINITY;
  for (std::size_t i = 0; i < data["k"].size(); ++i) {
    nearest_xy = std::min(nearest_xy, std::hypot(data["x_mm"][i], data["y_mm"][i]));
    EXPECT_NEAR(std::hypot(data["a_mm"][i], data["b_mm"][i]), std::hypot(data["x_mm"][i], data["y_mm"][i]), 1e-9);
    nearest_b = std::min(nearest_b, data["b_mm"][i]);
  }
  EXPECT_NEAR(nearest_xy, nearest_b, 1e-9);  // equal feeds: the path is nearest on the halving line
  // Eq. (9) in continuous time; sampling moves it by the order of 1/41^2.
  EXPECT_NEAR(nearest_xy, exact.corner_error() * 1e3, exact.corner_error() * 1e3 / 41.0 / 41.0 * 2.0);
}

TEST(PaperFigures, OnACircleTheErrorIsHalfTheVarianceOfTheTaps) {
  // Variance of n equal taps: (n^2 - 1)/12.
  const std::vector<CircleRow> rows = circle_rows();
  const double variance = (41.0 * 41.0 - 1.0) / 12.0 * sample_period * sample_period;
  const double closed = circle_feed * circle_feed * variance / (2.0 * circle_radius);
  EXPECT_NEAR(rows[0].error.small_angle, closed, 1e-12);
  for (const CircleRow& row : rows) {
    EXPECT_NEAR(row.error.simulated, row.error.radius_error, 1e-10) << row.name;
    EXPECT_NEAR(row.error.radius_error, row.error.small_angle, 0.01 * row.error.small_angle) << row.name;
  }
  EXPECT_LT(rows[2].error.radius_error, rows[1].error.radius_error);  // the paper's claim, equal Acc/Dec time
  EXPECT_LT(rows[1].error.radius_error, rows[0].error.radius_error);
  EXPECT_LT(rows[3].error.radius_error, rows[2].error.radius_error);  // and its limit: equal acceleration and jerk
}

TEST(PaperFigures, EqualFeedsKeepTheSpeedAlongAConstant) {  // Eq. (5.a), (22.a)
  const double expected = figure_feed * std::sin(0.5 * angle) * 1e3;
  const FigureData linear_components = figure7(), fir_components = figure10();
  for (const double v : linear_components["va_mm_s"]) EXPECT_NEAR(v, expected, 1e-9);
  for (const double v : fir_components["va_d0_mm_s"]) EXPECT_NEAR(v, expected, 1e-9);
}

TEST(PaperFigures, DelayedLinearComponentsFollowTheClosedForm) {  // Eq. (10)
  const FigureData data = figure8();
  const LinearCorner exact(angle, figure_feed, figure_feed, 41e-3, figure_delay * 1e-3);
  for (std::size_t i = 0; i < data["t_ms"].size(); ++i) {
    const Eigen::Vector2d v = exact.velocity(data["t_ms"][i] * 1e-3) * 1e3;
    EXPECT_NEAR(data["va_mm_s"][i], v[0], 1e-9);
    EXPECT_NEAR(data["vb_mm_s"][i], v[1], 1e-9);
  }
}

TEST(PaperFigures, AtEqualLimitsAShorterTrapezoidIsMoreAccurate) {
  const EqualLimits e = equal_limits();
  // Sum of the envelope, by hand: one order less does not reach 1.
  double shorter = 0.0;
  for (int i = 0; i < e.least_order; ++i) {
    shorter += std::min({e.tap_max, (i + 1) * e.step_max, (e.least_order - i) * e.step_max});
  }
  EXPECT_LT(shorter, 1.0);
  EXPECT_GE(e.least_sum, 1.0);
  EXPECT_LT(e.trapezoid_order, order);
  EXPECT_LT(e.trapezoid_mad, e.fir_mad);
  EXPECT_LT(e.envelope_mad, e.fir_mad);
  EXPECT_LT(e.boxcar_mad, e.envelope_mad);
  // The FIR's deviation by its error at equal feeds, Eq. (24).
  EXPECT_NEAR(e.fir_mad, 4.466, 5e-4);
}

}  // namespace
}  // namespace accdec::paper
