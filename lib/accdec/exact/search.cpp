#include <algorithm>

#include <accdec/exact/contour_path.hpp>
#include <accdec/exact/parts.hpp>
#include <accdec/exact/reversal.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {
namespace {

bool single(const LimitModel& model, const Box& box) {
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& b = box.corners[j];
    if (b.d1 < b.d2 || (model.cone(j) && b.k1 < b.k2)) return false;
  }
  return true;
}

/// Delays of corners without a tolerance are split last: only limits of the blend depend on them.
proof::Node widest_split(const LimitModel& model, const Box& box) {
  proof::Split split;
  double widest = 0.0;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& b = box.corners[j];
    const bool tolerance = model.cone(j) || model.contour(j);
    const double delays = tolerance ? 2.0 * (b.d2 - b.d1) : 1e-9 * (b.d2 - b.d1);
    if (delays > widest) widest = delays, split.corner = static_cast<int>(j), split.on_delay = true;
    if (model.cone(j) && b.k2 - b.k1 > widest)
      widest = b.k2 - b.k1, split.corner = static_cast<int>(j), split.on_delay = false;
  }
  const CornerBox& b = box.corners[static_cast<std::size_t>(split.corner)];
  split.at = split.on_delay ? b.d1 + (b.d2 - b.d1) / 2 : b.k1 + (b.k2 - b.k1) / 2;
  return split;
}

/// With symmetric filters or chords, the filter of the leaf is not that of the linear program. So contour times are
/// split until it does not matter where in their range they are.
std::optional<proof::Node> finest_contour_split(const LimitModel& model, const Box& box) {
  if (model.convex() && !model.task().design.symmetric) return std::nullopt;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    if (model.contour(j) && c.c2 - c.c1 > 1e-3) return proof::ContourSplit{static_cast<int>(j), 0.5 * (c.c1 + c.c2)};
  }
  return std::nullopt;
}

}  // namespace

/// Whether the filter with the box's delay may be shorter than the target. If the box has several delays, its linear
/// program has no limits of the blend, so the filter breaks them.
bool Search::may_be_shorter(const Filter& filter, const Box& box) const {
  if (model_.convex() && box.corners.front().d1 < box.corners.front().d2) return false;
  int first = 0, last = filter.order();
  while (first < last && filter.tap(first) == 0.0) ++first;
  while (first < last && filter.tap(last) == 0.0) --last;
  const int order = std::max(last - first, task_.design.order_min);
  return cost_of(task_)(order, {box.corners.front().d1}) < bench_.target() * (1.0 - 1e-9);
}

/// Refutes a box, or finds a design in it that is shorter than the target. The target first narrows the box. Then
/// multipliers of earlier boxes may refute it, or a linear program of its own. If none does, the box is split and each
/// part is refuted. Every refuted part and every split is a node of the proof (`draft_`).
BoxState Search::refute(Box box) {
  if (bench_.stopped()) return BoxState::stopped;
  const Box whole = box;
  proof::Node why;
  if (!bench_.narrow(box, &why)) return bench_.leave(why);
  if (const auto node = branching_.split_of_long_orders(box)) {
    draft_.add(*node);
    const auto [shorter, longer] = parts(whole, *node);
    const BoxState state = refute(shorter);
    return state == BoxState::closed ? refute(longer) : state;
  }
  if (const int y = draft_.refuted_before(box); y >= 0) return bench_.close_by(y);
  const bool one = box.corners.size() == 1 && model_.cone(0);
  const bool alone = one || (box.corners.size() == 1 && model_.contour(0));
  if (const auto beginning = one ? draft_.refuted_beginning(box) : std::nullopt) {
    if (beginning->last == box.corners.front().k2) return bench_.close_by(beginning->multipliers);
    draft_.add(proof::Split{0, false, beginning->last});
    bench_.close_by(beginning->multipliers);
    return refute(parts(whole, proof::Split{0, false, beginning->last}).second);
  }

  Outcome outcome = bench_.relaxation().solve(box, false);
  if (outcome.kind == Outcome::refuted)
    return bench_.close_by(draft_.keep(std::move(outcome.multipliers), one ? box.corners.front() : CornerBox{.k1 = 1}));
  const bool is_single = single(model_, box);
  const std::optional<proof::Node> contour = is_single ? contour_split(box, outcome) : std::nullopt;
  if (is_single && !contour) return go_on(refute_single(whole, std::move(box), std::move(outcome)), whole);
  if (outcome.filter && (!one || may_be_shorter(*outcome.filter, box))) designs_.offer(*outcome.filter);
  const auto found = [&] { return bench_.below_target(); };
  if (found()) return go_on(BoxState::found, whole);
  const proof::Node node = contour                   ? *contour
                           : box.budget              ? branching_.choose_split(whole, box, outcome)
                           : alone && outcome.filter ? branching_.split_alone(*outcome.filter, box)
                                                     : widest_split(model_, box);
  if (found()) return BoxState::found;
  return refute_parts(whole, node);
}

