#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/families/family_search.hpp>
#include <accdec/families/tap_range.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/limits_on_taps.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A real parameter is searched down to this part of its range. Behind a response the ranges of taps bound little, so
/// that fewer values are tried.
constexpr double resolution = 1e-8, resolution_behind_a_response = 1.0 / 256.0;

/// Whether the corner's error bound may hold at this delay, up to rounding. @param legs  a Cascade or a Filter
template <class Legs>
bool may_hold_error(const Legs& legs, const TaskCorner& corner, double period, int delay) {
  const Corner& g = corner.geometry();
  const double allowed = granted_error(*corner.error_max) * (1.0 + 1e-8);
  return may_hold_error(legs, g.cos_interior(), g.feed_in * period, g.feed_out * period, delay, allowed);
}

QuickRefusals quick_refusals(const Task& task, const Task& on_taps) {
  const Response response(task.machine, task.sample_period);
  if (response.prefilter_order() == 0) return {on_taps, response.prefilter(), on_taps};
  Task behind = task;
  behind.machine.prefilter_taps.clear();
  return {on_taps, response.prefilter(), *limits_on_taps(behind)};
}

}  // namespace

FamilySearch::FamilySearch(const Task& task, const Family& baseline, double below, Members members)
    : task_(task),
      on_taps_(limits_on_taps(task)),
      family_(baseline),
      members_(std::move(members)),
      cost_(cost_of(task)),
      by_feed_(task.settings && task.settings->names(DelayKind::corner_feed)),
      refusals_(quick_refusals(task, *on_taps_)),
      cheapest_(below) {
  // Take all filters with taps of at most 1/L. Their distances p and q are smallest for some shift of the boxcar of L
  // taps or for a mixture of two neighbouring shifts. The reason is that the cost is convex in the tap's index. A
  // mixture is worth at most one sample of delay. Behind a response the same holds, as convolution keeps that order.
  const int taps = std::max(1, static_cast<int>(std::min(1.0 / refusals_.tap_max(), task.design.order_max + 1.0)));
  const Cascade narrowest(std::span(&taps, 1), 0, 0);
  const Response response(task.machine, task.sample_period);
  std::optional<Filter> motion;
  if (!response.common()) {
    for (const TaskCorner& corner : task.corners) least_delays_.push_back(corner.delay.value_or(0));
    return;
  }
  if (!response.ideal()) motion = response.motion(make_filter({.kind = Shape::boxcar, .order = taps - 1}));
  const int last = motion ? motion->order() + 1 : taps;
  for (const TaskCorner& corner : task.corners) {
    int least = corner.delay.value_or(0);
    if (!corner.delay && corner.error_max && !by_feed_) {
      const auto may_hold = [&](int delay) {
        return motion ? may_hold_error(*motion, corner, task.sample_period, delay)
                      : may_hold_error(narrowest, corner, task.sample_period, delay);
      };
      for (int high = last; least < high;) {
        const int middle = least + (high - least) / 2;
        if (may_hold(middle))
          high = middle;
        else
          least = middle + 1;
      }
      least = std::max(0, least - 1);
    }
    least_delays_.push_back(least);
  }
}

bool FamilySearch::late() {
  return late_ = late_ || (stop_now_ && stop_now_());
}

void FamilySearch::run(std::function<bool()> stop) {
  stop_now_ = std::move(stop);
  const int first = std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max));
  for (int n = first; n <= task_.design.order_max && better(cost_(n, least_delays_)) && !late(); ++n) order(n);
}

/// Every member of order n, pairs included.
void FamilySearch::order(int n) {
  const MemberVisitor visit = [this](const FilterSpec& spec, std::span<const int> lengths) {
    // Most members are refused in less time than a look at the clock takes.
    if (++visited_ % 64 == 0 && late()) return false;
    if (family_.parameter && !members_)
      search_parameter(spec, *family_.parameter);
    else if (!lengths.empty())
      offer_cascade(lengths, spec);
    else
      offer(spec);
    return !late_;
  };
  if (members_)
    members_(n, visit);
  else
    visit_members(family_, n, 1, visit);
}

void FamilySearch::offer_cascade(std::span<const int> lengths, const FilterSpec& spec) {
  if (slow_.covers(lengths, spec)) return;
  if (!spec.whole_pairs()) {
    if (!refusals_.refuses(lengths, spec) && !too_slow(lengths, spec) && !late()) offer(spec);
    return;
  }
  if (cheap_refusal(lengths, spec) || late()) return;  // of a million taps one takes 10 ms
  const std::vector<double> taps = cascade_taps(lengths, spec.pairs, static_cast<int>(spec.pair_delay), spec.outer);
  double sum = static_cast<double>(1 << spec.pairs);
  for (const int length : lengths) sum *= length;
  if (refusals_.starts(taps, sum)) offer(spec);
}

