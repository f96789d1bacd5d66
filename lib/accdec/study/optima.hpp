#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <accdec/design.hpp>
#include <accdec/family.hpp>

namespace accdec::study {

/// A task's proved optimum, and the best filter of every controller family under the same limits.
struct Optimum {
  std::string name;         ///< the task's name in the table
  DesignResult design;      ///< of the exact method, without its certificate
  bool accepted = false;    ///< by the independent recheck: limits in simulation, recorded numbers, proof
  std::string objection;    ///< the first reason if not accepted
  double check_time = 0.0;  ///< s, the recheck alone
  std::size_t certificate_bytes = 0;
  std::vector<FamilyResult> families;  ///< the families' best, in the order of `families()`; empty when not asked for

  /// N + d of a single corner's design; for several corners, the weighted mean. 0 without a design.
  double samples() const;
  /// The family of the least objective; null when none holds.
  const FamilyResult* best_family() const;
  /// Share of the best family's objective that the design saves, 0 .. 1; nothing without both.
  std::optional<double> saving() const;
};

/// Designs a task by the exact method, without its own filter. Then rechecks the answer and finds every family's best.
Optimum find_optimum(std::string name, Task task, const DesignOptions& options, bool with_families = true);

}  // namespace accdec::study
