#pragma once

#include <functional>

#include <accdec/exact/branching.hpp>

namespace accdec::exact {

/// Finds designs before a proof: those longer than a known one need not be refuted. If ranges are wide, the proof's
/// own linear programs are too loose to find good designs.
class FirstDesigns {
 public:
  explicit FirstDesigns(Workbench& bench)
      : bench_(bench), task_(bench.task()), model_(bench.model()), designs_(bench.designs), branching_(bench) {}

  /// The smallest order that holds the limits that do not depend on a tolerance, or order_max + 1. Leaves a first
  /// design if it can.
  int smallest_order();
  /// One corner, convex limits: a better first design by linear programs of single delays at the smallest orders.
  void dive();
  /// Several corners: offers the filters of one linear program an order, from `least` on, until `enough`.
  void sweep_orders(int least, const std::function<bool()>& enough);

  /// Offers standard shapes of this order and longer, for tasks where the search itself may find no first design.
  void offer_shapes(int least);

 private:
  int longest_shorter(int order) const;
  bool holds_alone(int order, int delay);

  Workbench& bench_;
  const Task& task_;
  const LimitModel& model_;
  Designs& designs_;
  Branching branching_;
};

}  // namespace accdec::exact
