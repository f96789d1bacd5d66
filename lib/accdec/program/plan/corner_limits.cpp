#include <algorithm>
#include <cmath>

#include <accdec/program/plan/corner_limits.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {
constexpr double slack = 1.0 + 0.5 * verification_tolerance;  // leaves room for the rounding of the simulation
}

CornerLimits::CornerLimits(const LegFilters& filters, const Machine& machine, double sample_period)
    : filters_(filters), machine_(machine), period_(sample_period) {
  for (const Filter& filter : filters.filters()) {
    Peaks& peaks = peaks_.emplace_back();
    for (int i = 0; i <= filter.order() + 1; ++i) {
      peaks.tap = std::max(peaks.tap, filter.tap(i));
      peaks.step = std::max(peaks.step, std::abs(filter.tap(i) - filter.tap(i - 1)));
    }
  }
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    if (limited(machine.axes[a])) limited_.push_back(a);
  }
}

double CornerLimits::start_factor(std::size_t f, const double* velocity, Binding* binding) const {
  const Peaks& peaks = peaks_[f];
  double factor = 1.0;
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v = std::abs(velocity[a]), acceleration = v * peaks.tap / period_;
    if (v == 0.0) continue;
    AxisState peak = axis_state(axis, v, acceleration, v * peaks.step / (period_ * period_));
    peak.braking = peak.motoring;  // a stop brakes as a start drives
    for (const AxisLimit& limit : axis_limits) {
      const double value = limit.value(peak);
      if (!(value > 0.0)) continue;
      const double allowed = limit.degree == 2 ? std::sqrt(axis.*limit.bound / value) : axis.*limit.bound / value;
      if (allowed >= factor) continue;
      factor = allowed;
      if (binding != nullptr) *binding = {limit.kind, a};
    }
  }
  return factor;
}

bool CornerLimits::any_delay_holds(std::size_t f_in, std::size_t f_out, const double* in, const double* out,
                                   int from) const {
  const Peaks &p1 = peaks_[f_in], &p2 = peaks_[f_out];
  const bool same = f_in == f_out, merge = same && from == 0;  // without delay the steps of one filter merge
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v1 = std::abs(in[a]), v2 = std::abs(out[a]), change = std::abs(out[a] - in[a]);
    const bool reverses = in[a] * out[a] < 0.0;
    // A shorter filter may bring leg 2 to speed before leg 1 has lost its own.
    const double v = same || reverses ? std::max(v1, v2) : v1 + v2;
    // The steps of both legs add where they point apart.
    const double apart = reverses ? v1 * p1.tap + v2 * p2.tap : std::max(v1 * p1.tap, v2 * p2.tap);
    const double acceleration = (merge ? change * p1.tap : apart) / period_;
    const double jerk = (merge ? change * p1.step : v1 * p1.step + v2 * p2.step) / (period_ * period_);
    AxisState peak = axis_state(axis, v, acceleration, jerk);
    peak.braking = peak.motoring;
    if (!accdec::holds(axis, peak, 1.0)) return false;
  }
  return true;
}

bool CornerLimits::holds(const Filter& filter_in, const Filter& filter_out, const double* in, const double* out,
                         int delay) const {
  const int last = std::max(filter_in.order(), filter_out.order() + delay) + settling;
  for (const std::size_t a : limited_) {
    const Axis& axis = machine_.axes[a];
    const double v1 = in[a], v2 = out[a];
    AxisSampler sampler(axis, period_);
    for (int k = 0; k <= last; ++k) {
      const double v = v1 * filter_in.remaining(k) + v2 * filter_out.cumulative(k - delay);
      const double acceleration = (v2 * filter_out.tap(k - 1 - delay) - v1 * filter_in.tap(k - 1)) / period_;
      if (!accdec::holds(axis, sampler.next(v, acceleration), slack)) return false;
    }
  }
  return true;
}

int CornerLimits::smallest(std::size_t f_in, std::size_t f_out, const double* in, const double* out, int from,
                           bool& possible) const {
  if (any_delay_holds(f_in, f_out, in, out, from)) return from;
  const Filter &filter_in = filters_.filters()[f_in], &filter_out = filters_.filters()[f_out];
  if (holds(filter_in, filter_out, in, out, from)) return from;
  const int apart = filter_in.order() + settling;
  if (from >= apart || !holds(filter_in, filter_out, in, out, apart)) {
    possible = false;
    return from;
  }
  int delay = from + 1;
  while (delay < apart && !holds(filter_in, filter_out, in, out, delay)) ++delay;
  return delay;
}

}  // namespace accdec
