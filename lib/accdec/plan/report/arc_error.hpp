#pragma once

#include <optional>

#include <accdec/program.hpp>

namespace accdec {

/// How far the arcs of a plan's path are from its motion at most, see ArcPoints. None without arcs.
std::optional<ArcError> arc_error(const Plan& plan, double sample_period);

}  // namespace accdec
