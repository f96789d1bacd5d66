#include <array>

#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

/// Where the command changes, and by how much: it is constant everywhere else.
struct Step {
  int at;
  double size;
};

/// The command of one axis: rest, leg 1, gap, leg 2, rest.
struct Command {
  std::array<Step, 4> steps;

  double at(int k) const {
    double value = 0.0;
    for (const Step& step : steps) value = k >= step.at ? value + step.size : value;
    return value;
  }
};

}  // namespace

SampledMotion simulate_corner(const Filter& filter, const Corner& corner, int delay, double sample_period) {
  const int n = filter.order();
  const int rest = n + 3, leg = n + 4;
  const int total = rest + leg + delay + leg + rest;
  const Eigen::Index axes = corner.axes();

  SampledMotion motion;
  motion.start = rest - 1;
  motion.corner = rest + leg - 1;
  motion.stop = motion.corner + delay + leg;
  motion.cruise_in = motion.corner - 1;
  motion.cruise_out = motion.stop - 1;
  motion.velocity = Eigen::MatrixXd::Zero(total, axes);
  motion.acceleration = motion.jerk = motion.position = motion.velocity;

  const auto taps = filter.taps();
  long double whole = 0.0L;
  for (const double tap : taps) whole += tap;
  for (Eigen::Index a = 0; a < axes; ++a) {
    const double in = corner.feed_in * corner.direction_in[a], out = corner.feed_out * corner.direction_out[a];
    const Command command{
        {{{rest, in}, {rest + leg, -in}, {rest + leg + delay, out}, {rest + leg + delay + leg, -out}}}};
    // Extended precision: the path is metres long, the corner error micrometres. Starting from minus the commanded
    // length of leg 1 makes the position relative to the corner point.
    long double position = -static_cast<long double>(in) * leg * sample_period, velocity = 0.0L;
    for (int k = 0; k < total; ++k) {
      // The convolution of the command with the taps, as its change from sample to sample: only where the command
      // changed within the last n samples does it change. Where it did not, the sum is that of all taps, and no
      // rounding of earlier samples is carried on.
      bool changing = false;
      for (const Step& step : command.steps) {
        if (k < step.at || k - step.at > n) continue;
        velocity += static_cast<long double>(taps[static_cast<std::size_t>(k - step.at)]) * step.size;
        changing = true;
      }
      if (!changing) velocity = whole * command.at(k);
      position += velocity * sample_period;
      motion.velocity(k, a) = static_cast<double>(velocity);
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
