#include <algorithm>
#include <cmath>

#include <accdec/task/corner_speed.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The last taps of a filter, or the first ones backwards, as large as they can be and still end. As many as can be
/// have the largest size, the next fall by `step` from tap to tap. Closed forms, as slow axes have millions of taps.
struct Ramp {
  double mass = 0.0, moment = 0.0;  ///< sums of taps, and of taps times their distance (1 for the first)

  Ramp(const TapBounds& bounds, double top, double at_most) {
    const double most = std::min(bounds.most, at_most), step = bounds.step;
    if (!(most > 0.0)) return;
    const double equal = step == unlimited ? unlimited : std::max(0.0, std::floor((top - most) / step) + 1.0);
    const double full = std::min(equal, std::floor(at_most / most));
    mass = full * most, moment = 0.5 * full * (full + 1.0) * most;
    if (full < equal) {
      add(at_most - mass, full + 1.0);
      return;
    }
    const double first = top - equal * step, left = at_most - mass;
    const auto sum = [&](double n) { return n * (first - 0.5 * step * (n - 1.0)); };
    const double falling = std::max(0.0, std::ceil(first / step));
    // The largest number whose sum is at most `left`; rounding may put the root beside it.
    const double half = first + 0.5 * step, root = half * half - 2.0 * step * left;
    double n = root > 0.0 ? std::floor(2.0 * left / (half + std::sqrt(root))) : falling;
    n = std::clamp(n, 0.0, falling);
    while (n > 0.0 && sum(n) > left) n -= 1.0;
    while (n < falling && sum(n + 1.0) <= left) n += 1.0;
    mass += sum(n);
    moment += (equal + 1.0) * sum(n) + n * (n - 1.0) * (0.5 * first - step * (2.0 * n - 1.0) / 6.0);
    if (n < falling) add(at_most - mass, equal + n + 1.0);
  }

 private:
  /// A last tap that is not as large as it may be.
  void add(double tap, double distance) {
    if (!(tap > 0.0)) return;
    mass += tap, moment += tap * distance;
  }
};

/// The least moment of taps with this sum.
double least_moment(const TapBounds& bounds, double mass) {
  if (mass <= 0.0) return 0.0;
  if (mass > 1.0 + 1e-9) return unlimited;
  if (bounds.step == unlimited) return Ramp(bounds, 0.0, mass).moment;
  double low = 0.0, high = bounds.most + bounds.step * (mass / bounds.most + 1.0);
  for (int i = 0; i < 50; ++i) {
    const double top = 0.5 * (low + high);
    (Ramp(bounds, top, 2.0 * mass).mass <= mass ? low : high) = top;
  }
  return Ramp(bounds, low, mass).moment;
}

/// One corner and a smallest speed s: alpha and beta are the speeds of leg 1 after sample k and of leg 2 at it.
class SlowestPoint {
 public:
  SlowestPoint(double period, const TapBounds& bounds, const Corner& corner, double speed)
      : bounds_(bounds),
        corner_(corner),
        speed_(speed),
        cosine_(corner.cos_interior()),
        equal_(speed / std::sqrt(2.0 * (1.0 - cosine_))),
        to_error_(period * std::sqrt(0.5 * (1.0 + cosine_))) {}

  /// Whether every motion with this speed has a larger error.
  bool beyond(double error) const {
    constexpr int cells = 200;
    const double width = 2.0 * equal_ / cells;
    // The error is nearly smallest where both are equal: a speed that is no contradiction usually shows this there.
    const int middle = cells / 2;
    for (int i = 0; i <= cells; ++i) {
      const int cell = (middle + cells - i) % (cells + 1);
      if (least_error(cell * width, cell < cells ? (cell + 1) * width : unlimited) <= error) return false;
    }
    return true;
  }

 private:
  /// The speed the other leg, the faster one, needs if this one has a speed up to `equal_`.
  double beside(double slower) const {
    const double sine2 = (1.0 - cosine_) * (1.0 + cosine_);
    return slower * cosine_ + std::sqrt(std::max(0.0, speed_ * speed_ - slower * slower * sine2));
  }
  /// The minimum of this over a range. The function is concave up to `equal_`, and from there at least this leg's own
  /// speed.
  double beside(double low, double high) const {
    if (low >= equal_) return low;
    return std::min(beside(low), high < equal_ ? beside(high) : equal_);
  }
  double least_error(double low, double high) const {
    const double alpha = std::max(0.0, beside(low, high) - bounds_.most * corner_.feed_in);
    const double beta = std::max(low, beside(alpha, unlimited) - bounds_.most * corner_.feed_out);
    if (beta > high) return unlimited;
    return to_error_ * (corner_.feed_in * least_moment(bounds_, alpha / corner_.feed_in) +
                        corner_.feed_out * least_moment(bounds_, beta / corner_.feed_out));
  }

  const TapBounds& bounds_;
  const Corner& corner_;
  double speed_, cosine_, equal_, to_error_;
};

}  // namespace

CornerSpeeds::CornerSpeeds(const Task& task) : task_(granted_limits(task)), bounds_(tap_bounds(task_)) {}

double CornerSpeeds::fastest(std::size_t j) const {
  const TaskCorner& corner = task_.corners[j];
  const double cosine = corner.geometry().cos_interior();
  if (!corner.error_max || !(corner.speed_min > 0.0) || !(cosine > -1.0 && cosine < 1.0 - 1e-9)) return unlimited;
  const auto possible = [&](double speed) {
    return !SlowestPoint(task_.sample_period, bounds_, corner.geometry(), speed).beyond(*corner.error_max * 1.00000001);
  };
  if (possible(corner.speed_min)) return unlimited;
  double low = 0.0, high = corner.speed_min;
  for (int i = 0; i < 20; ++i) {
    const double mid = 0.5 * (low + high);
    (possible(mid) ? low : high) = mid;
  }
  return high;
}

}  // namespace accdec
