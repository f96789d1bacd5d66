#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <accdec/design/baselines.hpp>
#include <accdec/design/design.hpp>

namespace accdec::study {

/// A task's proved optimum beside the best that every family of filters that controllers have can do under the same
/// limits.
struct Optimum {
  std::string name;         ///< as the table shall call the task
  DesignResult design;      ///< of the exact method, without its certificate
  bool accepted = false;    ///< by the independent recheck: limits in simulation, recorded numbers, proof
  std::string objection;    ///< the first reason when not
  double check_time = 0.0;  ///< s, the recheck alone
  std::size_t certificate_bytes = 0;
  std::vector<BaselineResult>
      families;  ///< the families' best, in the order of `baselines()`; empty when not asked for

  /// N + d of a single corner's design; for several, the mean over the weights. 0 without a design.
  double samples() const;
  /// The family of the least objective; null when none holds.
  const BaselineResult* best_family() const;
  /// Share of the best family's objective that the design saves, 0 .. 1; nothing without both.
  std::optional<double> saving() const;
};

/// Designs a task by the exact method (its own filter, if any, is left aside), has the answer rechecked, and finds
/// every family's best.
Optimum find_optimum(std::string name, Task task, const DesignOptions& options, bool with_families = true);

}  // namespace accdec::study
