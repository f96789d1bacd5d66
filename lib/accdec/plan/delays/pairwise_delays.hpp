#pragma once

#include <vector>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The rule for delays.
enum class DelayRule {
  smallest,    ///< the smallest delays within the tolerances
  exact_stop,  ///< an exact stop at every joint except those inside arcs and between steps of the feed
  none         ///< none except where the program stops
};

struct PairwiseDelays {
  std::vector<int> delays;              ///< samples, one a block; 0 for the last
  bool limits_possible = true;          ///< see JointDelays::limits_possible
  std::vector<std::size_t> impossible;  ///< these joints, ascending
};

/// Smallest delay of every joint as if it were alone. For a corner it is the smallest with a corner error (at samples)
/// within its tolerance. For a smooth joint it is the smallest with which the path passes within the tolerance. For a
/// stop it is the filter's exact stop. Each is then lengthened until the axis limits hold while the legs overlap. O(1)
/// to O(log N) per joint, O(N^2) where limits bind.
/// @param machine  as many axes as the path, or without axes
/// @param until  if given, the search ends at the first joint that no delay suits, or once this is over: no delays are
///               found then, and `limits_possible` is false
PairwiseDelays pairwise_delays(const Toolpath& path, const Filter& filter, double sample_period,
                               const Machine& machine = {}, DelayRule rule = DelayRule::smallest,
                               const Deadline* until = nullptr);

/// Number of joints with a longer delay than they need alone, because moves overlap or the program gives it.
/// @param delays  samples, one a block
/// @param alone   those of pairwise_delays for this path; empty: they are found
std::size_t raised_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          const std::vector<int>& delays, const std::vector<int>& alone = {});

}  // namespace accdec
