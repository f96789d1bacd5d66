#include <accdec/machine/utilisation.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

namespace accdec {

std::string_view to_string(LimitKind kind) {
  switch (kind) {
    case LimitKind::velocity: return "velocity";
    case LimitKind::acceleration: return "acceleration";
    case LimitKind::jerk: return "jerk";
    case LimitKind::force: return "force";
    case LimitKind::power: return "power";
    case LimitKind::regeneration: return "regeneration";
    case LimitKind::vibration: return "vibration";
    case LimitKind::corner_error: return "corner_error";
    case LimitKind::speed_min: return "speed_min";
  }
  return "?";
}

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

/// Speeds and taps of one axis during one event. The start is a blend out of rest, the stop a blend into rest, so all three
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

/// Keeps the worst of a limit as samples come in.
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

}  // namespace

std::vector<LimitUse> axis_utilisation(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                       const Machine& machine, const std::string& corner_name) {
  if (corner.axes() != static_cast<Eigen::Index>(machine.axes.size())) {
    throw std::invalid_argument(
        fmt::format("corner has {} axes, the machine {}", corner.axes(), machine.axes.size()));
  }
  require_period(sample_period);
  std::vector<LimitUse> uses;
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    Worst velocity(LimitKind::velocity, axis.velocity_max), acceleration(LimitKind::acceleration, axis.acceleration_max),
        jerk(LimitKind::jerk, axis.jerk_max), force(LimitKind::force, axis.force_max),
        power(LimitKind::power, axis.power_max), regeneration(LimitKind::regeneration, axis.regeneration_max);
    const auto index = static_cast<Eigen::Index>(a);
    const double in = corner.feed_in * corner.direction_in[index], out = corner.feed_out * corner.direction_out[index];
    for (const AxisEvent& e : {AxisEvent{Event::start, 0.0, in, 0}, AxisEvent{Event::blend, in, out, delay},
                               AxisEvent{Event::stop, out, 0.0, 0}}) {
      double previous = 0.0;
      const int last = filter.order() + 2 + (e.event == Event::blend ? std::max(e.delay, 0) : 0);
      for (int k = std::min(0, e.delay); k <= last; ++k) {
        const double v = e.in * filter.remaining(k) + e.out * filter.cumulative(k - e.delay);
        const double acc = (e.out * filter.tap(k - 1 - e.delay) - e.in * filter.tap(k - 1)) / sample_period;
        const double f = axis.mass * acc + axis.damping * v;
        velocity.offer(std::abs(v), e.event, k);
        acceleration.offer(std::abs(acc), e.event, k);
        jerk.offer(std::abs(acc - previous) / sample_period, e.event, k);
        force.offer(std::abs(f), e.event, k);
        power.offer(f * v, e.event, k);
        regeneration.offer(-f * v, e.event, k);
        previous = acc;
      }
    }
    for (Worst* worst : {&velocity, &acceleration, &jerk, &force, &power, &regeneration}) {
      if (worst->wanted()) uses.push_back(worst->finish(axis.name, corner_name));
    }
  }
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

/// |H|^2 and its derivative with respect to f, up to a positive factor, by Horner's rule on H and dH/dz.
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

}  // namespace

std::vector<LimitUse> vibration_utilisation(const Filter& filter, double sample_period, const Machine& machine) {
  require_period(sample_period);
  std::vector<LimitUse> uses;
  for (const Mode& mode : machine.modes) {
    if (!(mode.frequency_low > 0.0 && mode.frequency_high >= mode.frequency_low && std::isfinite(mode.frequency_high))) {
      throw std::invalid_argument(fmt::format("mode needs 0 < frequency_low <= frequency_high, got {} to {} Hz",
                                              mode.frequency_low, mode.frequency_high));
    }
    const auto at = [&](double f) { return response(filter, f, sample_period); };
    // |H|^2 is a trigonometric polynomial of degree N: 8 points to its shortest period 1/(N T) separate the maxima.
    const double width = mode.frequency_high - mode.frequency_low;
    const int cells = std::max(1, static_cast<int>(std::ceil(8.0 * width * sample_period * (filter.order() + 1))));
    const auto grid = [&](int i) { return mode.frequency_low + width * std::min(1.0, static_cast<double>(i) / cells); };
    std::vector<Response> points(static_cast<std::size_t>(cells) + 1);
    double best_f = grid(0), best = -1.0;
    const auto consider = [&](double f, const Response& r) {
      if (r.square > best) best = r.square, best_f = f;
    };
    for (int i = 0; i <= cells; ++i) consider(grid(i), points[static_cast<std::size_t>(i)] = at(grid(i)));
    const double worth = 0.5 * best;  // a maximum between grid points rises far less than that above the nearer of them
    for (int i = 0; i < cells; ++i) {
      const Response &left = points[static_cast<std::size_t>(i)], &right = points[static_cast<std::size_t>(i) + 1];
      if (!(left.slope > 0.0 && right.slope < 0.0) || std::max(left.square, right.square) < worth) continue;
      double low = grid(i), high = grid(i + 1);
      for (int step = 0; step < 40 && high - low > 1e-9 * (grid(i + 1) - grid(i)); ++step) {
        const double f = 0.5 * (low + high);
        const Response r = at(f);
        consider(f, r);
        (r.slope > 0.0 ? low : high) = f;
      }
    }
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
