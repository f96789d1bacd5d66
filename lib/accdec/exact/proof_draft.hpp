#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/relaxation.hpp>

namespace accdec::exact {

/// Proof that nothing is shorter than `target`: a binary tree over boxes, in preorder.
struct Proof {
  double target = 0.0;  ///< in samples of the task's objective (objective.hpp); infinite: nothing at all
  std::vector<proof::Node> tree;
  std::vector<Multipliers> multipliers;
  std::vector<proof::Lemma> lemmas{};
  std::vector<std::string> conflict{};  ///< where there is no design: the limits in conflict, in words
};

/// A proof that a search writes, node by node. Multipliers are referred to by their numbers. Those used lately are
/// tried on every new box, as they often refute it, too.
class ProofDraft {
 public:
  /// @param model  the reference is kept  @param lately  how many multipliers count as used lately
  ProofDraft(const LimitModel& model, std::size_t lately) : model_(model), lately_(lately) {}

  void begin();
  void add(proof::Node node) { proof_.tree.push_back(std::move(node)); }
  /// Adds a leaf that these multipliers refute, and remembers them.
  void close_by(int multipliers);
  /// @param of  the corner of the box they refute, where there is one corner
  int keep(Multipliers y, CornerBox of = {.k1 = 1});
  /// Counts them as used lately. Multipliers of no leaf are forgotten when others push them out.
  void remember(int multipliers);
  /// Forgets multipliers from this one on, except those of a proof and some used lately.
  void forget(std::size_t from, const std::vector<proof::Node>& tree);

  bool refutes(int multipliers, const Box& box) const;
  /// Multipliers used lately that refute the box, too; -1: none.
  int refuted_before(const Box& box) const;
  /// The first samples of one corner's range, up to `last`.
  struct Beginning {
    int last, multipliers;
  };
  /// The beginning that the multipliers of other samples refute, if there is one. In proof_draft_shifted.cpp.
  std::optional<Beginning> refuted_beginning(const Box& box);

  const std::vector<Multipliers>& multipliers() const { return proof_.multipliers; }
  /// The tree so far; the next one begins without nodes but keeps the multipliers.
  std::vector<proof::Node> take_tree();
  /// The whole proof.
  Proof take(double target);

 private:
  const LimitModel& model_;
  std::size_t lately_;
  Proof proof_;
  std::vector<int> recent_;                ///< multipliers, the last used first
  std::vector<CornerBox> refuted_corner_;  ///< of the multipliers: see `keep`
  std::vector<bool> in_tree_;              ///< of the multipliers: whether a leaf of the proof uses them
};

}  // namespace accdec::exact