BoxState Search::refute_parts(const Box& whole, const proof::Node& node) {
  draft_.add(node);
  const auto [first, second] = parts(whole, node);
  return both(refute(first), [&, part = &second] { return refute(*part); });
}

/// Single delays and samples: where a contour time must be split, because the linear program's filter keeps the
/// tolerance at no time of its range. Before that, the time at which the filter itself crosses is tried.
std::optional<proof::Node> Search::contour_split(const Box& box, const Outcome& outcome) {
  if (!outcome.filter) return std::nullopt;
  const auto missed = missed_contour(model_, *outcome.filter, box);
  if (!missed) return finest_contour_split(model_, box);
  const Box point = at_crossings(model_, *outcome.filter, box);
  const Outcome there = bench_.relaxation().solve(point, false);
  if (there.kind == Outcome::feasible && model_.convex() && !task_.design.symmetric)
    designs_.offer(*there.filter, point, false);
  return proof::ContourSplit{missed->corner, missed->at};
}

/// Refutes a box of one delay and one sample for every corner.
BoxState Search::refute_single(const Box& whole, Box box, Outcome outcome) {
  if (by_chords_) return reach_by_chords(box, outcome);
  if (!model_.convex()) {
    if (!task_.design.symmetric) return sums_.refute(std::move(box), false);
    bench_.leave(proof::SymmetricOrders{});
    const BoxState state = sums_.refute(box, true);
    if (box.order - 1 < std::max(task_.design.order_min, 0)) return state;
    --box.order;
    return both(state, [&] { return sums_.refute(box, true); });
  }
  const auto found = [&](const Filter& filter, const Box& of) {
    if (const auto node = missed_reversal(model_, filter, of)) return refute_parts(whole, *node);
    designs_.offer(filter, at_crossings(model_, filter, of), task_.design.symmetric);
    return bench_.below_target() ? BoxState::found : bench_.undecided();
  };
  if (!task_.design.symmetric) {
    if (outcome.kind != Outcome::feasible) return bench_.undecided();
    return found(*outcome.filter, box);
  }
  int leaf[2] = {-1, -1};
  for (int less = 0; less < 2; ++less) {
    Box exact_order = box;
    exact_order.order -= less;
    if (exact_order.order < std::max(task_.design.order_min, 0)) continue;
    outcome = bench_.relaxation().solve(exact_order, true);
    if (outcome.kind == Outcome::feasible) return found(*outcome.filter, exact_order);
    if (outcome.kind != Outcome::refuted) return bench_.undecided();
    leaf[less] = draft_.keep(std::move(outcome.multipliers));
  }
  return bench_.leave(proof::RefutedSymmetric{leaf[0], leaf[1] >= 0 ? leaf[1] : -2});
}

}  // namespace accdec::exact
