#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/task/verified_vibration.hpp>

namespace accdec {
namespace {

constexpr std::size_t gaps_kept = 1000;  // samples between hits

/// The worst place of a mode, by grids of frequencies and damping ratios. It does not use that the worst is on the
/// edge.
template <class Left>
class Scan {
 public:
  /// @param left_at  what is left at a frequency and a damping ratio  @param hits  samples on which it depends
  Scan(Left left_at, const Mode& mode, double period, std::size_t hits) : left_at_(std::move(left_at)), mode_(mode) {
    use_.kind = mode.of_axis() ? LimitKind::residual : LimitKind::vibration;
    use_.bound = mode.of_axis() ? mode.displacement_max : mode.residual_max;
    use_.frequency = mode.frequency_low, use_.damping = mode.damping_low;
    // The response is band-limited to N T, or to the time in which a mode dies away. Grid points are a sixteenth of its
    // shortest ripple apart. So a parabola through three of them locates a peak precisely enough that the amplitude
    // does not change.
    const double died = 30.0 / (2.0 * std::numbers::pi * mode.frequency_low * std::max(mode.damping_low, 1e-12));
    const double taps = std::min(period * static_cast<double>(hits), died);
    const double band = mode.frequency_high - mode.frequency_low, ratios = mode.damping_high - mode.damping_low;
    const int cells = band > 0.0 ? 16 + static_cast<int>(16.0 * band * taps) : 0;
    const int lines = ratios > 0.0 ? 4 : 0;
    for (int i = 0; i <= lines; ++i) {
      const double z = i == lines ? mode.damping_high : mode.damping_low + ratios * i / lines;
      line(cells, mode.frequency_low, mode.frequency_high, [&](double f) { return left(f, z); });
    }
    if (lines == 0) return;
    const int steps = 16 + static_cast<int>(16.0 * 2.0 * std::numbers::pi * mode.frequency_high * ratios * taps);
    for (const double f : {mode.frequency_low, use_.frequency, mode.frequency_high})
      line(steps, mode.damping_low, mode.damping_high, [&](double z) { return left(f, z); });
  }
  const LimitUse& use() const { return use_; }

 private:
  /// Also beside the mode's ranges, where it does not count.
  double left(double frequency, double damping) {
    const double r = left_at_(frequency, damping);
    const bool counts = frequency >= mode_.frequency_low && frequency <= mode_.frequency_high &&
                        damping >= mode_.damping_low && damping <= mode_.damping_high;
    if (counts && r > use_.value) use_.value = r, use_.frequency = frequency, use_.damping = damping;
    return r;
  }

  template <class At>
  void line(int cells, double low, double high, const At& at) {
    if (cells == 0) {
      at(low);
      return;
    }
    const double h = (high - low) / cells;
    std::vector<double> r;
    for (int i = 0; i <= cells; ++i) r.push_back(at(i == cells ? high : low + h * i));
    for (int i = 0; i <= cells; ++i) {
      const auto u = static_cast<std::size_t>(i);
      // The peak of the first or last cell may be nearer to the end than to the next point.
      if ((i > 0 && r[u] < r[u - 1]) || (i < cells && r[u] < r[u + 1])) continue;
      double centre = low + h * i, step = h;
      for (int refine = 0; refine < 12; ++refine) {
        const double before = at(centre - step), here = at(centre), after = at(centre + step);
        const double curvature = before - 2.0 * here + after;
        if (curvature < 0.0) centre += std::clamp(0.5 * step * (before - after) / curvature, -step, step);
        step *= 0.25;
      }
      at(std::clamp(centre, low, high));
    }
  }

  Left left_at_;
  const Mode& mode_;
  LimitUse use_{};
};

/// x'' + 2 z w x' + w^2 x = 0 between hits, solved exactly; a hit changes x' at once.
class Oscillator {
 public:
  struct State {
    double x = 0.0, u = 0.0;  // u is x' over the frequency of the damped vibration
  };

  Oscillator(double frequency, double damping, double period) {
    const double w = 2.0 * std::numbers::pi * frequency;
    damped_ = w * std::sqrt((1.0 - damping) * (1.0 + damping));
    k_ = damping * w / damped_;
    const double fall = std::exp(-damping * w * period);
    c_ = fall * std::cos(damped_ * period), s_ = fall * std::sin(damped_ * period);
  }
  double damped() const { return damped_; }
  State after_sample(const State& at) const {
    return {(c_ + k_ * s_) * at.x + s_ * at.u, (c_ - k_ * s_) * at.u - (1.0 + k_ * k_) * s_ * at.x};
  }
  double amplitude(const State& at) const { return std::hypot(at.x, at.u + k_ * at.x); }

