#include <limits>

#include <accdec/exact/joint_prover.hpp>
#include <accdec/files/side_by_side.hpp>

// The start of the joint proof: the least order, and lemmas of single corners.

namespace accdec::exact {

/// Excludes the orders that no filter has.
void Joint::begin() {
  std::vector<proof::Node> tree;
  const std::vector<int> all(task_.corners.size(), -1);
  for (int none = least_ - 1; none >= node(0).n1 && none >= least_ - 3 && !stop_(); --none) {
    if (!refutes(*provers_[0], false, none, all, 2000, tree)) continue;
    add(lemma(*provers_[0], false, none, all, std::move(tree)));
    split(0, -1, none);
    node(1).lemma = 0;
    tip_ = 2;
    break;
  }
  begun_ = tip_ != 0 || !stop_();
}

/// From here on, nodes of short and of long filters are separate.
void Joint::branch() {
  branched_ = true;
  if (short_ >= task_.design.order_max || node(tip_).n1 > short_) return push(tip_, 0.0);
  split(tip_, -1, short_);
  const int first = node(tip_).first, second = node(tip_).second;
  push(first, 0.0);
  push(second, 0.0);
}

/// A lemma of one corner: the longest delay above `low` that no filter has, by bisection.
std::optional<Joint::Lemma> Joint::longest_refuted(Prover& prover, std::size_t j, bool wide, int low) const {
  const int shorter = std::min(task_.design.order_max, least_ + least_ / 4 + 2);
  std::vector<int> most(task_.corners.size(), -1);
  std::vector<proof::Node> tree, best;
  // The best design's delay holds, perhaps with another order only.
  int high = std::min(designs_.best->delays[j], shorter + 2);
  const long budget = wide ? 200 : std::numeric_limits<long>::max() / 2;
  while (high - low > 1 && !stop_()) {
    most[j] = low + (high - low) / 2;
    if (refutes(prover, wide, shorter, most, budget, tree)) {
      low = most[j];
      best = std::move(tree);
    } else {
      high = most[j];
    }
  }
  if (best.empty()) return std::nullopt;
  most[j] = low;
  return lemma(prover, wide, shorter, most, std::move(best));
}

/// Lemmas of one corner. A few linear programs through a window show as much for filters of any order as many linear
/// programs do for short ones. Together these lemmas are a first bound. Limits that a window does not see are examined
/// with short filters.
std::vector<Joint::Lemma> Joint::single_corner(Prover& prover, std::size_t j) const {
  std::vector<Lemma> lemmas;
  if (task_.corners[j].delay) return lemmas;
  int low = -1;
  if (task_.corners[j].error_max) {
    if (auto found = longest_refuted(prover, j, true, -1)) {
      low = found->delays.front().delay;
      lemmas.push_back(std::move(*found));
    }
  }
  if (!sees_all_ || !task_.corners[j].error_max) {
    if (auto found = longest_refuted(prover, j, false, low)) lemmas.push_back(std::move(*found));
  }
  return lemmas;
}

/// Finds the first lemmas of the next few corners.
void Joint::first_lemmas() {
  const std::size_t count = std::min(provers_.size(), task_.corners.size() - next_corner_);
  std::vector<std::vector<Lemma>> found(count);
  share();
  side_by_side(count, threads_, [&](std::size_t i) { found[i] = single_corner(*provers_[i], next_corner_ + i); });
  share();
  if (stop_()) return;
  for (std::vector<Lemma>& lemmas : found) {
    for (Lemma& lemma : lemmas) {
      const bool wide = lemma.wide;
      const proof::CornerDelay at = lemma.delays.front();
      add(std::move(lemma));
      if (wide) close_first(static_cast<int>(lemmas_.size()) - 1, at);
    }
  }
  next_corner_ += count;
}

/// Splits the open node at a delay that a lemma forbids.
void Joint::close_first(int lemma, const proof::CornerDelay& at) {
  const Node& open = node(tip_);
  const auto j = static_cast<std::size_t>(at.corner);
  if (at.delay < open.d1[j] || at.delay >= open.d2[j]) return;
  split(tip_, at.corner, at.delay);
  node(node(tip_).first).lemma = lemma;
  tip_ = node(tip_).second;
}

}  // namespace accdec::exact
