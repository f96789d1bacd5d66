#pragma once

#include <optional>

#include <accdec/design.hpp>

namespace accdec {

/// The task with bounds of the power of single axes in place of a shared supply, which the exact method knows.
///
/// From rest to a leg's feed v along u, all axes together take v^2 (sum m u^2 B B' + sum c u^2 B^2) of the supply. B is
/// the cumulative response. The axis that moves most on the leg takes its part of both sums, and may take as large a
/// part of the supply. With one mass and one damping for all axes, starts and stops then take no more than it has.
/// Blends may.
Task with_supply_of_axes(const Task& task);

/// A design for that task, with the shortest delays at which the supply of the task itself holds, too.
/// @return none if there is no such design, or no shared supply
std::optional<DesignResult> supply_start(const Task& task, const DesignOptions& options, double seconds);

}  // namespace accdec
