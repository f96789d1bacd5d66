#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Lowers feeds to those within the contour, see parts_within_contour, and then to what the filter can start from rest
/// and stop within the limits. This concerns both ends of the program, and joints that hold no axis limit with any
/// delay: every block within a filter's length of the stop. Feeds inside legs and at joints passed at speed do not
/// change.
/// @param delays  of the path; found again when feeds change
/// @param ramps  where feeds change inside a leg, lower them to what passes that joint instead; correct for each joint
/// alone
/// @param deadline  ends it; then limits may be broken
/// @return one entry a limit.
std::vector<SlowedFeeds> limit_feeds(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                                     PairwiseDelays& delays, bool ramps, const Deadline& deadline);

}  // namespace accdec
