#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <accdec/families/quick_refusals.hpp>
#include <accdec/filter.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

using std::numbers::pi;

constexpr double slack = 1.0 + granted_tolerance;

/// |H| of the impulses of a filter at `phase` rad a sample.
double impulse_response(double phase, const FilterSpec& spec) {
  if (spec.whole_pairs()) return std::abs(1.0 - 2.0 * spec.outer * (1.0 - std::cos(phase * spec.pair_delay)));
  const double end = spec.pairs == 1 ? 0.5 : spec.outer;
  std::complex<double> sum = end;
  for (int m = 1; m <= spec.pairs; ++m) {
    const double at = m * spec.pair_delay, first = std::floor(at + shaper_snap), later = std::max(0.0, at - first);
    const double weight = m == spec.pairs ? end : 1.0 - 2.0 * end;
    sum += weight * ((1.0 - later) * std::polar(1.0, -phase * first) + later * std::polar(1.0, -phase * (first + 1.0)));
  }
  return std::abs(sum);
}

/// The weight of all impulses whose steps between taps add up, over that of the first. Behind the two longest averages,
/// a step lasts as long as the second one. The third one takes its own length from that.
double impulses_together(std::span<const int> lengths, const FilterSpec& spec) {
  if (spec.pairs == 0 || lengths.size() < 2) return 1.0;
  const double lasts = lengths[1] - (lengths.size() == 3 ? lengths[2] : 1), outer = spec.pairs == 1 ? 0.5 : spec.outer;
  double sum = outer;
  for (int m = 1; m <= spec.pairs && std::ceil(m * spec.pair_delay - shaper_snap) <= lasts; ++m)
    sum += m == spec.pairs ? outer : 1.0 - 2.0 * outer;
  return sum / outer;
}

/// Tones kept, those that filters rang at first.
constexpr std::size_t most_tones = 100;

}  // namespace

QuickRefusals::QuickRefusals(const Task& on_taps, std::vector<double> smoothing, const Task& behind)
    : on_taps_(on_taps),
      bounds_(tap_bounds(granted_limits(on_taps))),
      smoothing_(std::move(smoothing)),
      bounds_behind_(tap_bounds(granted_limits(behind))) {
  const double period = on_taps.sample_period;
  for (const TaskCorner& corner : on_taps_.corners) {
    const Corner& g = corner.geometry();
    for (std::size_t a = 0; a < on_taps_.machine.axes.size(); ++a) {
      const auto e = static_cast<Eigen::Index>(a);
      const double in = std::abs(g.feed_in * g.direction_in[e]), out = std::abs(g.feed_out * g.direction_out[e]);
      if (std::max(in, out) > 0.0) speeds_.push_back({&on_taps_.machine.axes[a], in, out});
    }
  }
  const Filter alone(smoothing_);
  for (const Mode& mode : behind.machine.modes) {
    if (!mode.undamped()) continue;
    for (const double f : {mode.frequency_low, 0.5 * (mode.frequency_low + mode.frequency_high), mode.frequency_high}) {
      // The smoothing leaves a part of it.
      const double left = std::max(1e-12, residual_vibration(alone, f, period));
      tones_.push_back(
          {2.0 * pi * f * period, smoothing_.size() == 1 ? mode.residual_max : (mode.residual_max + 1e-12) / left});
    }
  }
}

bool QuickRefusals::refuses(std::span<const int> lengths, const FilterSpec& spec) {
  const double copies = static_cast<double>(1 << spec.pairs);
  double first = spec.pairs == 2 ? spec.outer : 1.0 / copies, rest = 0.0;
  for (const int length : lengths) rest += length - 1;
  rest -= lengths.front() - 1;
  for (const int length : lengths.size() == 3 ? lengths.first(2) : lengths) first /= length;
  // An impulse between two samples is on both of them.
  if (!spec.whole_pairs()) ++rest;
  if (first * impulses_together(lengths, spec) > bounds_.step) return true;
  if (first > bounds_behind_.step && step_stays(lengths, spec)) return true;
  // The longest average has a plateau if it is longer than the others together. With copies, no tap there is below its
  // share of the largest.
  const double largest =
      (spec.pairs == 2 ? std::max(spec.outer, 1.0 - 2.0 * spec.outer) : 1.0 / copies) / lengths.front();
  if (lengths.front() > rest && largest > bounds_.most) return true;
  if (lengths.front() > rest + static_cast<double>(smoothing_.size() - 1) && largest > bounds_behind_.most) return true;
  return rings(lengths, spec);
}

bool QuickRefusals::step_stays(std::span<const int> lengths, const FilterSpec& spec) const {
  if (lengths.size() < 2) return smoothing_.size() == 1;
  const int begins = lengths.size() == 3 ? lengths[2] : 0;
  const double ends = std::min<double>(lengths[1], spec.pairs > 0 ? std::floor(spec.pair_delay) : unlimited);
  return ends - begins >= static_cast<double>(smoothing_.size());
}

bool QuickRefusals::refuses_first_taps(const FilterSpec& spec) const {
  if (spec.kind != Shape::exponential || spec.pairs > 0 || !(spec.ratio > 0.0 && spec.ratio < 1.0)) return false;
  constexpr double looser = 1.0 - 1e-9;  // than rounding
  const double fall = std::log(spec.ratio), first = std::expm1(fall) / std::expm1(fall * (spec.order + 1));
  if (looser * first > std::min(bounds_.most, bounds_.step)) return true;
  const int last = std::min(spec.order, static_cast<int>(smoothing_.size()) - 1);
  double tap = 0.0;
  for (int k = 0; k <= last; ++k) {
    const double before = tap;
    tap = spec.ratio * tap + first * smoothing_[static_cast<std::size_t>(k)];
    if (looser * tap > bounds_behind_.most || looser * (tap - before) > bounds_behind_.step) return true;
  }
  return false;
}

