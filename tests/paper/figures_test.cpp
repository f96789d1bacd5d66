#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <accdec/motion/linear.hpp>
#include <accdec/paper/paper_case.hpp>
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

TEST(PaperFigures, ColumnsOfAFigureAreEquallyLong) {
  for (const FigureData& data : {figure5(), figure6(), figure7(), figure8(), figure9(), figure10(), figure11(),
                                 figure12_paths(), figure12_errors()}) {
    for (const Column& column : data.columns)
      EXPECT_EQ(column.values.size(), data.columns.front().values.size()) << column.name;
    EXPECT_GT(data.columns.front().values.size(), 40u);
  }
  EXPECT_THROW(figure5()["nothing"], std::out_of_range);
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
