#include <algorithm>
#include <cmath>

#include <accdec/simulate/sample_smoother.hpp>

namespace accdec {

SampleSmoother::SampleSmoother(const Filter& filter, std::size_t dimensions, const Point& at, std::int64_t place,
                               double largest)
    : filter_(filter), taps_(filter.order() + 1), n_(dimensions) {
  for (const double tap : filter.taps()) equal_ = equal_ && tap == filter.tap(0);
  if (taps_ == 1) return;
  constexpr int bits = 61;  // of the largest sum
  int exponent = 0;
  std::frexp(largest * taps_, &exponent);
  unit_ = std::ldexp(1.0, exponent - bits);
  per_unit_ = 1.0 / unit_;
  share_ = unit_ / taps_;
  places_.assign(static_cast<std::size_t>(taps_), place);
  ring_.resize(static_cast<std::size_t>(taps_) * n_);
  for (std::size_t i = 0; i < ring_.size(); ++i) ring_[i] = units(at[i % n_]);
  for (std::size_t a = 0; a < n_; ++a)
    sum_[a] = static_cast<std::uint64_t>(ring_[a]) * static_cast<std::uint64_t>(taps_);
}

/// A motion that leaves its path, which only a forged result has, gets positions that break its limits.
std::int64_t SampleSmoother::units(double x) const {
  constexpr double most = 4e18;
  return static_cast<std::int64_t>(std::clamp(x * per_unit_, -most, most));
}

/// Takes the place of the oldest value of an axis, for equal taps.
inline double SampleSmoother::smoothed(std::size_t axis, double raw, std::int64_t& oldest) {
  const std::int64_t at = units(raw);
  const auto moved = static_cast<std::uint64_t>(at);
  sum_[axis] += moved - static_cast<std::uint64_t>(oldest);
  oldest = at;
  // The newest sample and the mean distance of all from it; this rounds less than a mean of positions.
  const auto beside = static_cast<std::int64_t>(sum_[axis] - moved * static_cast<std::uint64_t>(taps_));
  return static_cast<double>(at) * unit_ + static_cast<double>(beside) * share_;
}

/// @tparam axes  their number; 0: n_
template <std::size_t axes>
void SampleSmoother::take(const Point& raw, std::int64_t* row, Point& out) {
  for (std::size_t a = 0; a < (axes > 0 ? axes : n_); ++a) out[a] = smoothed(a, raw[a], row[a]);
}

inline void SampleSmoother::advance(std::int64_t place) {
  places_[slot_] = place;
  slot_ = slot_ + 1 == static_cast<std::size_t>(taps_) ? 0 : slot_ + 1;
}

void SampleSmoother::next(const Point& raw, std::int64_t place, Point& out) {
  if (taps_ == 1) {
    std::copy_n(raw.begin(), n_, out.begin());
    return;
  }
  std::int64_t* const row = ring_.data() + slot_ * n_;
  switch (n_) {
    case 2: take<2>(raw, row, out); break;
    case 3: take<3>(raw, row, out); break;
    default: take<0>(raw, row, out);
  }
  const std::size_t newest = slot_;
  advance(place);
  if (!equal_) convolve(raw, newest, out);
}

template <std::size_t axes>
void SampleSmoother::take_run(const std::array<double*, program_axis_count>& rows, std::int64_t count,
                              std::int64_t place, std::int64_t* oldest) {
  for (std::int64_t k = 0; k < count; ++k) {
    std::int64_t* const row = ring_.data() + slot_ * n_;
    for (std::size_t a = 0; a < (axes > 0 ? axes : n_); ++a) rows[a][k] = smoothed(a, rows[a][k], row[a]);
    advance(place);
    oldest[k] = places_[slot_];
  }
}

void SampleSmoother::next_run(const std::array<double*, program_axis_count>& rows, std::int64_t count,
                              std::int64_t place, std::int64_t* oldest) {
  if (taps_ == 1) {
    std::fill_n(oldest, count, place);
    return;
  }
  if (equal_) {
    switch (n_) {
      case 2: return take_run<2>(rows, count, place, oldest);
      case 3: return take_run<3>(rows, count, place, oldest);
      default: return take_run<0>(rows, count, place, oldest);
    }
  }
  Point raw{}, out{};
  for (std::int64_t k = 0; k < count; ++k) {
    for (std::size_t a = 0; a < n_; ++a) raw[a] = rows[a][k];
    next(raw, place, out);
    for (std::size_t a = 0; a < n_; ++a) rows[a][k] = out[a];
    oldest[k] = places_[slot_];
  }
}

/// As for equal taps, by the distances from the newest sample.
void SampleSmoother::convolve(const Point& raw, std::size_t newest, Point& out) const {
  const std::size_t count = static_cast<std::size_t>(taps_);
  const std::int64_t* const now = ring_.data() + newest * n_;
  Point sum{};
  const double* tap = filter_.taps().data();
  for (std::size_t i = 0, at = newest; i < count; ++i, at = at == 0 ? count - 1 : at - 1) {
    if (tap[i] == 0.0) continue;
    for (std::size_t a = 0; a < n_; ++a) sum[a] += tap[i] * static_cast<double>(ring_[at * n_ + a] - now[a]);
  }
  for (std::size_t a = 0; a < n_; ++a) out[a] = raw[a] + sum[a] * unit_;
}

}  // namespace accdec
