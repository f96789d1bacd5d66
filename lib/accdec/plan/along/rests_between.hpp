#pragma once

#include <cstddef>
#include <vector>

#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// Whether a motion may follow another after so many samples of rest. Each holds its limits from rest to rest, but the
/// differences of the samples around their meeting see both.
/// @param before, next  rows; the last ones and the first ones are seen
bool may_follow(const FreePath& free, const std::vector<double>& before, const std::vector<double>& next,
                std::size_t rests);

/// The least number of samples for that; border() - 1 are always enough.
std::size_t rests_between(const FreePath& free, const std::vector<double>& before, const std::vector<double>& next);

}  // namespace accdec
