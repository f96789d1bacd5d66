#pragma once

#include <memory>
#include <optional>

#include <accdec/certificate.hpp>
#include <accdec/exact/branching.hpp>
#include <accdec/exact/sum_search.hpp>
#include <accdec/exact/workbench.hpp>
#include <accdec/result.hpp>

namespace accdec::exact {

/// Reduces a proof of one corner's convex limits to a target below the one it was begun with. It leaves out parts that
/// are now too long, and multipliers that no leaf needs. None if a part is no longer refuted because of rounding. In
/// prune.cpp.
std::optional<Proof> pruned(const LimitModel& model, const Box& root, const Proof& proof);
/// The proof with the objective and the delays it is about, without multipliers that no leaf needs. In proof.cpp.
std::shared_ptr<const Certificate> certify(const Proof& proof, const Task& task);

/// Looks for a design shorter than a target, or proves that there is none. A box is a part of all designs: a range of
/// the order, and ranges of every corner's delay and nearest sample.
class Search {
 public:
  /// Keeps the reference.
  explicit Search(Workbench& bench)
      : bench_(bench),
        task_(bench.task()),
        model_(bench.model()),
        draft_(bench.draft()),
        designs_(bench.designs),
        branching_(bench),
        sums_(bench) {}

  enum class Answer { proved, found, unknown, open };
  /// found: the best design is shorter than target. unknown: stopped. open: nothing shorter, except perhaps in parts
  /// where rounding decides.
  Answer below(double target);
  /// One corner: continues with a lower target whenever something shorter is found. proved: nothing is shorter than
  /// `proof.target`. unknown: also after `budget` linear programs. One tree serves all targets. For symmetric filters,
  /// and outside the convex class, it uses only linear programs of single delays and samples. The target proved may
  /// then be below the true optimum. Several corners: `below`.
  Answer minimise(double target, long budget);
  /// Several corners: looks for something shorter near the best design, with at most as many boxes as take about a
  /// second. True if it found any. In neighbourhood.cpp.
  bool improve();

  Proof proof;  ///< for the last target proved

 private:
  Answer search(double target);
  BoxState refute_again(const Box& whole, std::size_t& next);
  BoxState reach_by_chords(const Box& box, const Outcome& outcome);
  BoxState go_on(BoxState state, const Box& box);
  BoxState refute(Box box);
  BoxState refute_parts(const Box& whole, const proof::Node& node);
  BoxState refute_single(const Box& whole, Box box, Outcome outcome);
  std::optional<proof::Node> contour_split(const Box& box, const Outcome& outcome);
  bool may_be_shorter(const Filter& filter, const Box& box) const;

  Workbench& bench_;
  const Task& task_;
  const LimitModel& model_;
  ProofDraft& draft_;
  Designs& designs_;
  Branching branching_;
  SumSearch sums_;
  bool going_on_ = false;
  bool by_chords_ = false;      ///< minimise by refuting single delays and samples without splits of responses
  double reached_ = unlimited;  ///< the least that they do not refute
};

}  // namespace accdec::exact
