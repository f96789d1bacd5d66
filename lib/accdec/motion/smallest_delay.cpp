#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/corner.hpp>
#include <accdec/motion/leg_distance.hpp>

namespace accdec {
namespace {

struct Minimum {
  int at;
  double value;
};

/// Smallest f over lo .. hi for f that falls, then rises. Doubling steps from the guess bracket the minimum, golden
/// section narrows it: O(log |guess - minimum|) values of f.
template <class Function>
Minimum minimise(const Function& f, int guess, int lo, int hi) {
  // Compute all three at once: they do not depend on each other, and the guess is usually the answer.
  const double above = guess < hi ? f(guess + 1) : std::numeric_limits<double>::infinity();
  const double below = guess > lo ? f(guess - 1) : std::numeric_limits<double>::infinity();
  int best = guess;
  double f_best = f(guess);
  if (f_best <= std::min(above, below)) return {best, f_best};
  const int direction = above < f_best ? 1 : -1;
  int left = lo - 1, right = hi + 1;  // f is not smaller there, or they lie outside
  (direction > 0 ? left : right) = guess;
  best += direction;
  f_best = direction > 0 ? above : below;
  for (int step = 1;; step *= 2) {
    const int next = best + direction * step;
    if (next <= left || next >= right) break;
    const double value = f(next);
    int& behind = direction > 0 ? left : right;
    int& ahead = direction > 0 ? right : left;
    if (value < f_best) {
      behind = best;
      best = next;
      f_best = value;
    } else {
      ahead = next;
      break;
    }
  }
  while (right - left > 2) {
    const bool upwards = right - best > best - left;
    const int room = upwards ? right - best : best - left;
    const int next = best + (upwards ? 1 : -1) * std::max(1, static_cast<int>(0.382 * room));
    const double value = f(next);
    if (value < f_best) {
      (upwards ? left : right) = best;
      best = next;
      f_best = value;
    } else {
      (upwards ? right : left) = next;
    }
  }
  return {best, f_best};
}

std::vector<double> remaining_from_the_end(const Filter& filter) {
  std::vector<double> values;
  for (int k = filter.last_nonzero_tap(); k >= 0; --k) values.push_back(filter.remaining_moment(k));
  return values;
}

std::vector<double> elapsed_from_the_start(const Filter& filter) {
  std::vector<double> values;
  for (int m = filter.first_nonzero_tap(); m <= filter.order() + 1; ++m) values.push_back(filter.elapsed_moment(m));
  return values;
}

}  // namespace

DelayFinder::Ramp::Ramp(const std::vector<double>& values) {
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double step = m + 1 < values.size() ? values[m + 1] - values[m] : 1.0;
    points_.push_back({values[m], std::min(1.0 / step, 1e300)});  // finite for taps near the smallest double
  }
  // With four cells per sample, most hold no point or one. The last cell belongs to the top itself.
  const int cells = 4 * (last() + 1);
  scale_ = top() > 0.0 ? cells / std::sqrt(top()) : 0.0;
  cell_.resize(static_cast<std::size_t>(cells) + 3);
  int m = 0;
  for (std::size_t c = 0; c < cell_.size(); ++c) {
    while (m < last() &&
           static_cast<std::size_t>(std::sqrt(points_[static_cast<std::size_t>(m) + 1].value) * scale_) < c)
      ++m;
    cell_[c] = m;
  }
}

int DelayFinder::Ramp::floor(double x) const {
  const auto cell = static_cast<std::size_t>(std::sqrt(x) * scale_);
  auto m = static_cast<std::size_t>(cell_[cell]);
  m += points_[m + 1].value <= x;  // no branch to mispredict; there is a next point, for x is below the top
  if (points_[m + 1].value > x) return static_cast<int>(m);
  // The next cell's entry is the last point that may lie at or below x.
  const auto end = points_.begin() + std::min(cell_[cell + 1] + 1, last() + 1);
  const auto after = std::upper_bound(points_.begin() + static_cast<std::ptrdiff_t>(m) + 1, end, x,
                                      [](double value, const Point& point) { return value < point.value; });
  return static_cast<int>(after - points_.begin()) - 1;
}

