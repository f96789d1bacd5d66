#include <algorithm>
#include <cmath>
#include <numbers>

#include <accdec/design/baseline_search.hpp>
#include <accdec/design/tap_range.hpp>
#include <accdec/motion/controller_shapes.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/granted_limits.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

using std::numbers::pi;

constexpr double slack = 1.0 + 2.0 * verification_tolerance;
/// Of a real parameter's range: how closely it is searched.
constexpr double resolution = 1e-8;

/// Longer exponentials end in taps below 1e-9 of the first: those of a lower order do as well.
constexpr double most_time_constants = 21.0;
/// Tones kept, those that filters rang at first.
constexpr std::size_t most_tones = 100;

/// Whether the corner's error bound may hold at this delay, up to rounding.
bool may_hold_error(const Cascade& cascade, const TaskCorner& corner, double period, int delay) {
  const Corner& g = corner.geometry();
  const double allowed = std::max(*corner.error_max * slack, position_floor) * (1.0 + 1e-8);
  return may_hold_error(cascade, g.cos_interior(), g.feed_in * period, g.feed_out * period, delay, allowed);
}

/// |sin(n x/2)/(n sin(x/2))| of an average of n taps at x rad a sample.
double average_response(double phase, int length) {
  const double half = 0.5 * phase, below = length * std::sin(half);
  return std::abs(below) < 1e-9 * length ? 1.0 : std::abs(std::sin(length * half) / below);
}

int least_order(Shape shape) {
  switch (shape) {
    case Shape::s_curve:
    case Shape::hann:
    case Shape::blackman:
    case Shape::blackman_sinc: return 2;
    case Shape::gaussian: return 1;
    case Shape::boxcar:
    case Shape::trapezoid:
    case Shape::averages:
    case Shape::exponential:
    case Shape::taps: break;
  }
  return 0;
}

/// The taps of a family with a real parameter before they are divided by their sum, each monotone in what is searched:
/// the time constants an exponential is long (below 0 it rises), a Gaussian's alpha, a sinc's cut-off times its order
/// (2 puts its first zeros on the window's ends).
std::vector<double> plain_taps(Shape shape, int order, double parameter) {
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  for (int i = 0; i <= order; ++i) {
    double& b = taps[static_cast<std::size_t>(i)];
    const double x = i - 0.5 * order;
    if (shape == Shape::exponential) {
      b = std::exp(-parameter * i / std::max(1, order));
    } else if (shape == Shape::gaussian) {
      const double z = parameter * 2.0 * x / order;
      b = std::exp(-0.5 * z * z);
    } else {
      const double turn = 2.0 * pi * i / order, y = pi * parameter * x / order;
      const double window = std::max(0.0, 0.42 - 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn));
      b = window * (y == 0.0 ? 1.0 : std::max(0.0, std::sin(y) / y));
    }
  }
  return taps;
}

}  // namespace

BaselineSearch::BaselineSearch(const Task& task, const Baseline& baseline, double below)
    : task_(task),
      family_(baseline),
      cost_(cost_of(task)),
      bounds_(tap_bounds(granted_limits(task))),
      cheapest_(below) {
  const double period = task.sample_period;
  for (const TaskCorner& corner : task.corners) {
    const Corner& g = corner.geometry();
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const auto e = static_cast<Eigen::Index>(a);
      const double in = std::abs(g.feed_in * g.direction_in[e]), out = std::abs(g.feed_out * g.direction_out[e]);
      if (std::max(in, out) > 0.0) speeds_.push_back({&task.machine.axes[a], in, out});
    }
  }
  for (const Mode& mode : task.machine.modes) {
    for (const double f : {mode.frequency_low, 0.5 * (mode.frequency_low + mode.frequency_high), mode.frequency_high}) {
      tones_.push_back({2.0 * pi * f * period, mode.residual_max});
    }
  }
  // Of all filters with taps of at most 1/L, some shift of the boxcar of L taps, or a mixture of two neighbouring ones,
  // has the smallest distances p and q (their cost is convex in the tap's index); a mixture is worth at most one sample
  // of delay.
  const int taps = std::max(1, static_cast<int>(std::min(1.0 / bounds_.most, task.design.order_max + 1.0)));
  const Cascade narrowest(std::span(&taps, 1), 0, 0);
  for (const TaskCorner& corner : task.corners) {
    int least = corner.delay.value_or(0);
    if (!corner.delay && corner.error_max) {
      for (int high = taps; least < high;) {
        const int middle = least + (high - least) / 2;
        if (may_hold_error(narrowest, corner, period, middle))
          high = middle;
        else
          least = middle + 1;
      }
      least = std::max(0, least - 1);
    }
    least_delays_.push_back(least);
  }
}

bool BaselineSearch::late() {
  return late_ = late_ || (stop_now_ && stop_now_());
}

