#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/velocity_changes.hpp>

namespace accdec {
namespace {

constexpr double decays_kept = 24.0;  // exp(-24) is 4e-11

}  // namespace

double memory_of(const Mode& mode, double damping, double longest) {
  const double rate = 2.0 * std::numbers::pi * mode.frequency_low * damping;
  return rate * longest > decays_kept ? decays_kept / rate : longest;
}

double residual_vibration(const Filter& filter, double frequency, double sample_period, double damping) {
  const double w = 2.0 * std::numbers::pi * frequency * sample_period;
  const auto taps = filter.taps();
  if (damping != 0.0) {
    // Products of std::complex look for infinities.
    const double decay = std::exp(-damping * w), turn = w * std::sqrt(1.0 - damping * damping);
    const double step_c = decay * std::cos(turn), step_s = decay * std::sin(turn);
    double c = 0.0, s = 0.0;
    for (const double tap : taps) {
      const double next = c * step_c - s * step_s + tap;
      s = c * step_s + s * step_c;
      c = next;
    }
    return std::hypot(c, s);
  }
  double c = 0.0, s = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const double x = w * static_cast<double>(i);
    c += taps[i] * std::cos(x);
    s += taps[i] * std::sin(x);
  }
  return std::hypot(c, s);
}

namespace {

/// |H|^2 and half its derivative with respect to w = 2 pi f T, by Horner's rule on H and dH/dz.
struct Response {
  double square, slope;
};

Response response(const Filter& filter, double frequency, double sample_period) {
  const double w = 2.0 * std::numbers::pi * frequency * sample_period;
  const double zr = std::cos(w), zi = -std::sin(w);
  double hr = 0.0, hi = 0.0, dr = 0.0, di = 0.0;
  const auto taps = filter.taps();
  for (std::size_t i = taps.size(); i-- > 0;) {
    const double r = dr * zr - di * zi + hr, im = dr * zi + di * zr + hi;
    dr = r;
    di = im;
    const double h = hr * zr - hi * zi + taps[i];
    hi = hr * zi + hi * zr;
    hr = h;
  }
  // dH/dw = -j z dH/dz; d|H|^2/dw = 2 Re(conj(H) dH/dw).
  const double gr = zr * di + zi * dr, gi = zi * di - zr * dr;
  return {hr * hr + hi * hi, hr * gr + hi * gi};
}

/// Finds the frequency with the largest |H|^2 on a mode's band, by branch and bound over intervals. Between two points
/// with known value and slope, the cubic through them is off by at most h^4/384 times the fourth derivative. For a
/// trigonometric polynomial of degree N with values up to 1, that derivative is at most (2 pi N T)^4 (Bernstein's
/// inequality).
double worst_frequency(const Filter& filter, const Mode& mode, double sample_period,
                       const std::function<bool()>& stop) {
  struct Point {
    double f;
    Response r;
  };
  const auto at = [&](double f) { return Point{f, response(filter, f, sample_period)}; };
  Point best = at(mode.frequency_low);
  const double width = mode.frequency_high - mode.frequency_low;
  if (width <= 0.0) return best.f;
  const auto consider = [&](const Point& p) {
    if (p.r.square > best.r.square) best = p;
  };
  const double degree = 2.0 * std::numbers::pi * sample_period * std::max(1, filter.order());
  const auto cubic_error = [&](double h) { return std::pow(degree * h, 4) / 384.0; };
  // Largest value of the cubic between two points, at its ends or where its slope changes from up to down.
  const auto cubic_max = [&](const Point& a, const Point& b) {
    const double h = b.f - a.f, unit = 4.0 * std::numbers::pi * sample_period * h;
    const double ma = a.r.slope * unit, mb = b.r.slope * unit, rise = b.r.square - a.r.square;
    const double c3 = ma + mb - 2.0 * rise, c2 = 3.0 * rise - 2.0 * ma - mb;
    double largest = std::max(a.r.square, b.r.square);
    const double root = c2 * c2 - 3.0 * c3 * ma;
    if (root < 0.0) return largest;
    for (const double x :
         {(-c2 - std::sqrt(root)) / (3.0 * c3), (-c2 + std::sqrt(root)) / (3.0 * c3), -0.5 * ma / c2}) {
      if (x > 0.0 && x < 1.0) largest = std::max(largest, a.r.square + x * (ma + x * (c2 + x * c3)));
    }
    return largest;
  };
  std::vector<std::pair<Point, Point>> open;
  const int cells = std::max(1, static_cast<int>(std::ceil(8.0 * width * sample_period * (filter.order() + 1))));
  Point last = best;
  for (int i = 1; i <= cells && !(stop && stop()); ++i) {
    const Point next = at(mode.frequency_low + width * (i == cells ? 1.0 : static_cast<double>(i) / cells));
    consider(next);
    open.emplace_back(last, next);
    last = next;
  }
  // Far below the bound the last digits do not matter; elsewhere 1e-12 of the square is precise enough. The error term
  // uses only |H| <= 1, so for bounds of 1e-5 and less the loop ends by its count.
  const double floor = 1e-10 * mode.residual_max * mode.residual_max;
  for (int left = 4096 + 64 * cells; !open.empty() && left > 0 && !(stop && stop()); --left) {
    const auto [a, b] = open.back();
    open.pop_back();
    if (cubic_max(a, b) + cubic_error(b.f - a.f) <= std::max(best.r.square * (1.0 + 1e-12), floor)) continue;
    const Point middle = at(0.5 * (a.f + b.f));
    if (middle.f <= a.f || middle.f >= b.f) continue;
    consider(middle);
    open.emplace_back(a, middle);
    open.emplace_back(middle, b);
  }
  return best.f;
}

/// Finds where a damped mode is left largest. With s = z w + j w sqrt(1 - z^2), what is left is the size of an analytic
/// function of s. So the largest is on the edge of the rectangle of frequencies and damping ratios. This holds for the
/// size over the imaginary part of s, too, as the logarithm of both is subharmonic.
class WorstDamped {
 public:
  struct Point {
    double frequency, damping, left = 0.0;
  };

