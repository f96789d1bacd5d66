#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// At overrides of 50, 80 and 120 %, each simulated sample by sample.
/// @param machine  as many axes as the path, or without axes  @param delays  samples, one a block
std::vector<FeedOverride> feed_overrides(const Toolpath& path, const Filter& filter, double sample_period,
                                         const Machine& machine, const std::vector<int>& delays);

}  // namespace accdec
