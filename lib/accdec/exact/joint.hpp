#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <accdec/exact/joint_lemmas.hpp>
#include <accdec/exact/joint_tree.hpp>
#include <accdec/exact/lemma_prover.hpp>
#include <accdec/exact/together_search.hpp>

namespace accdec::exact {

/// The proof for several corners that share a filter, by branch and check. A master tree over the delays (JointTree)
/// takes the cheapest delays that no lemma forbids. A search over the samples (TogetherSearch)
/// then looks for a filter with these delays. It finds one, which is a better design, or it proves that there is none.
/// Such a proof is reduced to the corners it needs, and its delays are raised as far as it still holds. The result is a
/// lemma: "no filter up to this order has delays up to these at these corners". A lemma holds everywhere in the tree.
/// For expensive delays the target leaves only short filters, so lemmas of small orders refute nodes late in the tree.
///
/// A few nodes are worked on at a time, each by its own prover. Their results are joined in the order of the nodes, so
/// design and proof do not depend on the number of threads. The first bound, from single corners, is in
/// joint_first_bound.cpp, and the proof in joint_proof.cpp.
class Joint {
 public:
  /// @param designs  holds the best design known, finite; better ones are put there
  /// @param least  smallest order that holds the limits not tied to a tolerance
  /// @param stop  polled from all threads
  Joint(const Task& task, Designs& designs, int least, std::function<bool()> stop);
  void use_threads(int threads) { threads_ = threads; }

  enum class State { proved, going_on, stopped, open };
  /// Does one step: a few single corners, or a few nodes of the tree. @return proved: nothing is shorter than the best
  /// design
  State step();
  /// Whether `bound` includes the bound of every single corner.
  bool has_first_bound() const { return next_corner_ == task_.corners.size(); }
  /// Lower bound on all designs, in samples.
  double bound() const;
  /// Proof that nothing is shorter than `bound()`; none if that is not proved yet.
  std::optional<Proof> proof() const;
  long lemmas() const { return static_cast<long>(lemmas_.size()); }
  long linear_programs() const;

 private:
  double target() const { return designs_.best->value; }
  void begin();
  void first_lemmas();
  void close_first(int lemma, const proof::CornerDelay& at);
  void branch();
  std::vector<JointWork> next_works();
  std::optional<JointWork> settle(const JointTree::Next& next);
  void join(JointWork& work, std::size_t known);
  void share();

  const Task& task_;
  Designs& designs_;
  std::function<bool()> stop_;
  Window window_;
  std::vector<std::unique_ptr<LemmaProver>> provers_;
  int threads_ = 1;
  int least_;
  JointTree tree_;
  JointLemmas lemmas_;
  double undecided_;
  bool begun_ = false;
  int tip_ = 0;  ///< until `branch`: the only node that is open
  std::size_t next_corner_ = 0;
  bool branched_ = false;
};

}  // namespace accdec::exact
