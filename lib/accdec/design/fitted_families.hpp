#pragma once

#include <vector>

#include <accdec/design/fit_window.hpp>
#include <accdec/design/identify.hpp>

// Internal to the room: the members of families that may be behind a log.

namespace accdec {

struct FamilyFit {
  FittedFilter fitted;
  double squares = 0.0;  ///< m^2, as CommandFit has it
  Reading reading{};
};

/// The members of all families that fit a log best, the best first. Families with few numbers come before others that
/// fit as well.
/// @param order_max  of the filters; poles may be longer, up to `pole_order_max`
/// @param ends  of the commands that are fitted with them
/// @param whole  whether impulses are at samples only; if not, shapers are the only members
std::vector<FamilyFit> fitted_families(const FitWindow& window, int order_max, int pole_order_max, double period,
                                       Ends ends, bool whole = true);

/// The same with an average in place of the move: a move of m samples behind an average of n is like one of n behind an
/// average of m. Their constant speeds are those of the longer one, which the members have as their move.
/// @param order_max  of the filters
std::vector<FamilyFit> exchanged_moves(const FitWindow& window, const std::vector<FamilyFit>& members, int order_max);

}  // namespace accdec
