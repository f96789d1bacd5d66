#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <accdec/design/decay_fit.hpp>

namespace accdec {

/// The answer to a sweep at a constant rate, as if all its frequencies came at once.
struct SweepAsJolt {
  double rate = 0.0;                                 ///< Hz/s
  double period = 0.0;                               ///< s, of the signal; longer than that of the log
  double frequency_low = 0.0, frequency_high = 0.0;  ///< Hz, between which the signal is that of a jolt
  std::size_t begin = 0;                             ///< the first sample behind the jolt
  std::vector<double> signal;  ///< from a little before the jolt until the sweep's ends disturb it
};

/// Moves every frequency of a sweep from the time at which it was swept to one time for all. Only phases change, so
/// that white noise stays white, and the answer of a machine becomes a free vibration behind a jolt. The rate is the
/// median of the slopes between the loudest frequencies of short pieces of the log. Empty if these are not on a line.
std::optional<SweepAsJolt> sweep_as_jolt(std::span<const double> signal, double period, const DecaySearch& search);

}  // namespace accdec
