#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <accdec/bounds/filter_bound.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// The smallest sum i b_i for a mass m in taps of at most `tap` at i = 1, 2, .. It is convex and increasing in m.
double moment(double m, double tap) {
  if (m <= 0.0) return 0.0;
  const double whole = std::floor(m / tap);
  return tap * 0.5 * whole * (whole + 1.0) + (m - whole * tap) * (whole + 1.0);
}

/// The largest m <= 1 with moment(m) <= p.
double mass(double p, double tap) {
  // tap n (n + 1)/2 <= p, rounded to the side of a larger mass.
  double n = std::max(0.0, std::floor(std::sqrt(0.25 + 2.0 * p / tap) - 0.5));
  if (tap * 0.5 * n * (n + 1.0) > p && n > 0.0) n -= 1.0;
  return std::min(1.0, n * tap + (p - tap * 0.5 * n * (n + 1.0)) / (n + 1.0));
}

/// Least p' - p for a p, 0 <= p.
double lead(double p, double tap) {
  return moment(1.0 - tap - mass(p, tap), tap) - p;
}

/// Largest tap that starts block b within the acceleration limits. If other chords move with it, any tap may.
double largest_tap(const Toolpath& path, std::size_t b, const Machine& machine, double sample_period) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double tap = 1.0;
  if (is_chord(path, b)) return tap;
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const double speed = std::abs(p[n + a] - p[a]) / path.duration[b];
    if (speed > 0.0)
      tap = std::min(tap, machine.axes[a].acceleration_max * (1.0 + verification_tolerance) * sample_period / speed);
  }
  return tap;
}

}  // namespace

double least_separation(double step_in, double step_out, double tap_in, double tap_out, double cos_interior,
                        double error) {
  constexpr double enough = 1e-3;
  // On the ellipse (P, Q) = r (cos, sin), r^2 (1 + sin(2 angle) cos_interior) = error^2.
  const auto radius = [&](double sine) { return error / std::sqrt(std::max(1e-12, 1.0 + sine * cos_interior)); };
  const auto value = [&](double in, double out) { return lead(in / step_in, tap_in) + lead(out / step_out, tap_out); };
  struct Arc {
    double from, to, bound;
  };
  double best = value(0.0, 0.0);  // of a point, so from above
  const auto arc = [&](double from, double to) {
    const double s0 = std::sin(2.0 * from), s1 = std::sin(2.0 * to), quarter = std::numbers::pi / 4.0;
    const double most = from <= quarter && quarter <= to ? 1.0 : std::max(s0, s1);
    const double middle = 0.5 * (from + to), r = radius(std::sin(2.0 * middle));
    best = std::min(best, value(r * std::cos(middle), r * std::sin(middle)));
    const double largest = radius(cos_interior >= 0.0 ? std::min(s0, s1) : most);
    return Arc{from, to, value(largest * std::cos(from), largest * std::sin(to))};
  };
  std::vector<Arc> open, next;
  constexpr int arcs = 16;
  constexpr double width = std::numbers::pi / 2.0 / arcs;
  for (int i = 0; i < arcs; ++i) open.push_back(arc(i * width, (i + 1) * width));
  for (int depth = 0; depth < 40; ++depth) {
    next.clear();
    for (const Arc& a : open) {
      if (a.bound >= best - enough) continue;
      const double middle = 0.5 * (a.from + a.to);
      next.push_back(arc(a.from, middle));
      next.push_back(arc(middle, a.to));
    }
    std::swap(open, next);
    if (open.empty()) return best - enough;
  }
  double least = best - enough;
  for (const Arc& a : open) least = std::min(least, a.bound);
  return least;
}

std::optional<double> filter_lower_bound(const Toolpath& path, const Machine& task_machine, double sample_period) {
  const Machine machine = program_machine(task_machine, path);
  const std::size_t blocks = path.blocks(), n = path.dimensions();
  if (blocks == 0) return 0.0;
  const std::vector<int> none(blocks, 0);
  for (std::size_t b = 0; b < blocks; ++b) {
    const double taps = 1.0 / largest_tap(path, b, machine, sample_period);
    if (taps > path.duration[b] / sample_period * (1.0 + 1e-9) + 1.0) return std::nullopt;
  }
  const CommandTiming timing(path, sample_period, none);
  const double first_tap = largest_tap(path, 0, machine, sample_period),
               last_tap = largest_tap(path, blocks - 1, machine, sample_period);
  const auto command = static_cast<double>(timing.command_samples());  // delays only add runs, each rounded up
  double samples = command + moment(1.0 - first_tap, first_tap) + moment(1.0 - last_tap, last_tap) + 1.0;
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    const bool bounded = path.joint[b] == Joint::stop || path.tolerance[b] < unlimited;
    if (!ends_leg(path, b) || path.inside_arc[b] != 0 || !bounded) continue;
    const double *p = path.point(b), *q = p + n, *r = q + n;
    double in2 = 0.0, out2 = 0.0, dot = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
      in2 += (q[a] - p[a]) * (q[a] - p[a]);
      out2 += (r[a] - q[a]) * (r[a] - q[a]);
      dot += (q[a] - p[a]) * (r[a] - q[a]);
    }
    const double in = std::sqrt(in2), out = std::sqrt(out2);
    const double tolerance = path.joint[b] == Joint::stop ? 0.0 : path.tolerance[b] + path.narrowed;
    samples += least_separation(
        in / path.duration[b] * sample_period, out / path.duration[b + 1] * sample_period,
        largest_tap(path, b, machine, sample_period), largest_tap(path, b + 1, machine, sample_period),
        std::clamp(-dot / (in * out), -1.0, 1.0), tolerance * (1.0 + verification_tolerance) + position_floor);
  }
  return std::max(samples, command + std::ceil(1.0 / last_tap - 1e-9)) * sample_period;
}

}  // namespace accdec
