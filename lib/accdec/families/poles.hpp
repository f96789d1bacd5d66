#pragma once

#include <vector>

#include <accdec/filter.hpp>
#include <accdec/task/pole_rest.hpp>

namespace accdec {

/// The order of endless exponentials in series, cut off where the rest of their step is at most `pole_rest`.
/// @param constants  time constants, samples, > 0, at least one  @param order_max  longer ones end as order_max + 1
int order_of_poles(const std::vector<double>& constants, int order_max);

/// These poles as a filter: one is an exponential, several are taps.
/// @param constants  samples; 0: off. All off: no filter
FilterSpec cut_poles(const std::vector<double>& constants);
FilterSpec cut_pole(double constant);

/// Time constants of poles in series, samples, one a stage; 0: off.
struct Poles {
  int order;
  std::vector<int> constants;
};
/// All poles in series up to an order, the shortest first. Stages of the same constants are in any order, so that each
/// of their sets counts once, with falling constants.
/// @param allowed  constants of each stage, rising, 0 among them
/// @throws std::invalid_argument if there are more than ten million
std::vector<Poles> all_poles(const std::vector<std::vector<int>>& allowed, int order_max);

}  // namespace accdec
