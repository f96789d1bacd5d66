#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <accdec/design/design.hpp>
#include <accdec/design/standard_shapes.hpp>

namespace accdec::study {

/// A task's proved optimum beside the best that every standard shape can do under the same limits.
struct Optimum {
  std::string name;         ///< as the table shall call the task
  DesignResult design;      ///< of the exact method, without its certificate's text
  bool accepted = false;    ///< by the independent recheck: limits in simulation, recorded numbers, proof
  std::string objection;    ///< the first reason when not
  double check_time = 0.0;  ///< s, the recheck alone
  std::size_t certificate_bytes = 0;
  /// Cycle times (s) in the order of `standard_shapes`; nothing where no order within the task's bounds holds all
  /// limits.
  std::array<std::optional<double>, standard_shapes.size()> shapes;

  /// N + d of a single corner's design; for several, the mean over the weights. 0 without a design.
  double samples() const;
  /// Index into `standard_shapes` of the fastest; nothing when none holds.
  std::optional<std::size_t> best_shape() const;
  /// Share of the fastest standard shape's cycle time that the design saves, 0 .. 1; nothing without both.
  std::optional<double> saving() const;
};

/// Designs a task by the exact method (its own filter, if any, is left aside), has the answer rechecked, and finds
/// every standard shape's best.
Optimum find_optimum(std::string name, Task task, const DesignOptions& options, bool with_shapes = true);

}  // namespace accdec::study
