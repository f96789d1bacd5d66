#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <accdec/certificate.hpp>
#include <accdec/exact/proof_draft.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/result.hpp>

namespace accdec::exact {

/// Reduces a proof of one corner's convex limits to a target below the one it was begun with. It leaves out parts that
/// are now too long, and multipliers that no leaf needs. None if a part is no longer refuted because of rounding. In
/// prune.cpp.
std::optional<Proof> pruned(const LimitModel& model, const Box& root, const Proof& proof);
/// The proof with the objective it is about, without multipliers that no leaf needs. In proof.cpp.
std::shared_ptr<const Certificate> certify(const Proof& proof, const DesignBounds& design);

/// A window (window.hpp), and the position in it at which each corner is closest if it is the anchor. The anchor is the
/// first corner of `order_of_anchors` that counts.
struct Window {
  int order = 0;
  std::vector<int> at;
  std::vector<int> anchors;  ///< corners with a tolerance, the tightest first

  /// @param most  < 0 where a corner does not count. @return -1: there is none
  int anchor(const std::vector<int>& most) const {
    const auto found =
        std::find_if(anchors.begin(), anchors.end(), [&](int j) { return most[static_cast<std::size_t>(j)] >= 0; });
    return found == anchors.end() ? -1 : *found;
  }
};

/// Verified.
struct Candidate {
  Filter filter;
  std::vector<int> delays;
  double value;  ///< the task's objective, samples
};

/// The filter without zero taps at its ends, but not below the smallest order allowed. Symmetric taps stay symmetric.
/// Zeros at the end stay if a mode is damped: in their time it dies away.
Filter trimmed(const Filter& filter, const Task& task);

/// Where to split for the limit that is broken most. The split is at the filter's own response, where both parts'
/// chords meet the limit, but not too close to an end. None if no limit outside the convex class is broken. Sample 0:
/// one is broken, but nothing is left to split.
/// @param among  if given: only limits of the blend at these corners count, and only where their delay is single
std::optional<SumBound> widest_break(const LimitModel& model, const Filter& filter, const Box& box,
                                     const std::vector<char>* among = nullptr);

/// Both parts of a split on a delay, a sample or the order.
std::pair<Box, Box> parts(const Box& box, const proof::Split& split);
std::pair<Box, Box> parts(const Box& box, const proof::OrderSplit& split);
std::pair<Box, Box> parts(const Box& box, const proof::ResponseSplit& split);
/// @throws std::logic_error  of any other node
std::pair<Box, Box> parts(const Box& box, const proof::Node& node);
/// The first node after this one and its parts, in a tree in preorder.
std::size_t after(const std::vector<proof::Node>& tree, std::size_t node);

/// Looks for something shorter than a target, or proves that there is nothing.
class Search {
 public:
  /// @param kind  `together`, `window`: for `refute_together` alone
  Search(const Task& task, std::function<bool()> stop, BoxKind kind = BoxKind::budget)
      : task_(task), model_(task), stop_(std::move(stop)), kind_(kind) {}

  enum class Answer { proved, found, unknown, open };
  /// found: `best` is shorter than target. unknown: stopped. open: nothing shorter, except perhaps in parts where
  /// rounding decides.
  Answer below(double target);
  /// One corner: continues with a lower target whenever something shorter is found. proved: nothing is shorter than
  /// `proof.target`. unknown: also after `budget` linear programs. One tree serves all targets. For symmetric filters,
  /// and outside the convex class, it uses only linear programs of single delays and samples. The target proved may
  /// then be below the true optimum. Several corners: `below`.
  Answer minimise(double target, long budget);
  /// The smallest order that holds the limits that do not depend on a tolerance, or order_max + 1. Leaves a first
  /// design in `best` if it can.
  int smallest_order();
  /// One corner, convex limits: a better first design by linear programs of single delays at the smallest orders. In
  /// dive.cpp.
  void dive();
  /// Several corners: offers the filters of one linear program an order, from `least` on, until `enough`.
  void sweep_orders(int least, const std::function<bool()>& enough);
  /// Several corners: looks for something shorter near `best`, with at most as many boxes as take about a second. True
  /// if it found any. In neighbourhood.cpp.
  bool improve();
  /// Offers a filter with the delays it needs.
  void offer(Filter filter);

