#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/machine.hpp>

namespace accdec {

/// A change of the commanded velocity of an axis.
struct VelocityChange {
  std::int64_t sample = 0;
  double by = 0.0;      ///< m/s
  bool judged = false;  ///< whether the motion may go on behind it as if nothing came later; the last always may
};

/// The time of a command that decides how much a mode is left with, s. A mode forgets changes older than 24 decays, of
/// which 4e-11 is left. @param longest  s, of the command
double memory_of(const Mode& mode, double damping, double longest);

/// The amplitude of a mode of an axis, m, behind changes that pass a filter, see `Mode`. There is one for every change.
/// It counts the changes up to that one together, with their phase, at the filter's last tap for it. It is 0 for
/// changes that are not judged.
/// @param changes  ascending, at least one
std::vector<double> residuals_behind(const Filter& filter, std::span<const VelocityChange> changes, double frequency,
                                     double sample_period, double damping);

/// The largest of these and its frequency and damping. @param changes  ascending, at least one
LimitUse residual_utilisation(const Filter& filter, std::span<const VelocityChange> changes, double sample_period,
                              const Mode& mode);

}  // namespace accdec
