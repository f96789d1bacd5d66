#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/exact/joint_lemmas.hpp>
#include <accdec/exact/joint_tree.hpp>
#include <accdec/exact/together_search.hpp>

// Internal to the joint proof (joint.hpp): finds its lemmas.

namespace accdec::exact {

/// A node given to a prover, and what the prover found.
struct JointWork {
  int node = 0, order = 0, group = 0;
  bool undecided = false;  ///< rounding decides whether the node's smallest delays hold together
  std::optional<JointLemma> lemma;
  int extended = -1;                                ///< the lemma that it takes the place of; -1: it is new
  std::vector<std::pair<std::size_t, int>> failed;  ///< lemmas that do not extend, from which order on
  long spent = 0;                                   ///< linear programs
};

/// Proves lemmas with linear programs of its own, so its results depend only on its own earlier questions.
class LemmaProver {
 public:
  /// @param window  for filters of any order
  LemmaProver(const Task& task, const std::function<bool()>& stop, const Window& window, int number);

  /// For filters up to an order, or (wide) of any order.
  TogetherSearch& of(bool wide) { return wide ? any_ : some_; }
  const TogetherSearch& of(bool wide) const { return wide ? any_ : some_; }
  long linear_programs() const { return some_.linear_programs() + any_.linear_programs(); }

  /// A lemma of no corner: no filter up to this order holds the limits that are not tied to a delay.
  std::optional<JointLemma> no_filter_up_to(int order);
  /// Lemmas of one corner. A few linear programs through a window show as much for filters of any order as many linear
  /// programs do for short ones. Limits that a window does not see are examined with short filters.
  /// @param shorter  order of these @param known  a delay that some filter has
  std::vector<JointLemma> single_corner(std::size_t corner, int shorter, int known);
  /// Extends a lemma that settles something in the node, or asks whether the node's smallest delays hold together. The
  /// result is a lemma or a better design.
  void work_on(JointWork& work, const JointTree& tree, const JointLemmas& lemmas, double target);

 private:
  bool extend(JointWork& work, const JointTree& tree, const JointLemmas& lemmas);
  void check(JointWork& work, const JointTree& tree, double target);
  bool check_width(JointWork& work, const JointNode& at, double target);
  std::optional<JointLemma> longest_refuted(std::size_t corner, bool wide, int shorter, int low, int high);
  JointLemma learn(const JointNode& node, double room, bool wide, int order, std::vector<proof::Node> tree);
  void leave_out(std::vector<std::size_t>& corners, std::vector<int>& most, bool wide, int order, long budget,
                 std::vector<proof::Node>& tree);
  bool refutes(bool wide, int order, const std::vector<int>& most, long budget, std::vector<proof::Node>& tree);
  JointLemma lemma(bool wide, int order, const std::vector<int>& most, std::vector<proof::Node> tree) const;

  const Task& task_;
  std::function<bool()> stop_;
  LinearCost cost_;
  bool sees_all_;  ///< windows see every kind of limit there is
  int number_;
  TogetherSearch some_, any_;
};

}  // namespace accdec::exact
