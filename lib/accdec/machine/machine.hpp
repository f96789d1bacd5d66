#pragma once

#include <limits>
#include <string>
#include <vector>

namespace accdec {

/// "No such limit."
inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// One machine axis: plant and limits in SI. Limits are > 0 or `unlimited`; mass and damping are finite and >= 0.
struct Axis {
  std::string name;
  double velocity_max = unlimited;      ///< m/s
  double acceleration_max = unlimited;  ///< m/s^2
  double jerk_max = unlimited;          ///< m/s^3, first difference of the acceleration over T
  double mass = 0.0;                    ///< kg, m of F = m a' + c V'
  double damping = 0.0;                 ///< N s/m, c of F = m a' + c V'
  double force_max = unlimited;         ///< N, on |F|
  double power_max = unlimited;         ///< W, on P = F V' (motoring)
  double regeneration_max = unlimited;  ///< W, on -P (braking)
};

/// Residual vibration bound: |sum_i b_i exp(-2 pi j f i T)| <= residual_max for every f in [frequency_low,
/// frequency_high].
struct Mode {
  double frequency_low = 0.0;   ///< Hz, > 0
  double frequency_high = 0.0;  ///< Hz, >= frequency_low
  double residual_max = 0.0;    ///< 0 <= residual_max; 1 or more never binds
};

struct Machine {
  std::vector<Axis> axes;
  std::vector<Mode> modes;
};

}  // namespace accdec
