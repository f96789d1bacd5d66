#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_circle.hpp>
#include <accdec/paper/paper_figures.hpp>

namespace accdec::paper {

std::vector<CircleRow> circle_rows() {
  std::vector<CircleRow> rows;
  const auto add = [&](const std::string& name, const Filter& filter) {
    rows.push_back({name, filter.order(), circle_error(filter, circle_radius, circle_feed, sample_period)});
  };
  add("linear", linear());
  add(shape_title(Shape::s_curve), quintic());
  add("Blackman FIR of the paper", fir());
  const EqualLimits equal = equal_limits();
  add(fmt::format("trapezoid within the FIR's own limits ({} taps a ramp)", equal.trapezoid_ramp),
      trapezoid(equal.trapezoid_order, equal.trapezoid_ramp));
  add("boxcar with the FIR's own peak acceleration, jerk not limited", boxcar(equal.boxcar_order));
  return rows;
}

std::string circle_text() {
  const std::vector<CircleRow> rows = circle_rows();
  std::string text = fmt::format(
      "*\"The circular contour error caused by the FIR Acc/Dec scheme is also smaller.\"* The paper prints no circle. "
      "Here a circle of R = {:g} mm is passed at v = {:g} mm/s. A filter averages points of the circle, so the radius "
      "of the path is too small by R (1 - |H|) with H = sum b_i exp(-j i v T/R). This is about v² σ²/(2R), where σ is "
      "the standard deviation of the taps:\n\n"
      "| processor | order | σ / ms | v² σ²/(2R) / µm | R (1 - \\|H\\|) / µm | simulated / µm |\n"
      "|---|--:|--:|--:|--:|--:|\n",
      circle_radius * 1e3, circle_feed * 1e3);
  for (const CircleRow& row : rows) {
    text +=
        fmt::format("| {} | {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} |\n", row.name, row.order, row.error.deviation * 1e3,
                    row.error.small_angle * 1e6, row.error.radius_error * 1e6, row.error.simulated * 1e6);
  }
  text +=
      "\nThe simulation convolves a whole turn from rest to rest and takes the largest distance from the commanded "
      "circle. The claim holds at equal Acc/Dec time: σ is smallest for the taps that crowd around their middle. At "
      "equal peak acceleration and jerk it does not hold: the shorter trapezoid has the smaller σ.\n\n";
  return text;
}

}  // namespace accdec::paper
