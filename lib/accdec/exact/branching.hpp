#pragma once

#include <optional>

#include <accdec/exact/workbench.hpp>

namespace accdec::exact {

/// Chooses where a box is split. With one corner the widest range will do. With several corners most ranges do not
/// matter. Then trying a few splits before choosing one ("strong branching") saves more boxes than it costs.
class Branching {
 public:
  explicit Branching(Workbench& bench)
      : bench_(bench), task_(bench.task()), model_(bench.model()), draft_(bench.draft()), designs_(bench.designs) {}

  /// Several corners: a wide range of orders is split before any linear program is solved, as those of long filters are
  /// expensive.
  std::optional<proof::Node> split_of_long_orders(const Box& box) const;
  /// Several corners: the most promising split of the box; `whole` is the box before the target cut it. Filters met on
  /// the way are offered.
  proof::Node choose_split(const Box& whole, const Box& box, const Outcome& outcome);
  /// One corner: the split that the linear program's filter asks for.
  proof::Node split_alone(const Filter& filter, const Box& box) const;
  /// By how much the linear program of a box misses the corner errors; none: the box is refuted.
  std::optional<double> try_part(Box box);

 private:
  Workbench& bench_;
  const Task& task_;
  const LimitModel& model_;
  ProofDraft& draft_;
  Designs& designs_;
};

}  // namespace accdec::exact