 private:
  double damped_, k_, c_, s_;
};

}  // namespace

double amplitude_left(std::span<const double> hits, double frequency, double damping, double period) {
  const Oscillator swing(frequency, damping, period);
  Oscillator::State at;
  for (const double b : hits) {
    at = swing.after_sample(at);
    at.u += b;
  }
  return swing.amplitude(at);
}

LimitUse verified_vibration(const Filter& filter, const Mode& mode, double period) {
  const auto left = [&](double f, double z) { return amplitude_left(filter.taps(), f, z, period); };
  LimitUse use = Scan(left, mode, period, filter.taps().size()).use();
  use.utilisation = utilisation_of(use.kind, use.value, use.bound);
  // A residual bound of 0 holds if the residual is 0 up to rounding.
  if (use.bound == 0.0 && use.value < 1e-12) use.utilisation = 0.0;
  return use;
}

std::vector<double> velocity_changes(const SampledMotion& motion, Event event, std::size_t axis, int order, int delay,
                                     const Corner& legs) {
  const auto a = static_cast<Eigen::Index>(axis);
  const bool later = event == Event::blend && legs.direction_out[a] != 0.0;
  const int zero = event == Event::start ? motion.start : event == Event::blend ? motion.corner : motion.stop;
  std::vector<double> changes;
  for (int k = 1; k <= order + 1 + (later ? delay : 0); ++k)
    changes.push_back(motion.velocity(zero + k, a) - motion.velocity(zero + k - 1, a));
  return changes;
}

double displacement_left(std::span<const double> changes, double frequency, double damping, double period) {
  const double damped = 2.0 * std::numbers::pi * frequency * std::sqrt((1.0 - damping) * (1.0 + damping));
  return amplitude_left(changes, frequency, damping, period) / damped;
}

LimitUse verified_residual(std::span<const double> changes, const Mode& mode, double period) {
  const auto left = [&](double f, double z) { return displacement_left(changes, f, z, period); };
  return Scan(left, mode, period, changes.size()).use();
}

std::vector<double> displacements_left(const RawChanges& changes, const Filter& filter, double frequency,
                                       double damping, double period) {
  const Oscillator swing(frequency, damping, period);
  // Each tap repeats what the hits did, so many samples later. When the last tap's share is at the end of the hits,
  // that of tap i has swung N - i samples longer.
  Oscillator::State of_x{}, of_u{};  // what the filter makes of a unit of x, of u
  for (const double b : filter.taps()) {
    of_x = swing.after_sample(of_x), of_u = swing.after_sample(of_u);
    of_x.x += b, of_u.u += b;
  }
  std::vector<double> all;
  Oscillator::State at{};
  std::size_t next = 0;
  std::vector<std::optional<Oscillator>> over;  // gaps, by samples
  for (std::size_t k = 0; k < changes.hits.size() && next < changes.judged.size(); ++k) {
    const auto gap = static_cast<std::size_t>(k == 0 ? 0 : changes.hits[k].first - changes.hits[k - 1].first);
    const auto through = [&] { return Oscillator(frequency, damping, period * static_cast<double>(gap)); };
    if (gap < gaps_kept) {
      over.resize(std::max(over.size(), gap + 1));
      if (!over[gap]) over[gap] = through();
      at = over[gap]->after_sample(at);
    } else {
      at = through().after_sample(at);
    }
    at.u += changes.hits[k].second;
    if (changes.judged[next] != k) continue;
    ++next;
    all.push_back(swing.amplitude({at.x * of_x.x + at.u * of_u.x, at.x * of_x.u + at.u * of_u.u}) / swing.damped());
  }
  return all;
}

LimitUse verified_residual(const RawChanges& changes, const Filter& filter, const Mode& mode, double period) {
  const auto left = [&](double f, double z) {
    const std::vector<double> swings = displacements_left(changes, filter, f, z, period);
    return *std::ranges::max_element(swings);
  };
  const auto samples = static_cast<std::size_t>(changes.hits.back().first - changes.hits.front().first);
  return Scan(left, mode, period, samples + filter.taps().size()).use();
}

LimitUse verified_residual(const SampledMotion& command, const Mode& mode, const Machine& machine,
                           const TaskCorner& corner, int order, int delay, double period) {
  LimitUse worst;
  for (const Event event : {Event::start, Event::blend, Event::stop}) {
    const std::vector<double> changes =
        velocity_changes(command, event, static_cast<std::size_t>(mode.axis), order, delay, corner.geometry());
    LimitUse use = verified_residual(changes, mode, period);
    use.event = event;
    use.sample = static_cast<std::int64_t>(changes.size());
    // Among events that differ only by rounding, readers expect the first.
    if (event == Event::start || use.value > worst.value * (1.0 + 1e-12)) worst = use;
  }
  worst.axis = machine.axes[static_cast<std::size_t>(mode.axis)].name;
  worst.corner = corner.name;
  worst.utilisation = utilisation_of(worst.kind, worst.value, worst.bound);
  return worst;
}

}  // namespace accdec
