#include <algorithm>

#include <accdec/task/simulation.hpp>

namespace accdec {

SampledMotion simulate_corner(const Filter& filter, const Corner& corner, int delay, double sample_period) {
  const int n = filter.order();
  const int rest = n + 3, leg = 2 * n + 6;
  const int total = rest + leg + delay + leg + rest;
  const Eigen::Index axes = corner.axes();

  SampledMotion motion;
  motion.start = rest - 1;
  motion.corner = rest + leg - 1;
  motion.stop = motion.corner + delay + leg;
  motion.cruise_in = motion.corner - 1;
  motion.cruise_out = motion.stop - 1;

  Eigen::MatrixXd command = Eigen::MatrixXd::Zero(total, axes);
  command.middleRows(rest, leg).rowwise() = (corner.feed_in * corner.direction_in).transpose();
  command.middleRows(rest + leg + delay, leg).rowwise() = (corner.feed_out * corner.direction_out).transpose();

  motion.velocity = Eigen::MatrixXd::Zero(total, axes);
  motion.acceleration = motion.jerk = motion.position = motion.velocity;
  const auto taps = filter.taps();
  for (Eigen::Index a = 0; a < axes; ++a) {
    const double* const input = command.col(a).data();
    // Extended precision: the path is metres long, the corner error micrometres. Starting from minus the commanded
    // length of leg 1 makes the position relative to the corner point.
    long double position = 0.0L;
    for (int k = 0; k <= motion.corner; ++k) position -= static_cast<long double>(input[k]) * sample_period;
    for (int k = 0; k < total; ++k) {
      long double sum = 0.0L;
      for (int i = 0; i <= std::min(n, k); ++i) {
        sum += static_cast<long double>(taps[static_cast<std::size_t>(i)]) * input[k - i];
      }
      position += sum * sample_period;
      motion.velocity(k, a) = static_cast<double>(sum);
      motion.position(k, a) = static_cast<double>(position);
    }
    for (int k = 1; k < total; ++k) {
      motion.acceleration(k, a) = (motion.velocity(k, a) - motion.velocity(k - 1, a)) / sample_period;
      motion.jerk(k, a) = (motion.acceleration(k, a) - motion.acceleration(k - 1, a)) / sample_period;
    }
  }
  return motion;
}

}  // namespace accdec
