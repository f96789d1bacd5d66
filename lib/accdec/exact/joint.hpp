#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

namespace accdec::exact {

/// The proof for several corners that share a filter, by branch and check. A master tree over the delays takes the
/// cheapest delays that no lemma forbids. A search over the samples ("together", Search::refute_together) then looks
/// for a filter with these delays. It finds one, which is a better design, or it proves that there is none. Such a
/// proof is reduced to the corners it needs, and its delays are raised as far as it still holds. The result is a lemma:
/// "no filter up to this order has delays up to these at these corners". A lemma holds everywhere in the tree. For
/// expensive delays the target leaves only short filters, so lemmas of small orders refute nodes late in the tree.
///
/// A few nodes are worked on at a time, each by its own prover. Their results are joined in the order of the nodes, so
/// design and proof do not depend on the number of threads.
class Joint {
 public:
  /// @param designs  holds the best design known, finite; better ones are put there
  /// @param least  smallest order that holds the limits not tied to a tolerance
  /// @param stop  polled from all threads
  Joint(const Task& task, Search& designs, int least, std::function<bool()> stop);
  ~Joint();
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
  /// A proved statement and the orders it holds for.
  struct Lemma {
    int order = 0;
    bool wide = false;  ///< of any order, through a window
    int prover = 0;     ///< whose multipliers the tree names
    std::vector<proof::CornerDelay> delays;
    std::vector<proof::Node> tree;
  };
  enum class Verdict { satisfied, closed, unit, violated };
  struct Prover;
  /// A node given to a prover, and what the prover found.
  struct Work {
    int node = 0, order = 0, group = 0;
    State state = State::going_on;
    std::optional<Lemma> lemma;
    int extended = -1;                                ///< the lemma that it takes the place of; -1: it is new
    std::vector<std::pair<std::size_t, int>> failed;  ///< lemmas that do not extend, from which order on
    long spent = 0;                                   ///< linear programs
  };

  double target() const { return designs_.best->value; }
  /// All delays and orders that the task allows.
  static Node root_node(const Task& task);
  Node& node(int index) { return nodes_[static_cast<std::size_t>(index)]; }
  const Node& node(int index) const { return nodes_[static_cast<std::size_t>(index)]; }
  double cost(const Node& node) const;
  int order_left(Node& node, double target) const;
  Verdict judge(const Lemma& lemma, const Node& node, int* open_corner, double* increase) const;
  void split(int node, int corner, int at);
  void push(int node, double increase);
  std::priority_queue<Open>* next();
  void begin();
  void first_lemmas();
  std::vector<Lemma> single_corner(Prover& prover, std::size_t j) const;
  std::optional<Lemma> longest_refuted(Prover& prover, std::size_t j, bool wide, int low) const;
  void close_first(int lemma, const proof::CornerDelay& at);
  void branch();
  std::vector<Work> next_works();
  std::optional<Work> settle(int at, double before);
  void work_on(Prover& prover, Work& work) const;
  bool extend(Prover& prover, Work& work) const;
  void check(Prover& prover, Work& work) const;
  void join(Work& work, std::size_t known);
  Lemma learn(Prover& prover, const Node& node, bool wide, int order, std::vector<proof::Node> tree) const;
  bool refutes(Prover& prover, bool wide, int order, const std::vector<int>& most, long budget,
               std::vector<proof::Node>& tree) const;
  Lemma lemma(const Prover& prover, bool wide, int order, const std::vector<int>& most,
              std::vector<proof::Node> tree) const;
  void add(Lemma lemma);
  void share();
  int first_multipliers(int prover, bool wide) const;
  bool write(int index, Node node, Proof& proof, std::vector<int>& number) const;
  bool write_by(int lemma, Proof& proof, std::vector<int>& number) const;

  const Task& task_;
  Search& designs_;
  std::function<bool()> stop_;
  Window window_;
  std::vector<std::unique_ptr<Prover>> provers_;
  int threads_ = 1;
  LinearCost cost_;
  int least_;
  int short_;  ///< largest order of the first group
  std::vector<Lemma> lemmas_;
  std::vector<int> fails_;  ///< by lemma: from this order on, attempts to extend it do not pay
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