  using Left = std::function<double(double frequency, double damping)>;

  /// @param left  what is left  @param duration  s, of the longest command that it depends on
  WorstDamped(Left left, const Mode& mode, double duration, const std::function<bool()>& stop)
      : left_(std::move(left)), stop_(stop), duration_(duration) {
    best_ = at({mode.frequency_low, mode.damping_low});
    across(mode, mode.damping_low);
    if (mode.damping_high == mode.damping_low) return;
    across(mode, mode.damping_high);
    for (const double f : {mode.frequency_low, mode.frequency_high}) along_damping(f, mode);
  }
  const Point& worst() const { return best_; }

 private:
  static constexpr int per_unit = 8, golden_steps = 12;

  Point at(Point p) const {
    p.left = left_(p.frequency, p.damping);
    return p;
  }

  /// All frequencies with one damping ratio. Between two grid points the response turns by an eighth of a ripple.
  void across(const Mode& mode, double damping) {
    const double low = mode.frequency_low, high = mode.frequency_high;
    if (low == high) return;
    // Rounding must not leave the rectangle.
    edge(
        [&](double x) {
          return at({x == 1.0 ? high : low + x * (high - low), damping});
        },
        memory_of(mode, damping, duration_) * (high - low));
  }

  /// All damping ratios with one frequency. Between two grid points the response is damped by an eighth more. The
  /// smaller the memory, the farther apart are grid points.
  void along_damping(double frequency, const Mode& mode) {
    const double decays = 2.0 * std::numbers::pi * frequency * duration_;  // with a damping ratio of 1
    const auto damped = [&](double z) {
      return z * decays <= decays_kept ? z * decays : decays_kept * (1.0 + std::log(z * decays / decays_kept));
    };
    const double begin = damped(mode.damping_low), end = damped(mode.damping_high);
    const auto ratio = [&](double x) {
      const double by = begin + x * (end - begin);
      const double z = (by <= decays_kept ? by : decays_kept * std::exp(by / decays_kept - 1.0)) / decays;
      return x == 1.0 ? mode.damping_high : std::clamp(z, mode.damping_low, mode.damping_high);
    };
    edge([&](double x) { return at({frequency, ratio(x)}); }, end - begin);
  }