  /// Knowledge about the delays of some corners together.
  struct Together {
    bool refuted = false, holds = false;  ///< neither: stopped, or rounding decides
    std::vector<proof::Node> tree;        ///< refuted: the proof; its multipliers are in `multipliers()`
  };
  /// Whether a filter of at most this order holds these corners with delays up to `most` (one per corner; < 0: the
  /// corner does not count). Ends after `budget` linear programs. Filters met on the way are offered. Several corners,
  /// no symmetry.
  /// @param like  a proof of this search for other delays, whose splits are taken first; empty: there is none
  Together refute_together(int order, const std::vector<int>& most, long budget,
                           const std::vector<proof::Node>& like = {});
  /// The corners that matter in a proof of delays together.
  std::vector<char> corners_used(const std::vector<proof::Node>& tree) const;
  const std::vector<Multipliers>& multipliers() const { return draft_.multipliers(); }
  /// Forgets multipliers from this one on, except those of a proof and some used lately.
  void forget(std::size_t from, const std::vector<proof::Node>& tree) { draft_.forget(from, tree); }

  /// For kind `window`: filters of any order.
  void look_through(Window window) { window_ = std::move(window); }

  std::optional<Candidate> best;  ///< verified
  Proof proof;                    ///< for the last target proved
  long linear_programs() const { return linear_programs_ + (relaxation_ ? relaxation_->linear_programs() : 0); }

 private:
  enum class State { closed, found, stopped, open };  // open: rounding decides
  Answer search(double target);
  State refute_again(const Box& whole, std::size_t& next);
  State reach_by_chords(const Box& box, const Outcome& outcome);
  State undecided() const { return stopped() ? State::stopped : State::open; }
  bool stopped() const { return stop_() || linear_programs() > budget_end_; }
  State go_on(State state, const Box& box);
  void aim(double target);
  /// Several corners: a wide range of orders is split before any linear program is solved, as those of long filters are
  /// expensive.
  std::optional<proof::Node> split_of_long_orders(const Box& box) const;
  /// Refutes two parts; the second only if the first leaves something to look for.
  template <typename Second>
  static State both(State first, const Second& second) {
    if (first == State::found || first == State::stopped) return first;
    const State state = second();
    return state == State::closed ? first : state;
  }
  State refute(Box box);
  State refute_sums(Box box, bool symmetric, int depth);
  State refute_together(Box box, int depth);
  State refute_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole, int depth);
  State both_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole, int depth);
  std::optional<proof::Node> split_together(const Filter& filter, const Box& box) const;
  bool blend_holds(const Filter& filter, const Box& box, std::size_t corner, int delay) const;
  State split_sum(const Box& box, const SumBound& at, bool symmetric, int depth);
  State close(Multipliers y);
  State close_by(int multipliers);
  State leave(proof::Node leaf);
  /// Cuts the box by the target and shrinks its tube where it is needed. False: nothing is left.
  bool narrow(Box& box, proof::Node* why = nullptr);
  bool may_be_shorter(const Filter& filter, const Box& box) const;
  State refute_single(Box box, Outcome outcome);
  int longest_shorter(int order) const;
  bool holds_alone(int order, int delay);
  /// The most promising split of the box; `whole` is the box before the target cut it. In branching.cpp.
  proof::Node choose_split(const Box& whole, const Box& box, const Outcome& outcome);
  /// One corner: the split that the linear program's filter asks for.
  proof::Node split_alone(const Filter& filter, const Box& box) const;
  /// By how much the linear program of a box misses the corner errors; none: the box is refuted.
  std::optional<double> try_part(Box box);
  Box root() const;
  void size_for(int order);
  /// The filter itself. If only rounding keeps it from verifying: another filter of the box, made with a margin.
  Filter mended(const Filter& filter, const Box& box, bool symmetric, const std::vector<int>& delays);
  void consider(Filter filter, const std::vector<int>& delays);

  const Task& task_;
  LimitModel model_;
  ProofDraft draft_{model_, task_.corners.size() > 1 ? std::size_t{60} : std::size_t{8}};
  std::function<bool()> stop_;
  BoxKind kind_;
  std::unique_ptr<Relaxation> relaxation_;
  int sized_ = -1;
  long linear_programs_ = 0;
  double target_ = 0.0;
  bool going_on_ = false;
  bool by_chords_ = false;      ///< minimise by refuting single delays and samples without splits of responses
  double reached_ = unlimited;  ///< the least that they do not refute
  long budget_end_ = std::numeric_limits<long>::max();
  int smallest_order_ = 0;
  Window window_;
  std::vector<char> among_;         ///< corners that count in refute_together
  std::optional<Filter> together_;  ///< what holds them
};

}  // namespace accdec::exact