void BaselineSearch::run(std::function<bool()> stop) {
  stop_now_ = std::move(stop);
  const int first = std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max));
  for (int n = first; n <= task_.design.order_max && better(cost_(n, least_delays_)) && !late(); ++n) order(n);
}

/// Every member of order n, pairs included.
void BaselineSearch::order(int n) {
  const int least = least_order(family_.shape);
  FilterSpec spec;
  spec.kind = family_.shape;
  spec.pairs = family_.pairs;
  const int longest = family_.pairs == 0 ? 0 : (n - least) / family_.pairs;
  for (spec.pair_delay = family_.pairs == 0 ? 0 : 1; spec.pair_delay <= longest && !late(); ++spec.pair_delay) {
    spec.order = n - family_.pairs * spec.pair_delay;
    if (spec.order < least) continue;
    switch (family_.shape) {
      case Shape::trapezoid:
        for (spec.ramp = 0; spec.ramp <= spec.order / 2; ++spec.ramp) {
          offer_cascade({spec.order - spec.ramp + 1, spec.ramp + 1}, spec);
        }
        break;
      case Shape::averages: enumerate_averages(spec.order, spec); break;
      case Shape::boxcar: offer_cascade({spec.order + 1}, spec); break;
      case Shape::s_curve:
      case Shape::hann:
      case Shape::blackman: offer(spec); break;
      case Shape::exponential:
      case Shape::gaussian:
      case Shape::blackman_sinc: search_parameter(spec); break;
      case Shape::taps: break;  // no family
    }
  }
}

/// Three lengths, longest first, with as many taps as the order asks for.
void BaselineSearch::enumerate_averages(int order, FilterSpec spec) {
  for (int c = 0; 3 * c <= order && !late(); ++c) {
    for (int b = c; 2 * b <= order - c; ++b) {
      spec.lengths = {order - b - c + 1, b + 1, c + 1};
      offer_cascade(spec.lengths, spec);
    }
  }
}

void BaselineSearch::offer_cascade(const std::vector<int>& lengths, const FilterSpec& spec) {
  if (cheap_refusal(lengths, spec) || late()) return;  // of a million taps one takes 10 ms
  const std::vector<double> taps = cascade_taps(lengths, spec.pairs, spec.pair_delay);
  double sum = static_cast<double>(1 << spec.pairs);
  for (const int length : lengths) sum *= length;
  if (starts(taps, sum)) offer(spec);
}

/// What needs no taps: the plateau, the first step, the vibration at a few frequencies, a few samples, the errors.
bool BaselineSearch::cheap_refusal(const std::vector<int>& lengths, const FilterSpec& spec) {
  const double copies = static_cast<double>(1 << spec.pairs);
  double first = 1.0 / copies, rest = 0.0;
  for (const int length : lengths) first /= length, rest += length - 1;
  rest -= lengths.front() - 1;
  if (first > bounds_.step) return true;
  // The longest average has a plateau where it is longer than the others together; of copies, no tap is below its
  // share.
  if (lengths.front() > rest && 1.0 / lengths.front() / copies > bounds_.most) return true;
  if (rings(lengths, spec)) return true;
  if (spec.order + spec.pairs * spec.pair_delay > Cascade::order_max) return false;
  const Cascade cascade(lengths, spec.pairs, spec.pair_delay);
  return fails_likewise(cascade) || too_slow(cascade);
}

bool BaselineSearch::rings(const std::vector<int>& lengths, const FilterSpec& spec) {
  for (Tone& tone : tones_) {
    double amplitude = 1.0;
    for (const int length : lengths) amplitude *= average_response(tone.phase, length);
    for (int p = 0; p < spec.pairs; ++p) amplitude *= std::abs(std::cos(0.5 * tone.phase * spec.pair_delay));
    if (amplitude <= tone.residual_max * slack + 1e-12) continue;
    std::swap(tone, tones_.front());
    return true;
  }
  return false;
}

bool BaselineSearch::start_holds(const Speeds& speeds, double tap, double gone) const {
  const Axis& axis = *speeds.axis;
  const double v = speeds.start * gone, force = axis.mass * speeds.start * tap / task_.sample_period + axis.damping * v;
  return force <= axis.force_max * slack && force * v <= axis.power_max * slack;
}

bool BaselineSearch::stop_holds(const Speeds& speeds, double tap, double left) const {
  const Axis& axis = *speeds.axis;
  const double v = speeds.stop * left, braking = axis.mass * speeds.stop * tap / task_.sample_period - axis.damping * v;
  return braking * v <= axis.regeneration_max * slack;
}

