#pragma once

#include <functional>
#include <queue>
#include <vector>

#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {

/// The proof for several corners that share a filter: branch and check. A master tree over the delays takes the
/// cheapest delays that nothing known forbids. A search over the samples ("together", Search::refute_together) either
/// finds a filter for them, which is a better design, or a proof that there is none. Such a proof is cut down to the
/// corners it needs and its delays are raised as far as it goes; what is left is a lemma, "no filter up to this order
/// has these corners' delays at most so", that holds everywhere else in the tree, too. The target leaves dear delays
/// only short filters, so nodes late in the tree are refuted by lemmas of small orders.
class Joint {
 public:
  /// @param designs  holds the best design known, finite; better ones are put there
  /// @param least  smallest order that holds the limits not tied to a tolerance
  Joint(const Task& task, Search& designs, int least, std::function<bool()> stop);

  enum class State { proved, going_on, stopped, open };
  /// One step: a corner by itself, or a node of the tree. @return proved: nothing is shorter than the best design
  State step();
  /// Whether `bound` knows what each corner asks for by itself.
  bool has_first_bound() const { return next_corner_ == task_.corners.size(); }
  /// Nothing is shorter, samples.
  double bound() const;
  /// That nothing is shorter than `bound()`; none if that is not proved yet.
  std::optional<Proof> proof() const;
  long lemmas() const { return static_cast<long>(lemmas_.size()); }
  long nodes() const { return static_cast<long>(nodes_.size()); }
  long linear_programs() const { return prover_.linear_programs() + wide_.linear_programs(); }

 private:
  struct Node {
    std::vector<int> d1, d2;  ///< while it is open
    int n1 = 0, n2 = 0;       ///< orders
    int corner = -1, at = 0;  ///< split; corner -1: on the order
    int first = -1, second = -1;
    int lemma = -1;  ///< closed by it
  };
  struct Open {
    double bound;
    int node;
    bool operator<(const Open& other) const { return bound != other.bound ? bound > other.bound : node < other.node; }
  };
  /// What is proved, and for which orders.
  struct Lemma {
    int order = 0;
    bool wide = false;  ///< of any order, through a window
    std::vector<proof::CornerDelay> delays;
    std::vector<proof::Node> tree;
  };
  enum class Verdict { satisfied, closed, unit, violated };

  double target() const { return designs_.best->value; }
  Node& node(int index) { return nodes_[static_cast<std::size_t>(index)]; }
  double cost(const Node& node) const;
  int order_left(Node& node, double target) const;
  Verdict judge(const Lemma& lemma, const Node& node, int* open_corner, double* increase) const;
  void split(int node, int corner, int at);
  void push(int node, double increase);
  std::priority_queue<Open>* next();
  void begin();
  void single_corner(std::size_t j);
  int longest_refuted(std::size_t j, bool wide, int low);
  void close_first(int lemma, const proof::CornerDelay& at);
  void branch();
  State work_on(int at, double before);
  bool extend(int at, int order);
  State check(int at, int order);
  void learn(const Node& node, bool wide, int order, std::vector<proof::Node> tree);
  bool refutes(bool wide, int order, const std::vector<int>& most, long budget, std::vector<proof::Node>& tree);
  Lemma lemma(bool wide, int order, const std::vector<int>& most, std::vector<proof::Node> tree) const;
  void add(Lemma lemma);
  void share();
  bool write(int index, Node node, Proof& proof, std::vector<int>& number) const;
  bool write_by(int lemma, Proof& proof, std::vector<int>& number) const;

  const Task& task_;
  Search& designs_;
  std::function<bool()> stop_;
  Search prover_, wide_;
  Window window_;
  LinearCost cost_;
  int least_;
  int short_;  ///< largest order of the first group
  std::vector<Lemma> lemmas_;
  std::vector<int> fails_;  ///< by lemma: order from which on no attempt to extend it is worth it
  std::vector<Node> nodes_;
  std::priority_queue<Open> open_[2];  ///< short filters, long filters
  long spent_[2] = {0, 0};             ///< linear programs
  double undecided_;
  bool sees_all_ = true;  ///< windows see every kind of limit there is
  bool begun_ = false;
  int tip_ = 0;  ///< until `branch`: the only node that is open
  std::size_t next_corner_ = 0;
  bool branched_ = false;
};

}  // namespace accdec::exact
