#pragma once

#include <string>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/limit_unit.hpp>

namespace accdec {

/// "42 Hz", "38 to 46 Hz, damping 0.02 to 0.1".
inline std::string range_of(const Mode& mode) {
  const auto range = [](double low, double high) {
    return low == high ? fmt::format("{:.6g}", low) : fmt::format("{:.6g} to {:.6g}", low, high);
  };
  std::string text = range(mode.frequency_low, mode.frequency_high) + " Hz";
  if (mode.damping_high > 0.0) text += ", damping " + range(mode.damping_low, mode.damping_high);
  return text;
}

/// "jerk x", "power_total": a limit, and its axis if it has one.
inline std::string limit_and_axis(const LimitUse& use) {
  return fmt::format("{}{}{}", limit_word(use.kind, use.axis), use.axis.empty() ? "" : " ", use.axis);
}

/// "at 42 Hz", "at 42 Hz, damping 0.05": where a vibration is worst.
template <class Use>
std::string place_of_vibration(const Use& use, int digits = 6) {
  std::string text = fmt::format("at {:.{}g} Hz", use.frequency, digits);
  if (use.damping > 0.0) text += fmt::format(", damping {:.{}g}", use.damping, digits);
  return text;
}

}  // namespace accdec
