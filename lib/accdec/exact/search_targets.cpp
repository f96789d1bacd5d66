#include <algorithm>
#include <cmath>

#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

// What one proof passes on to the proof of the next target.

namespace accdec::exact {
namespace {

double value_of_one(const Task& task, int order, int delay) {
  return cost_of(task)(order, {delay});
}

/// Number of nodes for the parts of this node.
int parts_of(const proof::Node& node) {
  const bool two = std::holds_alternative<proof::Split>(node) || std::holds_alternative<proof::OrderSplit>(node) ||
                   std::holds_alternative<proof::ResponseSplit>(node) ||
                   std::holds_alternative<proof::SymmetricOrders>(node);
  return two ? 2 : 0;
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
  budget_end_ = linear_programs() + budget;
  const Answer answer = search(target);
  budget_end_ = std::numeric_limits<long>::max();
  by_chords_ = false;
  return answer;
}

Search::Answer Search::search(double target) {
  target_ = target;
  draft_.begin();
  Box box = root();
  if (tighten(task_, target, box)) size_for(box.order);
  std::size_t next = 0;
  // With several corners, splits that were right for one target are wrong for the next: their budget differs.
  const bool again = task_.corners.size() == 1 && !going_on_ && !proof.tree.empty() && proof.target <= target;
  const State state = again ? refute_again(root(), next) : refute(root());
  if (state == State::found) return Answer::found;
  if (state == State::open) return Answer::open;
  if (state == State::stopped) return Answer::unknown;
  Proof written = draft_.take(target_);
  if (target_ < target) {
    auto shorter = pruned(model_, root(), written);
    if (!shorter) return going_on_ && by_chords_ ? Answer::unknown : below(target_);
    written = std::move(*shorter);
  }
  proof = std::move(written);
  return Answer::proved;
}

/// After something was found in a box: lowers the target to it and looks at the box again.
Search::State Search::go_on(State state, const Box& box) {
  if (state != State::found || !going_on_) return state;
  const double reached = std::min(best ? best->value : unlimited, reached_);
  if (!(reached < target_)) return state;
  target_ = reached;
  return refute(box);
}

/// A single delay and sample that the chords do not refute: the shortest value there limits what the chords can prove.
Search::State Search::reach_by_chords(const Box& box, const Outcome& outcome) {
  if (outcome.kind != Outcome::feasible) return undecided();
  const Filter filter = trimmed(*outcome.filter, task_);
  reached_ = std::min(reached_, value_of_one(task_, filter.order(), box.corners.front().d1));
  return State::found;
}

/// Repeats the last proof's splits for a longer target: its multipliers still refute most of the boxes.
/// @param next  of its nodes
Search::State Search::refute_again(const Box& whole, std::size_t& next) {
  if (stopped()) return State::stopped;
  const proof::Node& node = proof.tree[next++];
  const auto* refuted = std::get_if<proof::Refuted>(&node);
  const auto* split = std::get_if<proof::Split>(&node);
  const auto skip = [&] {
    for (int left = parts_of(node); left > 0; --left) left += parts_of(proof.tree[next++]);
  };
  Box box = whole;
  proof::Node why;
  if (!narrow(box, &why)) {
    skip();
    return leave(why);
  }
  if (split != nullptr) {
    draft_.add(node);
    const auto [first, second] = parts(whole, *split);
    return both(refute_again(first, next), [&, part = &second] { return refute_again(*part, next); });
  }
  skip();
  if (refuted == nullptr) return refute(whole);
  const Multipliers& y = proof.multipliers[static_cast<std::size_t>(refuted->multipliers)];
  if (refutation(model_, y, box) > 0.0) return close_by(draft_.keep(y));
  return refute(whole);
}

}  // namespace accdec::exact
