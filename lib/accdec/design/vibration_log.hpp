#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace accdec {

/// Logged accelerations of a machine's axes, evenly spaced in time.
struct VibrationLog {
  double period = 0.0;                            ///< s
  std::vector<std::string> axes;                  ///< names: "x"
  std::vector<std::vector<double>> acceleration;  ///< of every axis, by sample; any unit
  long last_line = 0;                             ///< of the file; 0: there is none
  std::size_t samples() const { return acceleration.empty() ? 0 : acceleration.front().size(); }
};

}  // namespace accdec
