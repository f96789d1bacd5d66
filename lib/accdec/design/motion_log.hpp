#pragma once

#include <string>
#include <vector>

namespace accdec {

inline constexpr int log_rest_least = 5;                      ///< samples at rest before and after the motion
inline constexpr int log_samples_least = 4 * log_rest_least;  ///< of a log

/// Logged positions of a machine's axes, one sample a sample period.
struct MotionLog {
  std::vector<std::string> axes;              ///< names: "x"
  std::vector<std::vector<double>> position;  ///< of every axis, m, by sample
  std::size_t samples() const { return position.empty() ? 0 : position.front().size(); }
};

}  // namespace accdec
