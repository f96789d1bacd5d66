#include <accdec/exact/joint.hpp>
#include <accdec/files/side_by_side.hpp>

// The start of the joint proof: the least order, and lemmas of single corners.

namespace accdec::exact {

/// Excludes the orders that no filter has.
void Joint::begin() {
  for (int none = least_ - 1; none >= tree_[0].n1 && none >= least_ - 3 && !stop_(); --none) {
    auto lemma = provers_[0]->no_filter_up_to(none);
    if (!lemma) continue;
    lemmas_.add(std::move(*lemma));
    tree_.split(0, -1, none);
    tree_[1].lemma = 0;
    tip_ = 2;
    break;
  }
  begun_ = tip_ != 0 || !stop_();
}

/// From here on, nodes of short and of long filters are separate.
void Joint::branch() {
  branched_ = true;
  if (tree_.most_short() >= task_.design.order_max || tree_[tip_].n1 > tree_.most_short()) return tree_.push(tip_, 0.0);
  tree_.split(tip_, -1, tree_.most_short());
  const int first = tree_[tip_].first, second = tree_[tip_].second;
  tree_.push(first, 0.0);
  tree_.push(second, 0.0);
}

/// Finds the first lemmas of the next few corners. Together these lemmas are a first bound.
void Joint::first_lemmas() {
  const std::size_t count = std::min(provers_.size(), task_.corners.size() - next_corner_);
  const int shorter = std::min(task_.design.order_max, least_ + least_ / 4 + 2);
  std::vector<std::vector<JointLemma>> found(count);
  share();
  side_by_side(count, threads_, [&](std::size_t i) {
    const std::size_t j = next_corner_ + i;
    found[i] = provers_[i]->single_corner(j, shorter, designs_.best->delays[j]);
  });
  share();
  if (stop_()) return;
  for (std::vector<JointLemma>& lemmas : found) {
    for (JointLemma& lemma : lemmas) {
      const bool wide = lemma.wide;
      const proof::CornerDelay at = lemma.delays.front();
      lemmas_.add(std::move(lemma));
      if (wide) close_first(static_cast<int>(lemmas_.size()) - 1, at);
    }
  }
  next_corner_ += count;
}

/// Splits the open node at a delay that a lemma forbids.
void Joint::close_first(int lemma, const proof::CornerDelay& at) {
  const JointNode& open = tree_[tip_];
  const auto j = static_cast<std::size_t>(at.corner);
  if (at.delay < open.d1[j] || at.delay >= open.d2[j]) return;
  tree_.split(tip_, at.corner, at.delay);
  tree_[tree_[tip_].first].lemma = lemma;
  tip_ = tree_[tip_].second;
}

}  // namespace accdec::exact
