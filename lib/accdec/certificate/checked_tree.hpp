#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {

/// The designs that a tree is about, where they are not all of a task's.
struct CheckedWhole {
  double target = unlimited;                  ///< samples of the objective that a design must cost less than
  std::vector<int> samples{};                 ///< each corner's only one; empty: any
  std::optional<CheckedInstants> instants{};  ///< of one corner, in place of whole delays and samples
};

/// Walks through a proof's lemmas and tree, and keeps track of the part of all designs that a node is about.
/// @param granted  the task with the limits that verification grants
/// @return the number of parts that it refutes
/// @throws Rejected if a design of the whole may be left
std::size_t check_tree(const Task& granted, const proof::BranchAndBound& proof, const CheckedWhole& whole,
                       const std::function<bool()>& stop);

}  // namespace accdec
