#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/exact/joint_tree.hpp>

// Internal to the joint proof (joint.hpp): what it has learned.

namespace accdec::exact {

/// A proved statement, "no filter up to this order has delays up to these at these corners", and its proof. With one
/// in-position width also of delays from others on.
struct JointLemma {
  int order = 0;
  bool wide = false;  ///< of any order, through a window
  int prover = 0;     ///< whose multipliers the tree names
  std::vector<proof::CornerDelay> delays;
  std::vector<int> from{};  ///< least delays, one per corner; empty: any
  std::vector<proof::Node> tree;

  /// The longest delays it forbids, one per corner; < 0: the corner does not count.
  std::vector<int> most(std::size_t corners) const;
  int delay_at(int corner) const;
  /// Whether all delays of a node are at least its least ones.
  bool reaches(const JointNode& node) const;
};

/// All lemmas, in the order in which they were learned.
class JointLemmas {
 public:
  enum class Verdict {
    satisfied,  ///< says nothing about the node
    closed,     ///< forbids all of it
    unit,       ///< leaves longer delays of one corner
    violated    ///< leaves longer delays of one of several corners
  };
  /// A lemma applied to a node.
  struct Judgement {
    Verdict verdict = Verdict::satisfied;
    int corner = -1;        ///< unit, violated: the corner whose longer delay costs most
    double increase = 0.0;  ///< of the node's cost
  };

  explicit JointLemmas(const Task& task) : cost_(cost_of(task)) {}
  std::size_t size() const { return lemmas_.size(); }
  const JointLemma& operator[](std::size_t lemma) const { return lemmas_[lemma]; }
  Judgement judge(std::size_t lemma, const JointNode& node) const;

  void add(JointLemma lemma);
  /// Adds a lemma unless one from `known` on says as much.
  void add_new(JointLemma lemma, std::size_t known);
  /// Puts the same statement for longer filters in a lemma's place.
  void extend(std::size_t lemma, JointLemma longer);
  /// From this order on, attempts to extend the lemma do not pay.
  void give_up(std::size_t lemma, int order) { fails_[lemma] = order; }
  bool given_up(std::size_t lemma, int order) const { return fails_[lemma] <= order; }

 private:
  LinearCost cost_;
  std::vector<JointLemma> lemmas_;
  std::vector<int> fails_;  ///< by lemma
};

}  // namespace accdec::exact
