#include <algorithm>
#include <cmath>

#include <accdec/exact/contour_path.hpp>
#include <accdec/exact/corner_error.hpp>
#include <accdec/exact/one_width.hpp>
#include <accdec/exact/parts.hpp>
#include <accdec/exact/reversal.hpp>
#include <accdec/exact/sum_search.hpp>
#include <accdec/exact/together_search.hpp>
#include <accdec/exact/window.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec::exact {
namespace {

/// The corner of a row or a split; -1 if it has none.
template <class RowOrNode>
int corner_of(const RowOrNode& id) {
  return std::visit(
      [](const auto& one) {
        if constexpr (requires { one.corner; })
          return one.corner;
        else
          return -1;
      },
      id);
}

}  // namespace

TogetherSearch::TogetherSearch(const Task& task, std::function<bool()> stop, Window window)
    : bench_(task, std::move(stop), window.order > 0 ? BoxKind::window : BoxKind::together),
      window_(std::move(window)) {}

bool TogetherSearch::blend_holds(const Filter& filter, const Box& box, std::size_t j, int delay) const {
  Box one = box;
  for (std::size_t i = 0; i < one.corners.size(); ++i) {
    if (i != j) one.corners[i].d1 = 0, one.corners[i].d2 = 1;
  }
  one.corners[j].d1 = one.corners[j].d2 = delay;
  if (!box.window) one = at_reversals(bench_.model(), filter, std::move(one));
  const auto broken = bench_.model().rows.broken_blend_rows(filter, one, 1e-9);
  if (std::any_of(broken.begin(), broken.end(),
                  [&](const proof::Row& id) { return !box.window || inside_window(id, one, bench_.model().rows); }))
    return false;
  if (box.window) return true;
  if (bench_.model().rows.breaks_residual(filter, one, j, 1e-9)) return false;
  std::optional<Filter> made;
  const Filter& motion = bench_.model().rows.motion().behind(filter, made);
  for (const ChordFamily& family : bench_.model().chords.families()) {
    if (family.corner != static_cast<int>(j)) continue;
    for (int sample = 1; sample <= bench_.model().chords.last_sample(family, one); ++sample) {
      if (bench_.model().chords.use(family, sample, motion, one) > 1.0 + 1e-9) return false;
    }
  }
  return true;
}

std::optional<proof::Node> TogetherSearch::split(const Filter& filter, const Box& box) const {
  ErrorSplit chosen;
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    const CornerBox& c = box.corners[j];
    if (!among_[j]) continue;
    bool error_holds = !bench_.model().cone(j), limits_hold = false;
    std::optional<CornerError> error;
    if (bench_.model().cone(j)) error.emplace(bench_.model(), filter, j);
    for (int d = c.d1; d <= c.d2 && !limits_hold; ++d) {
      if (error && !error->holds(d, c, box.order)) continue;
      error_holds = true;
      limits_hold = contour_holds(bench_.model(), filter, box, j, d) && blend_holds(filter, box, j, d);
    }
    if (!error_holds) {
      consider_splits(*error, j, c, false, chosen);
    } else if (!limits_hold && c.d1 < c.d2 && chosen.gain < -1e9) {
      // Other limits of the blend need single delays; the longest delay is the most likely to hold.
      chosen.gain = -1e9;
      chosen.split = {static_cast<int>(j), true, c.d2 - 1};
    }
  }
  const auto missed = missed_contour(bench_.model(), filter, box);
  if (missed && missed->by > std::max(0.0, chosen.gain)) return proof::ContourSplit{missed->corner, missed->at};
  if (chosen.gain > -std::numeric_limits<double>::infinity()) return chosen.split;
  if (box.window) return std::nullopt;
  if (const auto reversal = missed_reversal(bench_.model(), filter, box)) return *reversal;
  if (bench_.model().convex()) return std::nullopt;
  const auto broken = widest_break(bench_.model(), filter, box, &among_);
  if (!broken) return std::nullopt;
  // Rounding decides here: nothing is left to split.
  if (broken->sample == 0) return proof::TooLong{};
  return proof::ResponseSplit{broken->sample, broken->level};
}

BoxState TogetherSearch::refute(Box box, int depth) {
  if (bench_.stopped()) return BoxState::stopped;
  if (depth > 400) return BoxState::open;
  const Box whole = box;
  proof::Node why;
  if (!bench_.narrow(box, &why)) return bench_.leave(why);
  if (const int y = bench_.draft().refuted_before(box); y >= 0) return bench_.close_by(y);
  Outcome outcome = bench_.relaxation().solve(box, false);
  if (outcome.kind == Outcome::refuted) return bench_.close_by(bench_.draft().keep(std::move(outcome.multipliers)));
  if (!outcome.filter) return bench_.undecided();
  bench_.designs.offer(*outcome.filter);
  const auto node = split(*outcome.filter, box);
  if (!node) return BoxState::found;
  if (std::holds_alternative<proof::TooLong>(*node)) return BoxState::open;
  bench_.draft().add(*node);
  std::pair<Box, Box> both_parts = parts(whole, *node);
  const BoxState state = refute(std::move(both_parts.first), depth + 1);
  return state == BoxState::closed ? refute(std::move(both_parts.second), depth + 1) : state;
}