/// Whether a filter may start every leg and stop it: what most do not, and the cheapest to see on taps not yet divided
/// by their sum.
bool BaselineSearch::starts(std::span<const double> taps, double sum) {
  if (*std::max_element(taps.begin(), taps.end()) > bounds_.most * sum || taps.front() > bounds_.step * sum)
    return false;
  const int last = static_cast<int>(taps.size()) - 1;
  for (const Speeds& speeds : speeds_) {
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

/// Whether it breaks a limit where the last one did that broke one: neighbours mostly do.
bool BaselineSearch::fails_likewise(const Cascade& cascade) const {
  constexpr double looser = 1.0 - 1e-8;  // than rounding
  if (const auto& [speeds, k] = failed_start_;
      speeds != nullptr && !start_holds(*speeds, looser * cascade.tap(k), looser * cascade.gone(k)))
    return true;
  const auto& [speeds, k] = failed_stop_;
  return speeds != nullptr && !stop_holds(*speeds, looser * cascade.tap(k), 1.0 - cascade.gone(k));
}

void BaselineSearch::offer(const FilterSpec& spec) {
  ++tried_;
  // Of a million taps a filter has up to a million delays, or frequencies, to be looked at.
  const auto late = [this] { return this->late(); };
  const Filter filter = make_filter(spec);
  if (*std::max_element(filter.taps().begin(), filter.taps().end()) > bounds_.most) return;
  for (const LimitUse& use : vibration_utilisation(filter, task_.sample_period, task_.machine, late)) {
    if (use.utilisation <= slack) continue;
    // The next ones that ring so are refused at once, and so are ranges of them.
    const double phase = 2.0 * pi * use.frequency * task_.sample_period;
    const bool known =
        std::any_of(tones_.begin(), tones_.end(), [=](const Tone& t) { return std::abs(t.phase - phase) < 1e-9; });
    if (!known && tones_.size() < most_tones) tones_.push_back({phase, use.bound});
    return;
  }
  const auto delays = delays_by_formula(filter, task_, cheapest_, late);
  if (!delays || late()) return;
  const double cost = cost_(filter.order(), *delays);
  if (!better(cost)) return;
  cheapest_ = cost;
  best_ = spec;
  delays_ = *delays;
}

/// Whether some corner's error bound needs a delay that costs too much.
bool BaselineSearch::too_slow(const Cascade& cascade) const {
  if (cheapest_ == unlimited) return false;
  const double room = cheapest_ - cost_(cascade.order(), least_delays_);
  for (std::size_t j = 0; j < task_.corners.size(); ++j) {
    const TaskCorner& corner = task_.corners[j];
    if (corner.delay || !corner.error_max) continue;
    const int delay = least_delays_[j] + static_cast<int>(std::min(room / cost_.delay[j], 1e8));
    if (!may_hold_error(cascade, corner, task_.sample_period, delay)) return true;
  }
  return false;
}

/// Branch and bound over the one real parameter of a shape.
void BaselineSearch::search_parameter(const FilterSpec& spec) {
  const bool exponential = spec.kind == Shape::exponential;
  const double high = spec.kind == Shape::blackman_sinc ? 2.0 : exponential ? most_time_constants : 6.0;
  const double low =
      exponential ? -std::min(most_time_constants, std::log(exponential_ratio_max) * std::max(1, spec.order)) : 0.0;
  const auto offer_at = [&](double value) {
    FilterSpec tried = spec;
    if (exponential) tried.ratio = std::min(std::exp(-value / std::max(1, spec.order)), exponential_ratio_max);
    if (spec.kind == Shape::gaussian) tried.alpha = value;
    if (spec.kind == Shape::blackman_sinc) tried.cutoff = value / spec.order;
    if (spec.kind != Shape::blackman_sinc || value > 0.0) offer(tried);
  };
  struct Interval {
    double from, to;
    std::vector<double> taps_from, taps_to;
  };
  std::vector<Interval> open{
      {low, high, plain_taps(spec.kind, spec.order, low), plain_taps(spec.kind, spec.order, high)}};
  bool ends_offered = false;
  while (!open.empty() && !late()) {
    const Interval interval = std::move(open.back());
    open.pop_back();
    ++tried_;
    const TapRange range = tap_range(interval.taps_from, interval.taps_to, spec.pairs, spec.pair_delay);
    if (!better(lower_cost(range, task_, cost_, tones_, least_delays_, cheapest_))) continue;
    if (!ends_offered) offer_at(high), offer_at(low), ends_offered = true;
    if (interval.to - interval.from < resolution * (high - low)) continue;
    const double middle = 0.5 * (interval.from + interval.to);
    offer_at(middle);
    const std::vector<double> taps = plain_taps(spec.kind, spec.order, middle);
    open.push_back({interval.from, middle, interval.taps_from, taps});
    open.push_back({middle, interval.to, taps, interval.taps_to});
  }
}

}  // namespace accdec
