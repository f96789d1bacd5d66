#pragma once

#include <string>
#include <vector>

#include <accdec/design/power_spectrum.hpp>
#include <accdec/design/vibration_log.hpp>

namespace accdec {

/// By what an axis vibrates in a log. The errors of modes are derived for all but `other`.
enum class Excitation { jolts, sweep, noise, other };

/// A sweep at a constant rate.
struct SweepRange {
  double rate = 0.0;                                 ///< Hz/s; 0: no sweep
  double frequency_low = 0.0, frequency_high = 0.0;  ///< Hz, between which it shows modes
};

/// A vibration found in a log.
struct FoundMode {
  std::string axis;
  double frequency = 0.0;                        ///< Hz, without damping
  double damping = 0.0;                          ///< damping ratio
  double frequency_error = 0.0;                  ///< standard error, of the frequency
  double damping_error = 0.0;                    ///< standard error, of the damping ratio
  double spread = 0.0;                           ///< largest relative change of the frequency between parts of the log
  int compared = 0;                              ///< parts that show the mode; 0: nothing tells the spread
  double damping_low = 0.0, damping_high = 0.0;  ///< of the whole log and its parts
  double share = 0.0;                            ///< of the energy of the acceleration, of the mode alone, 0 .. 1
  Excitation excitation = Excitation::other;
  SweepRange sweep{};
  int jolts = 0;        ///< behind which it was fitted
  int overlaps = 0;     ///< of these, before which the last ringing had not died away
  std::string doubt{};  ///< why the mode is uncertain, and what to log instead; empty: it is not

  bool certain() const { return doubt.empty(); }
};

/// A mode without doubt keeps these parts of its frequency and of its damping ratio, in 99 of 100.
constexpr double promised_frequency = 0.01, promised_damping = 0.2;

/// Options of `find_modes`.
struct FindModesOptions {
  double frequency_min = 5.0;    ///< Hz, > 0
  double frequency_max = 200.0;  ///< Hz; at most 0.3 of the sample rate is used
  std::size_t most = 3;          ///< modes of an axis
};

/// Finds the modes of every axis, the strongest first. Vibrations that die away behind jolts are fitted between these
/// (`free_decay`). A sweep at a constant rate is turned into a jolt first (`sweep_as_jolt`). If noise keeps vibrations
/// up, their spectrum is fitted (`noise_modes`). For others, the autocorrelation is a sum of damped vibrations (James,
/// Carne, Lauffer, Modal Analysis 10, 1995). Their frequencies and damping are the eigenvalues of a shift (ERA: Juang,
/// Pappa, J. Guidance 8, 1985). A frequency counts if most model orders find it. Errors of these are not derived, so
/// that all of them are in doubt. Any mode is in doubt if 2.6 standard errors, which hold 99 of 100, are more than what
/// is promised.
/// @throws std::invalid_argument if the log is too short for the band, or the band is empty
std::vector<FoundMode> find_modes(const VibrationLog& log, const FindModesOptions& options = {});

}  // namespace accdec
