#pragma once

#include <string>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Times of a path with other rules for its delays, at its feeds.
struct OtherRules {
  double no_delay = 0.0;    ///< s, no delay but where the program stops
  double exact_stop = 0.0;  ///< s, with an exact stop after every block; chords of an arc are one block
  std::string breaks;       ///< a limit that exact stops nevertheless break; empty: they hold all
};
/// If the last tap of one leg and the first of the next together break a limit, exact stops take one sample more. They
/// are simulated, unless it is certain that they hold. If the beginning of a long program breaks a limit, only this
/// beginning is.
OtherRules other_rules(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

}  // namespace accdec