  template <class Place>
  void edge(const Place& place, double units) {
    const int cells = 4 + static_cast<int>(std::ceil(per_unit * units));
    std::vector<double> left;
    for (int i = 0; i <= cells && !(stop_ && stop_()); ++i) {
      const Point p = place(static_cast<double>(i) / cells);
      left.push_back(p.left);
      if (p.left > best_.left) best_ = p;
    }
    // A peak between grid points is not much higher than they are.
    const double worthwhile = 0.8 * best_.left;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const bool rises = i > 0 && left[i - 1] > left[i], falls = i + 1 < left.size() && left[i + 1] > left[i];
      if (rises || falls || left[i] < worthwhile || (stop_ && stop_())) continue;
      const double x = static_cast<double>(i), last = static_cast<double>(cells);
      climb(place, std::max(0.0, x - 1.0) / last, std::min(last, x + 1.0) / last);
    }
  }

  /// Golden section, then the top of the parabola through the last three points: off by less than 1e-10 of the peak.
  template <class Place>
  void climb(const Place& place, double low, double high) {
    constexpr double part = 1.0 / std::numbers::phi;
    double a = high - part * (high - low), b = low + part * (high - low);
    Point pa = place(a), pb = place(b);
    for (int step = 0; step < golden_steps; ++step) {
      if (pa.left > pb.left) {
        high = b, b = a, pb = pa;
        pa = place(a = high - part * (high - low));
      } else {
        low = a, a = b, pa = pb;
        pb = place(b = low + part * (high - low));
      }
    }
    const double middle = 0.5 * (a + b), fa = pa.left * pa.left, fb = pb.left * pb.left;
    const Point pm = place(middle);
    const double fm = pm.left * pm.left, bend = fa - 2.0 * fm + fb;
    const double top = bend < 0.0 ? middle + 0.25 * (b - a) * (fa - fb) / bend : middle;
    for (const Point& p : {pa, pb, pm, place(std::clamp(top, low, high))}) {
      if (p.left > best_.left) best_ = p;
    }
  }

  Left left_;
  const std::function<bool()>& stop_;
  double duration_;
  Point best_{};
};

void require_in_range(const Mode& mode) {
  if (!(mode.frequency_low > 0.0 && mode.frequency_high >= mode.frequency_low && std::isfinite(mode.frequency_high))) {
    throw std::invalid_argument(fmt::format("mode needs 0 < frequency_low <= frequency_high, got {} to {} Hz",
                                            mode.frequency_low, mode.frequency_high));
  }
  if (!(mode.damping_low >= 0.0 && mode.damping_high >= mode.damping_low && mode.damping_high < 1.0)) {
    throw std::invalid_argument(fmt::format("mode needs 0 <= damping_low <= damping_high < 1, got {} to {}",
                                            mode.damping_low, mode.damping_high));
  }
}

}  // namespace

std::vector<LimitUse> vibration_utilisation(const Filter& filter, double sample_period, const Machine& machine,
                                            const std::function<bool()>& stop) {
  if (!(sample_period > 0.0) || !std::isfinite(sample_period))
    throw std::invalid_argument(fmt::format("sample period must be positive and finite, got {} s", sample_period));
  std::vector<LimitUse> uses;
  for (const Mode& mode : machine.modes) {
    if (mode.of_axis()) continue;
    require_in_range(mode);
    LimitUse use;
    use.kind = LimitKind::vibration;
    if (mode.damping_high == 0.0) {
      use.frequency = worst_frequency(filter, mode, sample_period, stop);
      use.value = residual_vibration(filter, use.frequency, sample_period);
    } else {
      const WorstDamped search([&](double f, double z) { return residual_vibration(filter, f, sample_period, z); },
                               mode, sample_period * (filter.order() + 1.0), stop);
      use.frequency = search.worst().frequency, use.damping = search.worst().damping;
      use.value = search.worst().left;
    }
    use.bound = mode.residual_max;
    use.utilisation = utilisation_of(use.kind, use.value, mode.residual_max);
    uses.push_back(use);
  }
  return uses;
}

