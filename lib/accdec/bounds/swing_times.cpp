#include <algorithm>
#include <cmath>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/swing_times.hpp>

namespace accdec {
namespace {

constexpr std::array<double, SwingTimes::kinds_max> multipliers{1.0, 1.35, 1.75};  // times 1/A, below 2/A

/// Steps of D: 16 to every power of 2, from 2^first_octave m up.
constexpr int per_octave = 16, first_octave = -24, octaves = 28;
double way_at(std::size_t i) {
  const auto octave = static_cast<int>(i) / per_octave, part = static_cast<int>(i) % per_octave;
  return std::ldexp(1.0 + static_cast<double>(part) / per_octave, first_octave + octave);
}

/// A concave function with the value 0 at 0; between steps on the chord, which is below it.
double on_chords(const std::vector<double>& values, double way) {
  if (way < way_at(0)) return values[0] * way / way_at(0);
  int exponent = 0;
  const double part = 2.0 * std::frexp(way, &exponent) - 1.0;  // in [0, 1)
  const auto i =
      static_cast<std::size_t>((exponent - 1 - first_octave) * per_octave + static_cast<int>(part * per_octave));
  if (i + 1 >= values.size()) return values.back();
  return values[i] + (values[i + 1] - values[i]) * (way - way_at(i)) / (way_at(i + 1) - way_at(i));
}

}  // namespace

double SwingTimes::least(double acceleration, double jerk, double multiplier, double way) {
  const double r = 2.0 * acceleration / jerk, m = multiplier;
  // Longer than r: h (1 - m A/2) + m (2 D + A r^2/6)/h.
  const double slope = 1.0 - 0.5 * m * acceleration, over = m * (2.0 * way + acceleration * r * r / 6.0);
  const double h = std::max(r, std::sqrt(over / slope));
  const double time = h * slope + over / h;
  // Shorter: h + 2 m D/h - m J h^2/6, whose slope 1 - m (2 D/h^2 + J h/3) is largest at `top`.
  const double top = std::cbrt(12.0 * way / jerk);
  const auto rises = [&](double x) { return m * (2.0 * way / (x * x) + jerk * x / 3.0) < 1.0; };
  if (!(top > 0.0) || !rises(top)) return time;
  double low = 0.0, high = top;  // around the only root of the slope below `top`
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (rises(middle) ? high : low) = middle;
  }
  if (low >= r) return time;
  return std::min(time, high + 2.0 * m * way / high - m * jerk * high * high / 6.0);
}

SwingTimes::SwingTimes(const Machine& machine, std::size_t dimensions) {
  for (std::size_t a = 0; a < dimensions && a < machine.axes.size(); ++a) {
    const Axis& limits = machine.axes[a];
    Table& table = axes_.emplace_back();
    table.acceleration = acceleration_most(limits);
    table.jerk = table.acceleration < unlimited && limits.jerk_max < unlimited;
    if (!table.jerk) continue;
    kinds_ = kinds_max;
    for (std::size_t k = 0; k < kinds_max; ++k) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(per_octave * octaves); ++i) {
        const double m = multipliers[k] / table.acceleration;
        table.inside[k].push_back((1.0 - 1e-12) * least(table.acceleration, limits.jerk_max, m, way_at(i)));
      }
    }
  }
}

double SwingTimes::inside(std::size_t axis, std::size_t kind, double way) const {
  const Table& table = axes_[axis];
  return table.jerk ? on_chords(table.inside[kind], way) : 2.0 * std::sqrt(way / table.acceleration);
}

double SwingTimes::at_end(std::size_t axis, std::size_t kind, double way) const {
  const Table& table = axes_[axis];
  if (!table.jerk) return std::sqrt(2.0 * way / table.acceleration);
  // h (1 - m A/2) + m D/h
  const double m = multipliers[kind] / table.acceleration;
  return 2.0 * std::sqrt((1.0 - 0.5 * multipliers[kind]) * m * way);
}

}  // namespace accdec