/// Repeats a proof's splits for a box of other delays: its multipliers still refute most parts.
BoxState TogetherSearch::refute_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole,
                                     int depth) {
  if (bench_.stopped()) return BoxState::stopped;
  Box box = whole;
  proof::Node why;
  if (!bench_.narrow(box, &why)) return bench_.leave(why);
  if (const auto* refuted = std::get_if<proof::Refuted>(&tree[node])) {
    if (bench_.draft().refutes(refuted->multipliers, box)) return bench_.close_by(refuted->multipliers);
  } else if (const auto* split = std::get_if<proof::Split>(&tree[node])) {
    const CornerBox& c = whole.corner(split->corner);
    const std::size_t first = node + 1, second = after(tree, first);
    const bool counts = among_[static_cast<std::size_t>(split->corner)] != 0;
    // The part that contains the whole range. For a corner that does not count any more: the part with more nodes.
    if (counts ? split->at >= (split->on_delay ? c.d2 : c.k2) : second - first >= after(tree, second) - second)
      return refute_like(tree, first, whole, depth);
    if (!counts || split->at < (split->on_delay ? c.d1 : c.k1)) return refute_like(tree, second, whole, depth);
    return both_like(tree, node, whole, depth);
  } else if (const auto* contour = std::get_if<proof::ContourSplit>(&tree[node])) {
    const CornerBox& c = whole.corner(contour->corner);
    const std::size_t first = node + 1, second = after(tree, first);
    const bool counts = among_[static_cast<std::size_t>(contour->corner)] != 0;
    if (counts && contour->at > c.c1 && contour->at < c.c2) return both_like(tree, node, whole, depth);
    // A corner that does not count any more, or a time outside its range.
    return refute_like(tree, !counts || contour->at >= c.c2 ? first : second, whole, depth);
  } else if (const auto* reversal = std::get_if<proof::ReversalSplit>(&tree[node])) {
    if (among_[static_cast<std::size_t>(reversal->corner)] == 0) return refute_like(tree, node + 1, whole, depth);
    return both_like(tree, node, whole, depth);
  } else if (std::holds_alternative<proof::ResponseSplit>(tree[node])) {
    return both_like(tree, node, whole, depth);
  }
  return refute(whole, depth);
}

BoxState TogetherSearch::both_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole,
                                   int depth) {
  bench_.draft().add(tree[node]);
  const auto [a, b] = parts(whole, tree[node]);
  const BoxState state = refute_like(tree, node + 1, a, depth + 1);
  return state == BoxState::closed ? refute_like(tree, after(tree, node + 1), b, depth + 1) : state;
}

TogetherSearch::Answer TogetherSearch::refute(int order, const std::vector<int>& most, long budget,
                                              const std::vector<proof::Node>& like, const std::vector<int>& from) {
  bench_.set_target(std::numeric_limits<double>::infinity());
  bench_.draft().take_tree();
  if (window_.order > 0) order = window_.order;
  Box box = bench_.root();
  box.order_most = order;
  among_.assign(box.corners.size(), 0);
  for (std::size_t j = 0; j < most.size(); ++j) {
    if (most[j] < 0) {
      if (!bench_.task().corners[j].delay)
        box.corners[j].d2 = order + settling + box.longer() + width_latency(bench_.task());
      box.corners[j].k2 = box.corners[j].d2 + order + 1 + box.longer();
      continue;
    }
    among_[j] = 1;
    box.corners[j].d2 = std::min(box.corners[j].d2, most[j]);
    if (!from.empty()) box.corners[j].d1 = std::max(box.corners[j].d1, from[j]);
    box.corners[j].k2 = box.corners[j].d2 + order + 1 + box.longer();
  }
  if (window_.order > 0) {
    const int anchor = window_.anchor(most);
    if (anchor < 0) return {};  // nothing to shift by
    box.order = order;
    box.window = true;
    CornerBox& c = box.corners[static_cast<std::size_t>(anchor)];
    c.k1 = c.k2 = window_.at[static_cast<std::size_t>(anchor)];
  }
  bench_.size_for(order);
  bench_.allow(budget);
  Answer answer;
  const BoxState state = like.empty() ? refute(std::move(box), 0) : refute_like(like, 0, box, 0);
  bench_.allow_all();
  answer.refuted = state == BoxState::closed;
  answer.holds = state == BoxState::found;
  answer.tree = bench_.draft().take_tree();
  return answer;
}

std::vector<char> TogetherSearch::corners_used(const std::vector<proof::Node>& tree) const {
  std::vector<char> used(bench_.task().corners.size(), 0);
  for (const proof::Node& node : tree) {
    if (const int split = corner_of(node); split >= 0) used[static_cast<std::size_t>(split)] = 1;
    const auto* refuted = std::get_if<proof::Refuted>(&node);
    if (refuted == nullptr) continue;
    for (const auto& [id, y] : multipliers()[static_cast<std::size_t>(refuted->multipliers)]) {
      if (const auto* width = std::get_if<proof::Width>(&id)) {
        for (const int corner : {width->within, width->before}) {
          if (among_[static_cast<std::size_t>(corner)]) used[static_cast<std::size_t>(corner)] = 1;
        }
      }
      // The error of a corner that does not count is in some linear programs, but it bounds nothing there.
      const int corner = corner_of(id);
      if (corner >= 0 && among_[static_cast<std::size_t>(corner)]) used[static_cast<std::size_t>(corner)] = 1;
    }
  }
  return used;
}

}  // namespace accdec::exact