namespace {

/// The powers of the factor by which a vibration turns and dies away in a sample.
class Turns {
 public:
  Turns(double decay, double turn) : decay_(decay), turn_(turn), step_(std::polar(std::exp(-decay), turn)) {
    powers_[0] = 1.0;
  }
  std::complex<double> over(std::int64_t samples) {
    if (samples >= std::ssize(powers_))
      return std::polar(std::exp(-decay_ * static_cast<double>(samples)), turn_ * static_cast<double>(samples));
    for (; known_ <= samples; ++known_)
      powers_[static_cast<std::size_t>(known_)] = product(powers_[static_cast<std::size_t>(known_ - 1)], step_);
    return powers_[static_cast<std::size_t>(samples)];
  }
  /// Products of std::complex look for infinities.
  static std::complex<double> product(std::complex<double> a, std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }

 private:
  double decay_, turn_;
  std::complex<double> step_;
  std::array<std::complex<double>, 64> powers_;
  std::int64_t known_ = 1;
};

/// Tells the square of what is left behind every change that is judged, if a change of 1 leaves 1.
template <class Told>
void tell_left(std::span<const VelocityChange> changes, double frequency, double sample_period, double damping,
               const Told& told) {
  const double w = 2.0 * std::numbers::pi * frequency * sample_period;
  Turns turns(damping * w, w * std::sqrt(1.0 - damping * damping));
  std::complex<double> left = 0.0;
  std::int64_t before = changes.front().sample;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    left = Turns::product(left, turns.over(changes[i].sample - before)) + changes[i].by;
    before = changes[i].sample;
    if (changes[i].judged || i + 1 == changes.size()) told(i, std::norm(left));
  }
}

/// The amplitude that a change of 1 m/s leaves, m. All changes excite through the same filter, the first ones earlier.
double left_of_one(const Filter& filter, double frequency, double sample_period, double damping) {
  const double natural = 2.0 * std::numbers::pi * frequency;
  return residual_vibration(filter, frequency, sample_period, damping) / (natural * std::sqrt(1.0 - damping * damping));
}

double amplitude_left_by(const Filter& filter, std::span<const VelocityChange> changes, double frequency,
                         double sample_period, double damping) {
  double most = 0.0;
  tell_left(changes, frequency, sample_period, damping,
            [&](std::size_t, double square) { most = std::max(most, square); });
  return left_of_one(filter, frequency, sample_period, damping) * std::sqrt(most);
}

}  // namespace

std::vector<double> residuals_behind(const Filter& filter, std::span<const VelocityChange> changes, double frequency,
                                     double sample_period, double damping) {
  const double of_one = left_of_one(filter, frequency, sample_period, damping);
  std::vector<double> all(changes.size(), 0.0);
  tell_left(changes, frequency, sample_period, damping,
            [&](std::size_t i, double square) { all[i] = of_one * std::sqrt(square); });
  return all;
}

double residual_amplitude(const Filter& filter, double v1, double v2, int delay, double frequency, double sample_period,
                          double damping) {
  return amplitude_left_by(filter, std::array{VelocityChange{0, -v1, false}, VelocityChange{delay, v2, false}},
                           frequency, sample_period, damping);
}

LimitUse residual_utilisation(const Filter& filter, double v1, double v2, int delay, double sample_period,
                              const Mode& mode) {
  return residual_utilisation(filter, std::array{VelocityChange{0, -v1, false}, VelocityChange{delay, v2, false}},
                              sample_period, mode);
}

LimitUse residual_utilisation(const Filter& filter, std::span<const VelocityChange> changes, double sample_period,
                              const Mode& mode) {
  require_in_range(mode);
  const std::function<bool()> never;
  const double duration =
      sample_period * (filter.order() + 1.0 + static_cast<double>(changes.back().sample - changes.front().sample));
  const WorstDamped search([&](double f, double z) { return amplitude_left_by(filter, changes, f, sample_period, z); },
                           mode, duration, never);
  LimitUse use;
  use.kind = LimitKind::residual;
  use.frequency = search.worst().frequency, use.damping = search.worst().damping;
  use.value = search.worst().left, use.bound = mode.displacement_max;
  use.utilisation = utilisation_of(use.kind, use.value, use.bound);
  return use;
}

}  // namespace accdec
