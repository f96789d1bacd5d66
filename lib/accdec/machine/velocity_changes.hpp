#pragma once

#include <cstdint>
#include <span>

#include <accdec/machine.hpp>

namespace accdec {

/// A change of the commanded velocity of an axis.
struct VelocityChange {
  std::int64_t sample = 0;
  double by = 0.0;  ///< m/s
};

/// The worst frequency and damping of a mode of an axis behind changes that pass a filter, see `Mode`. They count
/// together, with their phase, at the filter's last tap for the last of them. @param changes  ascending, at least one
LimitUse residual_utilisation(const Filter& filter, std::span<const VelocityChange> changes, double sample_period,
                              const Mode& mode);

}  // namespace accdec