double DelayFinder::Ramp::inverse(double x) const {
  if (x >= top()) return last() + (x - top());
  const int m = floor(x);
  const Point& point = points_[static_cast<std::size_t>(m)];
  return m + (x - point.value) * point.per_step;
}

DelayFinder::DelayFinder(const Filter& filter_in, const Filter& filter_out)
    : in_(remaining_from_the_end(filter_in)),
      out_(elapsed_from_the_start(filter_out)),
      last_(filter_in.last_nonzero_tap()),
      first_(filter_out.first_nonzero_tap()),
      stop_delay_(std::max(0, last_ - first_)),
      mean_delay_out_(filter_out.mean_delay()) {
  // The mean exponent of leg 1's last stretch, where tolerances usually put the apex. It is used only for the first
  // guess.
  if (last_ > 1) {
    const int m = std::clamp(in_.floor(in_.top() / 256.0), 1, last_ - 1);
    exponent_ = std::clamp(std::log(in_.top() / in_[m]) / std::log(static_cast<double>(last_) / m), 2.0, 8.0);
  }
}

int DelayFinder::operator()(double cos_interior, double step_in, double step_out, double error_max) const {
  const double error = std::max(0.0, error_max);
  if (stop_delay_ == 0 || in_.top() * step_in <= error) return 0;

  // From here on distances are in full-speed samples of leg 2.
  const double ratio = step_in / step_out, e = error / step_out;
  const double e2 = e * e, sine2 = (1.0 - cos_interior) * (1.0 + cos_interior);
  const auto real_delay = [&](int k) {
    const double p = in_[last_ - k] * ratio;
    const double root2 = e2 - p * p * sine2;
    if (root2 < 0.0 || (cos_interior > 0.0 && p > e)) return 1e9 - k;  // out of reach whatever leg 2 does
    const double q = std::sqrt(root2) - p * cos_interior;
    return k - first_ - out_.inverse(std::max(q, 0.0));
  };
  // If both ramps were the same power n of time, the smallest k would have a ratio g = Q/P that solves z (1 + g cos) =
  // g (g + cos). Here z is defined by g = z^n / ratio. To first order in log(ratio), log g = log(ratio) / (n - 1 + n
  // tan^2(theta/2)).
  const double a = (ratio - 1.0) * (1.0 + cos_interior);
  const double b = (ratio + 1.0) * ((exponent_ - 1.0) * (1.0 + cos_interior) + exponent_ * (1.0 - cos_interior));
  const double g = (b + a) / (b - a);
  const double apex = error / (step_in * std::sqrt(1.0 + g * (g + 2.0 * cos_interior)));
  const int guess = apex < in_.top() ? last_ - in_.floor(apex) : 0;
  const Minimum least = minimise(real_delay, guess, 0, last_);
  // Rounding of an inverse may exclude a delay that just meets the bound. The comparison of the error itself, below,
  // decides.
  const double lower = std::ceil(least.value - 1e-9);

  int k = least.at;
  for (int d = std::clamp(static_cast<int>(lower), 0, stop_delay_); d < stop_delay_; ++d) {
    const auto distance = [&](int sample) {
      const int m = sample - d - first_;
      const double q = m <= 0 ? 0.0 : m <= out_.last() ? out_[m] : m + first_ - mean_delay_out_;
      return leg_distance(in_[last_ - sample] * step_in, q * step_out, cos_interior);
    };
    if (distance(k) <= error) return d;
    const Minimum nearest = minimise(distance, k, 0, last_);
    if (nearest.value <= error) return d;
    k = nearest.at;
  }
  return stop_delay_;
}

}  // namespace accdec
