#pragma once

#include <cmath>

namespace accdec {

/// |-P u1 + Q u2| for P, Q >= 0 and cos(theta) = -u1.u2. The sum does not cancel when the legs are nearly collinear:
/// P^2 + Q^2 + 2 P Q cos = (P - Q)^2 + 2 P Q (1 + cos). All users share this definition, so all round alike.
inline double leg_distance(double p, double q, double cos_interior) {
  const double d = p - q;
  return std::sqrt(d * d + 2.0 * p * q * (1.0 + cos_interior));
}

}  // namespace accdec
