#pragma once

#include <optional>
#include <vector>

#include <accdec/exact/workbench.hpp>

namespace accdec::exact {

/// Finds where to split for the limit that is broken most. The split is at the filter's own response, where both parts'
/// chords meet the limit, but not too close to an end. None if no limit outside the convex class is broken. Sample 0:
/// one is broken, but nothing is left to split.
/// @param among  if given: only limits of the blend at these corners count, and only where their delay is single
std::optional<SumBound> widest_break(const LimitModel& model, const Filter& filter, const Box& box,
                                     const std::vector<char>* among = nullptr);

/// Limits outside the convex class: searches boxes of single delays and samples by splits on cumulative responses.
class SumSearch {
 public:
  explicit SumSearch(Workbench& bench)
      : bench_(bench), model_(bench.model()), draft_(bench.draft()), designs_(bench.designs) {}

  /// Looks for a filter below the target.
  /// @param symmetric  only symmetric filters of exactly the box's order; else all filters up to it
  BoxState refute(Box box, bool symmetric, int depth = 0);

 private:
  BoxState split(const Box& box, const proof::Node& node, bool symmetric, int depth);

  Workbench& bench_;
  const LimitModel& model_;
  ProofDraft& draft_;
  Designs& designs_;
};

}  // namespace accdec::exact
