#include <algorithm>
#include <utility>

#include <accdec/exact/proof_draft.hpp>
#include <accdec/exact/window.hpp>

namespace accdec::exact {

void ProofDraft::begin() {
  proof_ = Proof{};
  recent_.clear();
  in_tree_.clear();
  refuted_corner_.clear();
}

int ProofDraft::keep(Multipliers y, CornerBox of) {
  proof_.multipliers.push_back(std::move(y));
  in_tree_.push_back(false);
  refuted_corner_.push_back(of);
  return static_cast<int>(proof_.multipliers.size()) - 1;
}

void ProofDraft::remember(int multipliers) {
  const auto old = std::find(recent_.begin(), recent_.end(), multipliers);
  if (old != recent_.end()) recent_.erase(old);
  recent_.insert(recent_.begin(), multipliers);
  if (recent_.size() <= lately_) return;
  // These multipliers belong to a split that was tried but not taken: nobody will ask for them again.
  const auto last = static_cast<std::size_t>(recent_.back());
  if (!in_tree_[last]) proof_.multipliers[last] = {};
  recent_.pop_back();
}

bool ProofDraft::refutes(int multipliers, const Box& box) const {
  const Multipliers& y = proof_.multipliers[static_cast<std::size_t>(multipliers)];
  return (box.window ? window_refutation(model_, y, box) : refutation(model_, y, box)) > 0.0;
}

int ProofDraft::refuted_before(const Box& box) const {
  const auto found = std::find_if(recent_.begin(), recent_.end(), [&](int y) { return refutes(y, box); });
  return found == recent_.end() ? -1 : *found;
}

void ProofDraft::close_by(int multipliers) {
  in_tree_[static_cast<std::size_t>(multipliers)] = true;
  remember(multipliers);
  add(proof::Refuted{multipliers});
}

void ProofDraft::forget(std::size_t from, const std::vector<proof::Node>& tree) {
  std::fill(in_tree_.begin() + static_cast<std::ptrdiff_t>(from), in_tree_.end(), false);
  for (const proof::Node& node : tree)
    if (const auto* refuted = std::get_if<proof::Refuted>(&node))
      in_tree_[static_cast<std::size_t>(refuted->multipliers)] = true;
  for (std::size_t i = from; i < in_tree_.size(); ++i) {
    const bool lately = std::find(recent_.begin(), recent_.end(), static_cast<int>(i)) != recent_.end();
    if (!in_tree_[i] && !lately) proof_.multipliers[i] = {};
  }
}

std::vector<proof::Node> ProofDraft::take_tree() {
  return std::exchange(proof_.tree, {});
}

Proof ProofDraft::take(double target) {
  Proof whole = std::exchange(proof_, {});
  whole.target = target;
  begin();
  return whole;
}

}  // namespace accdec::exact
