#include <limits>

#include <accdec/exact/joint_prover.hpp>

// Writes the joint proof in the form of a certificate: a tree in preorder, and the lemmas it needs.

namespace accdec::exact {

/// Index of a prover's first multipliers among all provers' multipliers.
int Joint::first_multipliers(int number, bool wide) const {
  std::size_t before = 0;
  for (const auto& prover : provers_) {
    if (prover->number < number || (prover->number == number && wide)) before += prover->some.multipliers().size();
    if (prover->number < number) before += prover->any.multipliers().size();
  }
  return static_cast<int>(before);
}

/// Closes a node by a lemma; the lemma gets its number in the proof at its first use.
bool Joint::write_by(int lemma, Proof& proof, std::vector<int>& number) const {
  int& n = number[static_cast<std::size_t>(lemma)];
  if (n < 0) {
    const Lemma& from = lemmas_[static_cast<std::size_t>(lemma)];
    proof::Lemma to;
    to.delays = from.delays;
    to.tree = from.tree;
    if (from.wide) {
      std::vector<int> most(task_.corners.size(), -1);
      for (const proof::CornerDelay& d : from.delays) most[static_cast<std::size_t>(d.corner)] = d.delay;
      const int anchor = window_.anchor(most);
      to.window = proof::Window{window_.order, anchor, window_.at[static_cast<std::size_t>(anchor)]};
    } else {
      to.order = from.order;
    }
    for (proof::Node& node : to.tree)
      if (auto* refuted = std::get_if<proof::Refuted>(&node))
        refuted->multipliers += first_multipliers(from.prover, from.wide);
    n = static_cast<int>(proof.lemmas.size());
    proof.lemmas.push_back(std::move(to));
  }
  proof.tree.push_back(proof::ByLemma{n});
  return true;
}

/// @param index  -1: the tree ends here; lemmas must close the part
bool Joint::write(int index, Node part, Proof& proof, std::vector<int>& number) const {
  Node cut = part;
  const int order = order_left(cut, proof.target);
  if (order < 0) {
    proof.tree.push_back(proof::TooLong{});
    return true;
  }
  const Node* from = index >= 0 ? &nodes_[static_cast<std::size_t>(index)] : nullptr;
  if (from != nullptr && from->lemma >= 0) return write_by(from->lemma, proof, number);
  int corner = -1, at = 0, first = -1, second = -1;
  if (from != nullptr && from->first >= 0) {
    corner = from->corner, at = from->at, first = from->first, second = from->second;
  } else {
    int l = -1;
    for (std::size_t i = 0; i < lemmas_.size() && l < 0; ++i) {
      double increase = 0.0;
      if (lemmas_[i].order < order) continue;
      const Verdict verdict = judge(lemmas_[i], cut, &corner, &increase);
      if (verdict == Verdict::closed) return write_by(static_cast<int>(i), proof, number);
      if (verdict != Verdict::satisfied) l = static_cast<int>(i);
    }
    if (l < 0) return false;
    for (const proof::CornerDelay& d : lemmas_[static_cast<std::size_t>(l)].delays)
      if (d.corner == corner) at = d.delay;
  }
  Node a = part, b = part;
  if (corner < 0) {
    a.n2 = at, b.n1 = at + 1;
    proof.tree.push_back(proof::OrderSplit{at});
  } else {
    a.d2[static_cast<std::size_t>(corner)] = at;
    b.d1[static_cast<std::size_t>(corner)] = at + 1;
    proof.tree.push_back(proof::Split{corner, true, at});
  }
  return write(first, std::move(a), proof, number) && write(second, std::move(b), proof, number);
}

std::optional<Proof> Joint::proof() const {
  Proof proof;
  proof.target = bound();
  for (const auto& prover : provers_) {
    for (const bool wide : {false, true}) {
      const auto& all = prover->of(wide).multipliers();
      proof.multipliers.insert(proof.multipliers.end(), all.begin(), all.end());
    }
  }
  std::vector<int> number(lemmas_.size(), -1);
  if (!write(0, root_node(task_), proof, number)) return std::nullopt;
  return proof;
}

}  // namespace accdec::exact
