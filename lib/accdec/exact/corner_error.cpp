#include <algorithm>
#include <cmath>

#include <accdec/exact/corner_error.hpp>

namespace accdec::exact {
namespace {

/// The least distance of all p' >= p, q' >= q from the corner point.
double least_distance(double cosine, double p, double q) {
  if (cosine < 0.0) {
    if (p < -q * cosine) return q * std::sqrt(1.0 - cosine * cosine);
    if (q < -p * cosine) return p * std::sqrt(1.0 - cosine * cosine);
  }
  return std::sqrt(std::max(0.0, p * p + q * q + 2.0 * p * q * cosine));
}

}  // namespace

CornerError::CornerError(const LimitModel& model, const Filter& filter, std::size_t j)
    : behind_(filter, model.task().machine, model.task().sample_period),
      filter_(behind_.motion()),
      cosine_(std::cos(model.theta(j))),
      in_(model.scale_in(j)),
      out_(model.scale_out(j)),
      bound_(model.error_bound(j)) {}

double CornerError::at(int delay, int sample) const {
  const double p = in_ * filter_.remaining_moment(sample), q = out_ * filter_.elapsed_moment(sample - delay);
  return std::sqrt(std::max(0.0, p * p + q * q + 2.0 * p * q * cosine_));
}

double CornerError::relaxed(const CornerBox& c) const {
  if (c.d1 == c.d2 && c.k1 == c.k2) return at(c.d1, c.k1) - bound_;
  return least_distance(cosine_, in_ * filter_.remaining_moment(c.k2), out_ * filter_.elapsed_moment(c.k1 - c.d2)) -
         bound_;
}

bool CornerError::holds(int delay, const CornerBox& c, int order) const {
  for (int k = c.k1; k <= std::min(c.k2, order + behind_.longer() + delay + 1); ++k) {
    if (at(delay, k) <= bound_ * (1.0 + 1e-9) + 1e-12) return true;
  }
  return false;
}

int CornerError::closest_sample(int delay) const {
  double least = std::numeric_limits<double>::infinity();
  int closest = 0;
  for (int k = 0; k <= filter_.order() + delay + 1; ++k) {
    if (const double e = at(delay, k); e < least) least = e, closest = k;
  }
  return closest;
}

void consider_splits(const CornerError& error, std::size_t j, const CornerBox& c, bool delays_too, ErrorSplit& chosen) {
  const auto take = [&](bool on_delay, int at, double gain) {
    if (gain > chosen.gain) chosen = {{static_cast<int>(j), on_delay, at}, gain};
  };
  const auto first_misses = [&](int at) {
    CornerBox first = c;
    first.k2 = at;
    return error.relaxed(first);
  };
  const auto second_misses = [&](int at) {
    CornerBox second = c;
    second.k1 = at + 1;
    return error.relaxed(second);
  };
  // The first part's miss falls, the second's rises. The smaller of both is largest where they cross.
  int low = c.k1, high = c.k2 - 1;
  while (low < high) {
    const int at = low + (high - low) / 2;
    if (first_misses(at) > second_misses(at))
      low = at + 1;
    else
      high = at;
  }
  for (int at = std::max(c.k1, low - 1); at <= std::min(low, c.k2 - 1); ++at)
    take(false, at, std::min(first_misses(at), second_misses(at)));
  for (int at = c.d1; at < c.d2 && (delays_too || c.k1 == c.k2); ++at) {
    CornerBox first = c, second = c;
    first.d2 = at, second.d1 = at + 1;
    take(true, at, std::min(error.relaxed(first), error.relaxed(second)));
  }
}

}  // namespace accdec::exact
