#include <array>
#include <numbers>

#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_figures.hpp>
#include <accdec/task/simulation.hpp>

/// Fig. 1 to 4 explain the scheme and print no numbers. They are drawn here from the model, at the conditions of Fig. 5
/// to 8.
namespace accdec::paper {
namespace {

constexpr double millimetre = 1e-3;
constexpr int leg_samples = 100;  ///< commanded samples of the leg of Fig. 1 and 2: 40 mm at 0.4 m/s

/// Angle of 60 degrees to the x-axis on the way in, as the paper draws it: both axes move on both legs.
const double heading = std::numbers::pi / 3.0;

double commanded(int n) {
  return n >= 1 && n <= leg_samples ? figure_feed : 0.0;
}

double filtered(const Filter& filter, int n) {
  double speed = 0.0;
  for (int i = 0; i <= filter.order(); ++i) speed += filter.tap(i) * commanded(n - i);
  return speed;
}

Corner drawn_corner() {
  return planar_corner(angle, heading, Turn::right, figure_feed, figure_feed);
}

}  // namespace

FigureData figure1() {
  FigureData data{1, {{"t_ms", {}}, {"interpolator_mm_s", {}}, {"linear_mm_s", {}}, {"fir_mm_s", {}}}};
  for (int n = -10; n <= leg_samples + ramp_samples + 10; ++n) {
    const std::array<double, 4> row{n * sample_period * 1e3, commanded(n) / millimetre,
                                    filtered(linear(), n) / millimetre, filtered(fir(), n) / millimetre};
    for (std::size_t i = 0; i < row.size(); ++i) data.columns[i].values.push_back(row[i]);
  }
  return data;
}

FigureData figure2() {
  FigureData data{2,
                  {{"t_ms", {}}, {"before_mm_s", {}}, {"after_mm_s", {}}, {"way_before_mm", {}}, {"way_after_mm", {}}}};
  double before = 0.0, after = 0.0;  // m, right-rectangle sums as in Eq. (29)
  for (int n = -10; n <= leg_samples + ramp_samples + 10; ++n) {
    const double slow = filtered(linear(), n);
    before += commanded(n) * sample_period;
    after += slow * sample_period;
    const std::array<double, 5> row{n * sample_period * 1e3, commanded(n) / millimetre, slow / millimetre,
                                    before / millimetre, after / millimetre};
    for (std::size_t i = 0; i < row.size(); ++i) data.columns[i].values.push_back(row[i]);
  }
  return data;
}

FigureData figure3() {
  FigureData data{
      3, {{"t_ms", {}}, {"x_before_mm_s", {}}, {"y_before_mm_s", {}}, {"x_after_mm_s", {}}, {"y_after_mm_s", {}}}};
  const Corner corner = drawn_corner();
  const SampledMotion motion = simulate_corner(linear(), corner, 0, sample_period);
  for (int n = 0; n < motion.velocity.rows(); ++n) {
    // Commands: leg 1 from after `start` to `corner`, leg 2 from there to `stop`.
    const bool in = n > motion.start && n <= motion.corner, out = n > motion.corner && n <= motion.stop;
    const Eigen::VectorXd command = in    ? Eigen::VectorXd(corner.feed_in * corner.direction_in)
                                    : out ? Eigen::VectorXd(corner.feed_out * corner.direction_out)
                                          : Eigen::VectorXd::Zero(2).eval();
    const std::array<double, 5> row{(n - motion.corner) * sample_period * 1e3, command[0] / millimetre,
                                    command[1] / millimetre, motion.velocity(n, 0) / millimetre,
                                    motion.velocity(n, 1) / millimetre};
    for (std::size_t i = 0; i < row.size(); ++i) data.columns[i].values.push_back(row[i]);
  }
  return data;
}

FigureData figure4() {
  FigureData data{4, {{"k", {}}, {"x_mm", {}}, {"y_mm", {}}, {"a_mm", {}}, {"b_mm", {}}}};
  const Corner corner = drawn_corner();
  // b bisects the angle between the legs, seen from the corner. a is perpendicular to it, along the motion.
  const Eigen::VectorXd along = (corner.direction_in + corner.direction_out).normalized();
  const Eigen::VectorXd halving = (corner.direction_out - corner.direction_in).normalized();
  const SampledMotion motion = simulate_corner(linear(), corner, 0, sample_period);
  for (int k = -5; k <= ramp_samples + 5; ++k) {
    const Eigen::VectorXd s = motion.position.row(motion.corner + k).transpose();
    const std::array<double, 5> row{static_cast<double>(k), s[0] / millimetre, s[1] / millimetre,
                                    s.dot(along) / millimetre, s.dot(halving) / millimetre};
    for (std::size_t i = 0; i < row.size(); ++i) data.columns[i].values.push_back(row[i]);
  }
  return data;
}

}  // namespace accdec::paper
