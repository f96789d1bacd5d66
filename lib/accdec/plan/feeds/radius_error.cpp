#include <algorithm>
#include <cmath>

#include <accdec/motion/circle.hpp>
#include <accdec/plan/feeds/radius_error.hpp>

namespace accdec {

RadiusError::RadiusError(const FilterBehind& behind, std::size_t dimensions, double sample_period) {
  for (std::size_t a = 0; a < dimensions; ++a) {
    // A response that overshoots may widen an arc.
    deviation2_.push_back((std::abs(tap_variance(behind.motion(a))) + 0.25) * sample_period * sample_period);
    lag_.push_back(behind.motion(a).mean_delay() * sample_period);
  }
}

double RadiusError::speed(const PathArc& arc, double bound) const {
  const double square = std::max(deviation2_[arc.x], deviation2_[arc.y]) / (2.0 * arc.radius);
  const double linear = 0.5 * std::abs(lag_[arc.x] - lag_[arc.y]);
  return 2.0 * bound / (linear + std::sqrt(linear * linear + 4.0 * square * bound));
}

double beside_chords(double bound, double sagitta) {
  return std::max(0.1 * bound, bound - sagitta);
}

double sagitta_of(const PathArc& arc) {
  const double chords = arc.last - arc.first + 1.0;
  return arc.radius * (1.0 - std::cos(0.5 * arc.angle / chords));
}

}  // namespace accdec
