#pragma once

#include <array>
#include <optional>
#include <queue>
#include <vector>

#include <accdec/exact/servo_ramps.hpp>
#include <accdec/task.hpp>
#include <accdec/task/objective.hpp>

// Internal to the joint proof (joint.hpp): its master tree.

namespace accdec::exact {

/// A part of all designs, by delays and orders, and what became of it.
struct JointNode {
  std::vector<int> d1, d2;  ///< while it is open
  int n1 = 0, n2 = 0;       ///< orders
  int corner = -1, at = 0;  ///< split; corner -1: on the order
  int first = -1, second = -1;
  int lemma = -1;  ///< closed by it

  /// The parts of a split, without numbers.
  std::pair<JointNode, JointNode> parts(int corner, int at) const;
};

/// The parts of all designs, and the open ones by what their cheapest design costs. Short and long filters have queues
/// of their own.
class JointTree {
 public:
  /// @param most_short  largest order of a short filter
  JointTree(const Task& task, int most_short);
  /// All delays and orders that the task allows.
  static JointNode root(const Task& task);

  JointNode& operator[](int node) { return nodes_[static_cast<std::size_t>(node)]; }
  const JointNode& operator[](int node) const { return nodes_[static_cast<std::size_t>(node)]; }
  int most_short() const { return most_short_; }
  /// The cost of the cheapest design in the node, whether there is a filter for it or not.
  double cost(const JointNode& node) const { return cost_(node.n1, node.d1); }
  /// The largest order of a design in the node that is shorter than the target; -1: none. Cuts delays that no such
  /// design can have.
  int order_left(JointNode& node, double target) const;
  /// The parts become the node's `first` and `second`.
  void split(int node, int corner, int at);

  /// Opens a node. @param increase  of its cost, known from lemmas
  void push(int node, double increase);
  /// Opens a node if another one is cheaper now. False: it is still the next.
  bool put_back(int node, double increase, double before);
  struct Next {
    double bound;
    int node, group;
  };
  /// Closes and returns the next node; none: no open node is below the target. Short filters come first, because lemmas
  /// learned there usually hold for long filters too. But long ones also get a share.
  std::optional<Next> take_next(double target);
  /// Linear programs that nodes of a group took.
  void charge(int group, long linear_programs) { spent_[static_cast<std::size_t>(group)] += linear_programs; }
  /// The least of all open nodes; infinity: there is none.
  double least_bound() const;

 private:
  struct Open {
    double bound;
    int node;
    bool operator<(const Open& other) const { return bound != other.bound ? bound > other.bound : node < other.node; }
  };
  std::size_t group_of(int node) const { return (*this)[node].n1 > most_short_ ? 1 : 0; }

  /// Delays by one in-position width: cuts those that no width gives beside the others.
  void order(JointNode& node) const;

  const Task& task_;
  LinearCost cost_;
  ServoRamps ramps_;
  int most_short_;
  std::vector<JointNode> nodes_;
  std::array<std::priority_queue<Open>, 2> open_;  ///< short filters, long filters
  std::array<long, 2> spent_{};                    ///< linear programs
};

}  // namespace accdec::exact
