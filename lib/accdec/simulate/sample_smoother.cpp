#include <accdec/simulate/sample_smoother.hpp>

namespace accdec {

SampleSmoother::SampleSmoother(const Filter& filter, std::size_t dimensions, const Point& at, std::int64_t place)
    : filter_(filter), taps_(filter.order() + 1), n_(dimensions) {
  for (const double tap : filter.taps()) equal_ = equal_ && tap == filter.tap(0);
  if (taps_ == 1) return;
  ring_.resize(static_cast<std::size_t>(taps_) * n_);
  places_.assign(static_cast<std::size_t>(taps_), place);
  for (std::size_t i = 0; i < ring_.size(); ++i) ring_[i] = at[i % n_];
  for (std::size_t a = 0; a < n_; ++a) sum_[a] = static_cast<long double>(at[a]) * taps_;
}

void SampleSmoother::next(const Point& raw, std::int64_t place, Point& out) {
  if (taps_ == 1) {
    out = raw;
    return;
  }
  double* row = ring_.data() + slot_ * n_;
  for (std::size_t a = 0; a < n_; ++a) {
    if (equal_) sum_[a] += static_cast<long double>(raw[a]) - static_cast<long double>(row[a]);
    row[a] = raw[a];
  }
  places_[slot_] = place;
  const std::size_t newest = slot_;
  slot_ = slot_ + 1 == static_cast<std::size_t>(taps_) ? 0 : slot_ + 1;
  if (equal_)
    average(out);
  else
    convolve(raw, newest, out);
}

void SampleSmoother::average(Point& out) {
  if (slot_ == 0) {
    // Summed again once per round, so that rounding does not add up.
    for (std::size_t a = 0; a < n_; ++a) {
      sum_[a] = 0.0L;
      for (std::size_t i = a; i < ring_.size(); i += n_) sum_[a] += static_cast<long double>(ring_[i]);
    }
  }
  for (std::size_t a = 0; a < n_; ++a) out[a] = static_cast<double>(sum_[a] / taps_);
}

/// The newest sample and the distances of the others from it; this rounds less than a sum of positions.
void SampleSmoother::convolve(const Point& raw, std::size_t newest, Point& out) const {
  const std::size_t count = static_cast<std::size_t>(taps_);
  Point sum{};
  const double* tap = filter_.taps().data();
  for (std::size_t i = 0, at = newest; i < count; ++i, at = at == 0 ? count - 1 : at - 1) {
    if (tap[i] == 0.0) continue;
    for (std::size_t a = 0; a < n_; ++a) sum[a] += tap[i] * (ring_[at * n_ + a] - raw[a]);
  }
  for (std::size_t a = 0; a < n_; ++a) out[a] = raw[a] + sum[a];
}

}  // namespace accdec