/// Refusals that need no taps: by the lengths, a few samples, the errors.
bool FamilySearch::cheap_refusal(std::span<const int> lengths, const FilterSpec& spec) {
  if (refusals_.refuses(lengths, spec)) return true;
  if (spec.full_order() > Cascade::order_max) return false;
  const Cascade cascade(lengths, spec.pairs, static_cast<int>(spec.pair_delay), spec.outer);
  if (refusals_.fails_likewise(cascade)) return true;
  const bool slow = too_slow(cascade, spec.full_order(), 0);
  if (slow) slow_.remember(lengths, spec, false);
  return slow;
}

/// The same of impulses between samples. With those at whole samples that are nearer to each other, the legs are no
/// farther from the corner at any time. Between two samples they are as far as at the later one with one more sample
/// of delay.
bool FamilySearch::too_slow(std::span<const int> lengths, const FilterSpec& spec) {
  if (spec.full_order() > Cascade::order_max) return false;
  const bool slow =
      too_slow(Cascade(lengths, spec.pairs, static_cast<int>(spec.pair_delay), spec.outer), spec.full_order(), 1);
  if (slow) slow_.remember(lengths, spec, true);
  return slow;
}

void FamilySearch::offer(const FilterSpec& spec) {
  if (refusals_.refuses_first_taps(spec)) return;
  ++tried_;
  // A filter of a million taps has up to a million delays, or frequencies, to check.
  const auto late = [this] { return this->late(); };
  const Filter filter = make_filter(spec);
  if (refusals_.refuses(filter, late)) return;
  const auto delays = delays_of_kinds(filter, task_, cheapest_, late);
  if (!delays || late()) return;
  const double cost = cost_(filter.order(), delays->delays) + delays->lost;
  if (!better(cost)) return;
  cheapest_ = cost;
  best_ = spec;
  delays_ = *delays;
}

/// Whether the delays that the corners' error bounds need cost too much together. @param spare  samples that they are
/// shorter than those of the cascade
bool FamilySearch::too_slow(const Cascade& cascade, int order, int spare) const {
  if (cheapest_ == unlimited || by_feed_) return false;
  double room = cheapest_ - cost_(order, least_delays_);
  for (std::size_t j = 0; j < task_.corners.size(); ++j) {
    const TaskCorner& corner = on_taps_->corners[j];
    if (corner.delay || !corner.error_max) continue;
    const auto may_hold = [&](int delay) {
      return may_hold_error(cascade, corner, task_.sample_period, delay + spare);
    };
    int low = least_delays_[j], high = low + static_cast<int>(std::min(room / cost_.delay[j] * (1.0 + 1e-9), 1e8));
    if (!may_hold(high)) return true;
    // The others have what this corner leaves of the room.
    while (low < high && j + 1 < task_.corners.size()) {
      const int middle = low + (high - low) / 2;
      if (may_hold(middle))
        high = middle;
      else
        low = middle + 1;
    }
    if (j + 1 < task_.corners.size()) room -= cost_.delay[j] * (high - least_delays_[j]);
  }
  return false;
}

/// Branch and bound over the one real parameter of a shape.
void FamilySearch::search_parameter(const FilterSpec& spec, const RealParameter& parameter) {
  const double low = parameter.low(spec.order), high = parameter.high;
  const auto offer_at = [&](double value) {
    if (parameter.open_low && value == low) return;
    FilterSpec tried = spec;
    parameter.set(tried, value);
    offer(tried);
  };
  struct Interval {
    double from, to;
    std::vector<double> taps_from, taps_to;
  };
  std::vector<Interval> open{{low, high, parameter.taps(spec.order, low), parameter.taps(spec.order, high)}};
  bool ends_offered = false;
  const bool ideal = Response(task_.machine, task_.sample_period).ideal();
  const double finest = ideal ? resolution : resolution_behind_a_response;
  while (!open.empty() && !late()) {
    const Interval interval = std::move(open.back());
    open.pop_back();
    ++tried_;
    const TapRange range =
        tap_range(interval.taps_from, interval.taps_to, spec.pairs, static_cast<int>(spec.pair_delay));
    if (!better(lower_cost(range, *on_taps_, cost_, refusals_.tones(), least_delays_, cheapest_))) continue;
    if (!ends_offered) offer_at(high), offer_at(low), ends_offered = true;
    if (interval.to - interval.from < finest * (high - low)) continue;
    const double middle = 0.5 * (interval.from + interval.to);
    offer_at(middle);
    const std::vector<double> taps = parameter.taps(spec.order, middle);
    open.push_back({interval.from, middle, interval.taps_from, taps});
    open.push_back({middle, interval.to, taps, interval.taps_to});
  }
}

}  // namespace accdec
