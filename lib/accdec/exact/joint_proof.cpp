#include <accdec/exact/joint.hpp>

// Writes the joint proof in the form of a certificate: a tree in preorder, and the lemmas it needs.

namespace accdec::exact {
namespace {

class JointProofWriter {
 public:
  JointProofWriter(const JointTree& tree, const JointLemmas& lemmas,
                   const std::vector<std::unique_ptr<LemmaProver>>& provers, const Window& window, double target)
      : tree_(tree), lemmas_(lemmas), provers_(provers), window_(window), number_(lemmas.size(), -1) {
    proof_.target = target;
    for (const auto& prover : provers_) {
      for (const bool wide : {false, true}) {
        const auto& all = prover->of(wide).multipliers();
        first_multipliers_.push_back(static_cast<int>(proof_.multipliers.size()));
        proof_.multipliers.insert(proof_.multipliers.end(), all.begin(), all.end());
      }
    }
  }

  /// None: a part is not closed by lemmas.
  std::optional<Proof> write(const JointNode& root) {
    if (!write(0, root)) return std::nullopt;
    return std::move(proof_);
  }

 private:
  /// @param index  -1: the tree ends here; lemmas must close the part
  bool write(int index, const JointNode& part) {
    JointNode cut = part;
    const int order = tree_.order_left(cut, proof_.target);
    if (order < 0) {
      proof_.tree.push_back(proof::TooLong{});
      return true;
    }
    const JointNode* from = index >= 0 ? &tree_[index] : nullptr;
    if (from != nullptr && from->lemma >= 0) return write_by(static_cast<std::size_t>(from->lemma));
    int corner = -1, at = 0, first = -1, second = -1;
    if (from != nullptr && from->first >= 0) {
      corner = from->corner, at = from->at, first = from->first, second = from->second;
    } else {
      JointLemmas::Judgement is;
      std::size_t l = 0;
      for (; l < lemmas_.size(); ++l) {
        if (lemmas_[l].order < order) continue;
        is = lemmas_.judge(l, cut);
        if (is.verdict == JointLemmas::Verdict::closed) return write_by(l);
        if (is.verdict != JointLemmas::Verdict::satisfied) break;
      }
      if (l == lemmas_.size()) return false;
      corner = is.corner, at = lemmas_[l].delay_at(corner);
    }
    if (corner < 0)
      proof_.tree.push_back(proof::OrderSplit{at});
    else
      proof_.tree.push_back(proof::Split{corner, true, at});
    const auto [a, b] = part.parts(corner, at);
    return write(first, a) && write(second, b);
  }

  /// Closes a node by a lemma; the lemma gets its number in the proof at its first use.
  bool write_by(std::size_t lemma) {
    int& n = number_[lemma];
    if (n < 0) {
      n = static_cast<int>(proof_.lemmas.size());
      proof_.lemmas.push_back(written(lemmas_[lemma]));
    }
    proof_.tree.push_back(proof::ByLemma{n});
    return true;
  }

  proof::Lemma written(const JointLemma& from) const {
    proof::Lemma to;
    to.delays = from.delays;
    to.tree = from.tree;
    for (std::size_t j = 0; j < from.from.size(); ++j) to.from.push_back({static_cast<int>(j), from.from[j]});
    if (from.wide) {
      const int anchor = window_.anchor(from.most(window_.at.size()));
      to.window = proof::Window{window_.order, anchor, window_.at[static_cast<std::size_t>(anchor)]};
    } else {
      to.order = from.order;
    }
    const int before = first_multipliers_[static_cast<std::size_t>(2 * from.prover + (from.wide ? 1 : 0))];
    for (proof::Node& node : to.tree)
      if (auto* refuted = std::get_if<proof::Refuted>(&node)) refuted->multipliers += before;
    return to;
  }

  const JointTree& tree_;
  const JointLemmas& lemmas_;
  const std::vector<std::unique_ptr<LemmaProver>>& provers_;
  const Window& window_;
  std::vector<int> number_;             ///< by lemma: in the proof; -1: it has none yet
  std::vector<int> first_multipliers_;  ///< by prover, for filters up to an order and of any order
  Proof proof_;
};

}  // namespace

std::optional<Proof> Joint::proof() const {
  return JointProofWriter(tree_, lemmas_, provers_, window_, bound()).write(JointTree::root(task_));
}

}  // namespace accdec::exact
