#include <algorithm>
#include <cmath>

#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/checked_rows.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

using Taps = std::vector<Interval>;

/// The library's exponential is accurate to an ulp; two on either side cover it.
Interval exponential(const Interval& x) {
  const Interval wide(std::exp(x.lo), std::exp(x.hi)), once = Interval::widened(wide.lo, wide.hi);
  return Interval::widened(once.lo, once.hi);
}

/// Taps of a position control: the part of a step that is still missing after k samples is c a^k.
Taps of_gain(double gain, double feedforward, double period) {
  if (!(gain > 0.0 && gain < 1e9 && feedforward >= 0.0 && feedforward <= 1.0))
    throw Rejected("a servo's gain or feedforward is out of range");
  const Interval x = Interval(gain) * Interval(period), a = exponential(Interval(0.0) - x);
  Interval missing = (Interval(1.0) - Interval(feedforward)) * (Interval(1.0) - a) / x;
  Taps taps{Interval(1.0) - missing};
  while (0.5 * (missing.lo + missing.hi) >= response_rest) {
    if (taps.size() > static_cast<std::size_t>(response_taps_max)) throw Rejected("a servo's response does not end");
    const Interval next = missing * a;
    taps.push_back(missing - next);
    missing = next;
  }
  taps.back() = taps.back() + missing;
  return taps;
}

Taps of_numbers(const std::vector<double>& numbers) {
  Interval sum;
  for (const double x : numbers) {
    if (!(x >= 0.0)) throw Rejected("a response has a negative tap");
    sum = sum + Interval(x);
  }
  if (!(sum.lo > 0.999 && sum.hi < 1.001)) throw Rejected("a response has not the sum 1");
  Taps taps;
  for (const double x : numbers) taps.push_back(Interval(x) / sum);
  return taps;
}

Taps of_axis(const Axis& axis, double period) {
  if (!axis.response_taps.empty()) return of_numbers(axis.response_taps);
  if (axis.servo_gain < unlimited) return of_gain(axis.servo_gain, axis.velocity_feedforward, period);
  return {Interval(1.0)};
}

std::vector<double> middles(const Taps& taps) {
  std::vector<double> all;
  for (const Interval& tap : taps) all.push_back(0.5 * (tap.lo + tap.hi));
  return all;
}

bool same_servo(const Axis& a, const Axis& b) {
  return a.response_taps == b.response_taps && a.servo_gain == b.servo_gain &&
         (a.servo_gain == unlimited || a.velocity_feedforward == b.velocity_feedforward);
}

}  // namespace

CheckedResponse::CheckedResponse(const Task& task) : left_(1), gone_(1) {
  const Machine& machine = task.machine;
  smooths_ = machine.prefilter_taps.size() > 1;
  for (const Axis& axis : machine.axes) {
    follows_ = follows_ || !axis.response_taps.empty() || axis.servo_gain < unlimited;
    if (!same_servo(axis, machine.axes.front())) throw Rejected("the axes respond differently: no proof covers this");
  }
  if (ideal()) return;
  const Taps first = smooths_ ? of_numbers(machine.prefilter_taps) : Taps{Interval(1.0)},
             second = follows_ ? of_axis(machine.axes.front(), task.sample_period) : Taps{Interval(1.0)};
  follows_ = second.size() > 1;
  smoothing_ = middles(first), servo_ = middles(second);
  command_ = first;
  Taps taps(first.size() + second.size() - 1);
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) taps[i + j] = taps[i + j] + first[i] * second[j];
  }
  motion_ = taps;
  const std::size_t end = taps.size() - 1;
  left_.assign(end + 1, Interval(0.0));
  gone_.assign(end + 1, Interval(0.0));
  Interval after;  // sum of the taps from n on
  for (std::size_t n = end; n > 0; --n) {
    after = after + taps[n];
    left_[n - 1] = left_[n] + after;
  }
  Interval before;  // sum of the taps up to y
  for (std::size_t y = 0; y < end; ++y) {
    before = before + taps[y];
    gone_[y + 1] = gone_[y] + before;
  }
}

void CheckedResponse::require_ideal() const {
  if (!ideal()) throw Rejected("a multiplier names a limit that is not known behind a response");
}

Interval CheckedResponse::left(int x) const {
  if (x >= 0) return Interval(static_cast<double>(x)) + left_.front();
  return -x > longer() ? Interval(0.0) : left_[static_cast<std::size_t>(-x)];
}

Interval CheckedResponse::gone(int y) const {
  if (y <= 0) return Interval(0.0);
  return y > longer() ? Interval(static_cast<double>(y)) - left_.front() : gone_[static_cast<std::size_t>(y)];
}

}  // namespace accdec