bool QuickRefusals::refused_behind(std::span<const double> taps, double sum) {
  constexpr double looser = 1.0 - 1e-9;  // than rounding
  const double most = bounds_behind_.most * sum / looser, step = bounds_behind_.step * sum / looser;
  if (smoothing_.size() == 1 || !(std::min(most, step) < unlimited)) return false;
  behind_.assign(taps.size() + smoothing_.size(), 0.0);  // 0 behind the last one
  for (std::size_t j = 0; j < smoothing_.size(); ++j) {
    for (std::size_t i = 0; i < taps.size(); ++i) behind_[i + j] += smoothing_[j] * taps[i];
  }
  double before = 0.0;
  for (const double tap : behind_) {
    if (tap > most || std::abs(tap - before) > step) return true;
    before = tap;
  }
  return false;
}

bool QuickRefusals::rings(std::span<const int> lengths, const FilterSpec& spec) {
  const int delay = static_cast<int>(spec.pair_delay);
  const std::array<int, 2> delays{delay, delay};
  const auto pairs = std::span(delays).first(static_cast<std::size_t>(spec.pairs));
  const bool equal = spec.whole_pairs() && (spec.pairs < 2 || spec.outer == zvd_outer);
  for (Tone& tone : tones_) {
    const double left = equal ? cascade_response(tone.phase, lengths, pairs)
                              : cascade_response(tone.phase, lengths, {}) * impulse_response(tone.phase, spec);
    if (left <= tone.residual_max * slack + 1e-12) continue;
    std::swap(tone, tones_.front());
    return true;
  }
  return false;
}

bool QuickRefusals::start_holds(const LegSpeeds& speeds, double tap, double gone) const {
  const Axis& axis = *speeds.axis;
  const double v = speeds.start * gone,
               force = axis.mass * speeds.start * tap / on_taps_.sample_period + axis.damping * v + axis.coulomb;
  return force <= axis.force_max * slack && force * v <= axis.power_max * slack;
}

bool QuickRefusals::stop_holds(const LegSpeeds& speeds, double tap, double left) const {
  const Axis& axis = *speeds.axis;
  const double v = speeds.stop * left,
               braking = axis.mass * speeds.stop * tap / on_taps_.sample_period - axis.damping * v - axis.coulomb;
  return braking * v <= axis.regeneration_max * slack;
}

bool QuickRefusals::starts(std::span<const double> taps, double sum) {
  if (*std::max_element(taps.begin(), taps.end()) > bounds_.most * sum || taps.front() > bounds_.step * sum)
    return false;
  if (refused_behind(taps, sum)) return false;
  const int last = static_cast<int>(taps.size()) - 1;
  for (const LegSpeeds& speeds : speeds_) {
    const Axis& axis = *speeds.axis;
    if (axis.force_max < unlimited || axis.power_max < unlimited) {
      double gone = 0.0;
      for (int k = 0; k <= last; ++k) {
        const double b = taps[static_cast<std::size_t>(k)];
        gone += b;
        if (!start_holds(speeds, b / sum, gone / sum)) return failed_start_ = {&speeds, k}, false;
      }
    }
    if (axis.regeneration_max < unlimited) {
      double left = sum;
      for (int k = 0; k <= last; ++k) {
        const double b = taps[static_cast<std::size_t>(k)];
        left -= b;
        if (!stop_holds(speeds, b / sum, left / sum)) return failed_stop_ = {&speeds, k}, false;
      }
    }
  }
  return true;
}

bool QuickRefusals::fails_likewise(const Cascade& cascade) const {
  constexpr double looser = 1.0 - 1e-8;  // than rounding
  if (const auto& [speeds, k] = failed_start_;
      speeds != nullptr && !start_holds(*speeds, looser * cascade.tap(k), looser * cascade.gone(k)))
    return true;
  const auto& [speeds, k] = failed_stop_;
  return speeds != nullptr && !stop_holds(*speeds, looser * cascade.tap(k), 1.0 - cascade.gone(k));
}

bool QuickRefusals::refuses(const Filter& filter, const std::function<bool()>& late) {
  if (*std::max_element(filter.taps().begin(), filter.taps().end()) > bounds_.most) return true;
  if (refused_behind(filter.taps(), 1.0)) return true;
  for (const LimitUse& use : vibration_utilisation(filter, on_taps_.sample_period, on_taps_.machine, late)) {
    if (use.utilisation <= slack) continue;
    // Tones are undamped. If the vibration dies away, other filters may leave less of it.
    if (use.damping > 0.0) return true;
    // The next filters that ring there are refused at once, and so are ranges of them.
    const double phase = 2.0 * pi * use.frequency * on_taps_.sample_period;
    const bool known =
        std::any_of(tones_.begin(), tones_.end(), [=](const Tone& t) { return std::abs(t.phase - phase) < 1e-9; });
    if (!known && tones_.size() < most_tones) tones_.push_back({phase, use.bound});
    return true;
  }
  return false;
}

}  // namespace accdec
