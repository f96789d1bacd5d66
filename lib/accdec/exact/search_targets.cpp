#include <algorithm>
#include <cmath>

#include <accdec/exact/parts.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

// One proof passes its tree on to the proof of the next target.

namespace accdec::exact {
namespace {

double value_of_one(const Task& task, int order, int delay) {
  return cost_of(task)(order, {delay});
}

/// Number of nodes for the parts of this node.
int parts_of(const proof::Node& node) {
  return splits(node) ? 2 : 0;
}

}  // namespace

Search::Answer Search::below(double target) {
  going_on_ = false;
  return search(target);
}

Search::Answer Search::minimise(double target, long budget) {
  going_on_ = task_.corners.size() == 1;
  by_chords_ = going_on_ && (!model_.convex() || task_.design.symmetric);
  reached_ = unlimited;
  bench_.allow(budget);
  const Answer answer = search(target);
  bench_.allow_all();
  by_chords_ = false;
  return answer;
}

Search::Answer Search::search(double target) {
  bench_.aim(target);
  std::size_t next = 0;
  // With several corners, splits that were right for one target are wrong for the next: their budget differs.
  const bool again = task_.corners.size() == 1 && !going_on_ && !proof.tree.empty() && proof.target <= target;
  const BoxState state = again ? refute_again(bench_.root(), next) : refute(bench_.root());
  if (state == BoxState::found) return Answer::found;
  if (state == BoxState::open) return Answer::open;
  if (state == BoxState::stopped) return Answer::unknown;
  Proof written = draft_.take(bench_.target());
  if (bench_.target() < target) {
    auto shorter = pruned(model_, bench_.root(), written);
    if (!shorter) return going_on_ && by_chords_ ? Answer::unknown : below(bench_.target());
    written = std::move(*shorter);
  }
  proof = std::move(written);
  return Answer::proved;
}

/// After something was found in a box: lowers the target to it and looks at the box again.
BoxState Search::go_on(BoxState state, const Box& box) {
  if (state != BoxState::found || !going_on_) return state;
  const double reached = std::min(designs_.best ? designs_.best->value : unlimited, reached_);
  if (!(reached < bench_.target())) return state;
  bench_.set_target(reached);
  return refute(box);
}

/// A single delay and sample that the chords do not refute: the shortest value there limits what the chords can prove.
BoxState Search::reach_by_chords(const Box& box, const Outcome& outcome) {
  if (outcome.kind != Outcome::feasible) return bench_.undecided();
  const Filter filter = trimmed(*outcome.filter, task_);
  reached_ = std::min(reached_, value_of_one(task_, filter.order(), box.corners.front().d1));
  return BoxState::found;
}

/// Repeats the last proof's splits for a longer target: its multipliers still refute most of the boxes.
/// @param next  of its nodes
BoxState Search::refute_again(const Box& whole, std::size_t& next) {
  if (bench_.stopped()) return BoxState::stopped;
  const proof::Node& node = proof.tree[next++];
  const auto* refuted = std::get_if<proof::Refuted>(&node);
  const auto skip = [&] {
    for (int left = parts_of(node); left > 0; --left) left += parts_of(proof.tree[next++]);
  };
  Box box = whole;
  proof::Node why;
  if (!bench_.narrow(box, &why)) {
    skip();
    return bench_.leave(why);
  }
  if (splits_corner(node)) {
    draft_.add(node);
    const auto [first, second] = parts(whole, node);
    return both(refute_again(first, next), [&, part = &second] { return refute_again(*part, next); });
  }
  skip();
  if (refuted == nullptr) return refute(whole);
  const Multipliers& y = proof.multipliers[static_cast<std::size_t>(refuted->multipliers)];
  if (refutation(model_, y, box) > 0.0) return bench_.close_by(draft_.keep(y));
  return refute(whole);
}

}  // namespace accdec::exact
