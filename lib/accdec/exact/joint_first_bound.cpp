#include <limits>

#include <accdec/exact/joint.hpp>

// What the joint proof begins with: the least order, and lemmas of single corners.

namespace accdec::exact {

/// The orders that no filter has.
void Joint::begin() {
  std::vector<proof::Node> tree;
  const std::vector<int> all(task_.corners.size(), -1);
  for (int none = least_ - 1; none >= node(0).n1 && none >= least_ - 3 && !stop_(); --none) {
    if (!refutes(false, none, all, 2000, tree)) continue;
    add(lemma(false, none, all, std::move(tree)));
    split(0, -1, none);
    node(1).lemma = 0;
    tip_ = 2;
    break;
  }
  begun_ = tip_ != 0 || !stop_();
}

/// From here on there are nodes of short and of long filters.
void Joint::branch() {
  branched_ = true;
  if (short_ >= task_.design.order_max || node(tip_).n1 > short_) return push(tip_, 0.0);
  split(tip_, -1, short_);
  const int first = node(tip_).first, second = node(tip_).second;
  push(first, 0.0);
  push(second, 0.0);
}

/// A lemma of one corner: the longest delay above `low` that it cannot have, by bisection. Its number; -1: none.
int Joint::longest_refuted(std::size_t j, bool wide, int low) {
  const int shorter = std::min(task_.design.order_max, least_ + least_ / 4 + 2);
  std::vector<int> most(task_.corners.size(), -1);
  std::vector<proof::Node> tree, best;
  // The best design's delay holds, if not with this order then with its own.
  int high = std::min(designs_.best->delays[j], shorter + 2);
  const long budget = wide ? 200 : std::numeric_limits<long>::max() / 2;
  while (high - low > 1 && !stop_()) {
    most[j] = low + (high - low) / 2;
    if (refutes(wide, shorter, most, budget, tree)) {
      low = most[j];
      best = std::move(tree);
    } else {
      high = most[j];
    }
  }
  if (best.empty()) return -1;
  most[j] = low;
  add(lemma(wide, shorter, most, std::move(best)));
  return static_cast<int>(lemmas_.size()) - 1;
}

/// Lemmas of one corner through a window, where a few linear programs show as much of filters of any order as many do
/// of short ones. Together they are a first bound. What a window does not see is asked of short filters.
void Joint::single_corner(std::size_t j) {
  if (task_.corners[j].delay) return;
  share();
  int low = -1;
  if (task_.corners[j].error_max) {
    const int by = longest_refuted(j, true, -1);
    if (by >= 0) {
      const proof::CornerDelay at = lemmas_[static_cast<std::size_t>(by)].delays.front();
      close_first(by, at);
      low = at.delay;
    }
  }
  if (!sees_all_ || !task_.corners[j].error_max) longest_refuted(j, false, low);
}

/// Splits the open node at a delay that a lemma says no filter has.
void Joint::close_first(int lemma, const proof::CornerDelay& at) {
  const Node& open = node(tip_);
  const auto j = static_cast<std::size_t>(at.corner);
  if (at.delay < open.d1[j] || at.delay >= open.d2[j]) return;
  split(tip_, at.corner, at.delay);
  node(node(tip_).first).lemma = lemma;
  tip_ = node(tip_).second;
}

}  // namespace accdec::exact
