#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/exact/search.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/delays_by_formula.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/verify.hpp>

namespace accdec::exact {
namespace {

double value_of(const Task& task, int order, const std::vector<int>& delays) {
  return cost_of(task)(order, delays);
}

bool single(const LimitModel& model, const Box& box) {
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& b = box.corners[j];
    if (b.d1 < b.d2 || (model.cone(j) && b.k1 < b.k2)) return false;
  }
  return true;
}

proof::Node widest_split(const LimitModel& model, const Box& box) {
  proof::Split split;
  int widest = -1;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& b = box.corners[j];
    if (2 * (b.d2 - b.d1) > widest && b.d1 < b.d2)
      widest = 2 * (b.d2 - b.d1), split.corner = static_cast<int>(j), split.on_delay = true;
    if (model.cone(j) && b.k2 - b.k1 > widest && b.k1 < b.k2)
      widest = b.k2 - b.k1, split.corner = static_cast<int>(j), split.on_delay = false;
  }
  const CornerBox& b = box.corners[static_cast<std::size_t>(split.corner)];
  split.at = split.on_delay ? b.d1 + (b.d2 - b.d1) / 2 : b.k1 + (b.k2 - b.k1) / 2;
  return split;
}

}  // namespace

Filter trimmed(const Filter& filter, const Task& task) {
  const DesignBounds& bounds = task.design;
  const bool damped = std::any_of(task.machine.modes.begin(), task.machine.modes.end(),
                                  [](const Mode& mode) { return mode.damping_high > 0.0; });
  std::vector<double> taps(filter.taps().begin(), filter.taps().end());
  const auto longer = [&](std::size_t by) {
    return static_cast<int>(taps.size()) - 1 - static_cast<int>(by) >= std::max(bounds.order_min, 0);
  };
  if (bounds.symmetric) {
    while (!damped && longer(2) && taps.front() == 0.0 && taps.back() == 0.0) taps.pop_back(), taps.erase(taps.begin());
  } else {
    while (!damped && longer(1) && taps.back() == 0.0) taps.pop_back();
    while (longer(1) && taps.front() == 0.0) taps.erase(taps.begin());
  }
  return Filter(std::move(taps));
}

Box Search::root() const {
  Box box;
  box.order = task_.design.order_max;
  box.servo = model_.servo();
  for (const TaskCorner& corner : task_.corners) {
    CornerBox b;
    // From d = N + 1 on, the legs do not overlap. Every limited difference of the acceleration adds one sample to this,
    // and a response as many as it has.
    b.d1 = corner.delay.value_or(0);
    b.d2 = corner.delay.value_or(task_.design.order_max + settling + box.longer());
    b.k2 = b.d2 + task_.design.order_max + 1 + box.longer();
    box.corners.push_back(b);
  }
  return box;
}

void Search::size_for(int order) {
  if (relaxation_ && order <= sized_ && 2 * order >= sized_ && window_.order == 0) return;
  if (relaxation_ && order == sized_) return;
  require_room(task_, order);
  linear_programs_ = linear_programs();
  relaxation_ = std::make_unique<Relaxation>(model_, order, stop_, 0.0, kind_);
  sized_ = order;
}

void Search::consider(Filter filter, const std::vector<int>& delays) {
  const double value = value_of(task_, filter.order(), delays);
  if (best && value >= best->value * (1.0 - 1e-12)) return;
  if (verify_by_simulation(task_, filter, delays).feasible) best = Candidate{std::move(filter), delays, value};
}

Filter Search::mended(const Filter& filter, const Box& box, bool symmetric, const std::vector<int>& delays) {
  double margin = 0.0;
  Filter tried = filter;
  for (int attempt = 0; attempt < 5; ++attempt) {
    const VerificationReport report = verify_by_simulation(task_, trimmed(tried, task_), delays);
    if (report.feasible) return tried;
    // A larger violation is not rounding.
    if (report.max_violation > 1e-6 || margin < 0.0) break;
    margin = std::max(2.0 * margin, 2.0 * report.max_violation);
    const auto asked_for = [&](double by) {
      Relaxation relaxation(model_, box.order, stop_, by);
      Outcome outcome = relaxation.solve(box, symmetric);
      linear_programs_ += relaxation.linear_programs();
      return outcome.filter;
    };
    auto next = attempt < 3 ? asked_for(margin) : std::nullopt;
    // The limits leave no such margin, but perhaps part of what verification grants.
    if (!next) next = asked_for(margin = almost_granted);
    if (!next) break;
    tried = std::move(*next);
  }
  return filter;
}

void Search::offer(Filter filter) {
  if (task_.design.symmetric) {
    std::vector<double> taps(filter.taps().begin(), filter.taps().end());
    for (std::size_t i = 0; i < taps.size() / 2; ++i)
      taps[i] = taps[taps.size() - 1 - i] = 0.5 * (taps[i] + taps[taps.size() - 1 - i]);
    filter = Filter(std::move(taps));
  }
  filter = trimmed(filter, task_);
  if (filter.order() < task_.design.order_min || filter.order() > task_.design.order_max) return;
  const auto delays = delays_by_formula(filter, task_, best ? best->value : std::numeric_limits<double>::infinity());
  if (delays) consider(std::move(filter), *delays);
}

