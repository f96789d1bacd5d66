#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

std::string_view to_string(Event event) {
  switch (event) {
    case Event::start: return "start";
    case Event::blend: return "blend";
    case Event::stop: return "stop";
    case Event::none: return "none";
  }
  return "?";
}

double utilisation_of(LimitKind kind, double value, double bound) {
  const double used = kind == LimitKind::speed_min ? bound : value;
  const double allowed = kind == LimitKind::speed_min ? value : bound;
  if (used <= 0.0) return 0.0;
  return allowed > 0.0 ? used / allowed : unlimited;
}

namespace {

/// Speeds and taps of one axis during one event. The start is a blend from rest, the stop a blend to rest. So all three
/// are v = in (1 - B_k) + out B_{k-d}, with in or out zero.
struct AxisEvent {
  Event event;
  double in, out;  ///< axis components of the two leg velocities, m/s
  int delay;
};

void require_period(double sample_period) {
  if (!(sample_period > 0.0) || !std::isfinite(sample_period)) {
    throw std::invalid_argument(fmt::format("sample period must be positive and finite, got {} s", sample_period));
  }
}

/// Keeps the worst use of a limit over the samples seen.
class Worst {
 public:
  Worst(LimitKind kind, double bound) : use_{} {
    use_.kind = kind;
    use_.bound = bound;
  }
  bool wanted() const { return use_.bound < unlimited; }
  void offer(double value, Event event, int sample) {
    if (seen_ && !(value > use_.value)) return;
    seen_ = true;
    use_.value = value;
    use_.event = event;
    use_.sample = sample;
  }
  LimitUse finish(const std::string& axis, const std::string& corner) {
    use_.axis = axis;
    use_.corner = corner;
    use_.value = std::max(use_.value, 0.0);
    use_.utilisation = utilisation_of(use_.kind, use_.value, use_.bound);
    return use_;
  }

 private:
  LimitUse use_;
  bool seen_ = false;
};

/// Uses of the shared supply. @param power  W, by event and sample  @param first  k of a blend's first sample
void supply_uses(const std::array<std::vector<double>, 3>& power, int first, const Machine& machine,
                 const std::string& corner, std::vector<LimitUse>& uses) {
  Worst motoring(LimitKind::power_total, machine.power_total_max);
  Worst braking(LimitKind::regeneration_total, machine.regeneration_total_max);
  for (const Event event : {Event::start, Event::blend, Event::stop}) {
    const std::vector<double>& values = power[static_cast<std::size_t>(event)];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int k = static_cast<int>(i) + (event == Event::blend ? first : 0);
      motoring.offer(values[i], event, k);
      braking.offer(-values[i], event, k);
    }
  }
  for (Worst* worst : {&motoring, &braking}) {
    if (worst->wanted()) uses.push_back(worst->finish("", corner));
  }
}

}  // namespace

bool has_dry_friction(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) { return axis.coulomb > 0.0; });
}

void require_no_shared_loads(const Machine& machine, const char* what) {
  const char* key = machine.power_total_max < unlimited          ? "power_total_max_W"
                    : machine.regeneration_total_max < unlimited ? "regeneration_total_max_W"
                    : has_dry_friction(machine)                  ? "coulomb_N"
                                                                 : nullptr;
  if (key == nullptr) return;
  throw std::invalid_argument(fmt::format(
      "{} does not consider `{}`; leave it out, or use `accdec evaluate`, `accdec design`, `accdec explain` or `accdec "
      "verify`, which do",
      what, key));
}

std::vector<LimitUse> axis_utilisation(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                       const Machine& machine, const std::string& corner_name) {
  if (corner.axes() != static_cast<Eigen::Index>(machine.axes.size())) {
    throw std::invalid_argument(fmt::format("corner has {} axes, the machine {}", corner.axes(), machine.axes.size()));
  }
  require_period(sample_period);
  std::vector<LimitUse> uses;
  const double still = still_part * std::max(corner.feed_in, corner.feed_out);
  std::array<std::vector<double>, 3> power;  // of all axes together, by event and sample
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    std::vector<Worst> worst;
    for (const AxisLimit& limit : axis_limits) worst.emplace_back(limit.kind, axis.*limit.bound);
    const auto index = static_cast<Eigen::Index>(a);
    const double in = corner.feed_in * corner.direction_in[index], out = corner.feed_out * corner.direction_out[index];
    for (const AxisEvent& e : {AxisEvent{Event::start, 0.0, in, 0}, AxisEvent{Event::blend, in, out, delay},
                               AxisEvent{Event::stop, out, 0.0, 0}}) {
      AxisSampler sampler(axis, sample_period, still);
      const int last = filter.order() + settling + (e.event == Event::blend ? std::max(e.delay, 0) : 0);
      std::vector<double>& together = power[static_cast<std::size_t>(e.event)];
      together.resize(static_cast<std::size_t>(last - std::min(0, e.delay)) + 1, 0.0);
      for (int k = std::min(0, e.delay); k <= last; ++k) {
        const double v = e.in * filter.remaining(k) + e.out * filter.cumulative(k - e.delay);
        const double acc = (e.out * filter.tap(k - 1 - e.delay) - e.in * filter.tap(k - 1)) / sample_period;
        const AxisState state = sampler.next(v, acc);
        for (std::size_t i = 0; i < axis_limits.size(); ++i) worst[i].offer(axis_limits[i].value(state), e.event, k);
        together[static_cast<std::size_t>(k - std::min(0, e.delay))] += state.motoring;
      }
    }
    for (Worst& w : worst) {
      if (w.wanted()) uses.push_back(w.finish(axis.name, corner_name));
    }
  }
  supply_uses(power, std::min(0, delay), machine, corner_name, uses);
  return uses;
}

double residual_vibration(const Filter& filter, double frequency, double sample_period) {
  const double w = 2.0 * std::numbers::pi * frequency * sample_period;
  double c = 0.0, s = 0.0;
  const auto taps = filter.taps();
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

}  // namespace

std::vector<LimitUse> vibration_utilisation(const Filter& filter, double sample_period, const Machine& machine,
                                            const std::function<bool()>& stop) {
  require_period(sample_period);
  std::vector<LimitUse> uses;
  for (const Mode& mode : machine.modes) {
    if (!(mode.frequency_low > 0.0 && mode.frequency_high >= mode.frequency_low &&
          std::isfinite(mode.frequency_high))) {
      throw std::invalid_argument(fmt::format("mode needs 0 < frequency_low <= frequency_high, got {} to {} Hz",
                                              mode.frequency_low, mode.frequency_high));
    }
    const double best_f = worst_frequency(filter, mode, sample_period, stop);
    LimitUse use;
    use.kind = LimitKind::vibration;
    use.frequency = best_f;
    use.value = residual_vibration(filter, best_f, sample_period);
    use.bound = mode.residual_max;
    use.utilisation = utilisation_of(use.kind, use.value, mode.residual_max);
    uses.push_back(use);
  }
  return uses;
}

}  // namespace accdec
