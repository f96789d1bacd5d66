#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <accdec/program.hpp>

namespace accdec {

/// The amplitudes, m, that all moves together leave a mode of an axis with. Every change of the axis' velocity counts,
/// with its phase. The bound judges a start, a corner or a stop without what rang before it.
struct LeftAtRest {
  double at_end = 0.0;       ///< after the last sample
  double frequency = 0.0;    ///< Hz, at which that is
  double at_stop = 0.0;      ///< the most at a stop before the end
  std::uint32_t line = 0;    ///< of the block that ends in that stop
  bool above_bound = false;  ///< whether one of them is
};
/// One for each of `result.check.limits`, none for limits of other kinds. A mode of a band is judged across it. All
/// samples are computed for it once.
std::vector<LeftAtRest> left_at_rest(const ProgramResult& result);
/// The same in words, lines for each mode of an axis. @param left  as found by left_at_rest
std::vector<std::string> left_at_rest_in_words(const ProgramResult& result, const std::vector<LeftAtRest>& left);
/// In words, of a plan that holds all limits: "all bounds hold", unless a mode is left with more at a rest.
std::string bounds_that_hold(const std::vector<LeftAtRest>& left);

}  // namespace accdec