int Search::smallest_order() {
  const int most = task_.design.order_max;
  // Without tolerances every delay and every sample is free.
  const auto holds = [&](int order) {
    size_for(order);
    Box box = root();
    box.order = order;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      CornerBox& b = box.corners[j];
      if (!task_.corners[j].delay) b.d1 = 0, b.d2 = std::max(order, most) + settling + box.longer();
      b.k1 = 0, b.k2 = b.d2 + order + 1 + box.longer();
    }
    if (!model_.convex() && !model_.shrink(box)) return false;
    const Outcome outcome = relaxation_->solve(box, false);
    if (outcome.filter) offer(*outcome.filter);
    return outcome.kind != Outcome::refuted;
  };
  int low = std::max({0, order_lower_bound(model_.granted().task(), most), task_.design.order_min}) - 1,
      high = std::max(low + 1, 0);  // low is refuted
  while (high <= most && !stop_()) {
    if (holds(high)) break;
    low = high;
    if (high == most) return most + 1;
    high = std::min(most, high + std::max(2, high / 3));
  }
  if (high > most) return most + 1;
  while (high - low > 1 && !stop_()) {
    const int mid = (low + high) / 2;
    (holds(mid) ? high : low) = mid;
  }
  return smallest_order_ = high;
}

Search::State Search::leave(proof::Node leaf) {
  draft_.add(std::move(leaf));
  return State::closed;
}

Search::State Search::close_by(int multipliers) {
  draft_.close_by(multipliers);
  return State::closed;
}

bool Search::narrow(Box& box, proof::Node* why) {
  if (why) *why = proof::TooLong{};
  if (box.window) return true;
  if (!tighten(task_, target_, box)) return false;
  for (std::size_t j = 0; j < box.corners.size(); ++j)
    box.corners[j].k2 = std::min(box.corners[j].k2, box.last_sample(j));
  for (const CornerBox& b : box.corners) {
    if (b.k1 > b.k2) return false;
  }
  if (why) *why = proof::Unreachable{};
  return (model_.convex() && !box.budget) || model_.shrink(box);
}

/// Uses the delay of the box. With several delays, the linear program has no limits of the blend, so the filter breaks
/// them.
bool Search::may_be_shorter(const Filter& filter, const Box& box) const {
  if (model_.convex() && box.corners.front().d1 < box.corners.front().d2) return false;
  int first = 0, last = filter.order();
  while (first < last && filter.tap(first) == 0.0) ++first;
  while (first < last && filter.tap(last) == 0.0) --last;
  const int order = std::max(last - first, task_.design.order_min);
  return value_of(task_, order, {box.corners.front().d1}) < target_ * (1.0 - 1e-9);
}

Search::State Search::refute(Box box) {
  if (stopped()) return State::stopped;
  const Box whole = box;
  proof::Node why;
  if (!narrow(box, &why)) return leave(why);
  if (const auto node = split_of_long_orders(box)) {
    draft_.add(*node);
    const auto [shorter, longer] = parts(whole, *node);
    const State state = refute(shorter);
    return state == State::closed ? refute(longer) : state;
  }
  if (const int y = draft_.refuted_before(box); y >= 0) return close_by(y);
  const bool one = box.corners.size() == 1 && model_.cone(0);
  if (const auto beginning = one ? draft_.refuted_beginning(box) : std::nullopt) {
    if (beginning->last == box.corners.front().k2) return close_by(beginning->multipliers);
    draft_.add(proof::Split{0, false, beginning->last});
    close_by(beginning->multipliers);
    return refute(parts(whole, proof::Split{0, false, beginning->last}).second);
  }

  Outcome outcome = relaxation_->solve(box, false);
  if (outcome.kind == Outcome::refuted)
    return close_by(draft_.keep(std::move(outcome.multipliers), one ? box.corners.front() : CornerBox{.k1 = 1}));
  if (single(model_, box)) return go_on(refute_single(std::move(box), std::move(outcome)), whole);
  if (outcome.filter && (!one || may_be_shorter(*outcome.filter, box))) offer(*outcome.filter);
  const auto found = [&] { return best && best->value < target_ * (1.0 - 1e-9); };
  if (found()) return go_on(State::found, whole);
  const proof::Node node = box.budget              ? choose_split(whole, box, outcome)
                           : one && outcome.filter ? split_alone(*outcome.filter, box)
                                                   : widest_split(model_, box);
  if (found()) return State::found;
  draft_.add(node);
  const auto [first, second] = parts(whole, node);
  return both(refute(first), [&, part = &second] { return refute(*part); });
}

/// Refutes a box of one delay and one sample for every corner.
Search::State Search::refute_single(Box box, Outcome outcome) {
  if (by_chords_) return reach_by_chords(box, outcome);
  if (!model_.convex()) {
    if (!task_.design.symmetric) return refute_sums(std::move(box), false, 0);
    leave(proof::SymmetricOrders{});
    const State state = refute_sums(box, true, 0);
    if (box.order - 1 < std::max(task_.design.order_min, 0)) return state;
    --box.order;
    return both(state, [&] { return refute_sums(box, true, 0); });
  }
  std::vector<int> delays;
  for (const CornerBox& b : box.corners) delays.push_back(b.d1);
  const auto found = [&](const Filter& filter, const Box& of) {
    consider(trimmed(mended(filter, of, task_.design.symmetric, delays), task_), delays);
    return best && best->value < target_ * (1.0 - 1e-9) ? State::found : undecided();
  };
  if (!task_.design.symmetric) {
    if (outcome.kind != Outcome::feasible) return undecided();
    return found(*outcome.filter, box);
  }
  int leaf[2] = {-1, -1};
  for (int less = 0; less < 2; ++less) {
    Box exact_order = box;
    exact_order.order -= less;
    if (exact_order.order < std::max(task_.design.order_min, 0)) continue;
    outcome = relaxation_->solve(exact_order, true);
    if (outcome.kind == Outcome::feasible) return found(*outcome.filter, exact_order);
    if (outcome.kind != Outcome::refuted) return undecided();
    leaf[less] = draft_.keep(std::move(outcome.multipliers));
  }
  return leave(proof::RefutedSymmetric{leaf[0], leaf[1] >= 0 ? leaf[1] : -2});
}

}  // namespace accdec::exact
