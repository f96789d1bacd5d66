#pragma once

#include <string>
#include <vector>

namespace accdec {

/// Programs of more blocks are planned in one way only: several would take many times as long.
inline constexpr std::size_t several_plans_max = 200'000;

/// A plan that was made beside the one that is answered, because that has to be the fastest that holds.
struct PlanTime {
  std::string plan;       ///< "fixed", "per-leg" or "profiles"
  double time = 0.0;      ///< s, simulated
  bool verified = false;  ///< every sample, all bounds
};

}  // namespace accdec
