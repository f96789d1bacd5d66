#pragma once

#include <span>
#include <string>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec::nlp {

/// First-order (Karush-Kuhn-Tucker) conditions at a point, recomputed from the problem's functions only. Multipliers
/// are of L = f + sum_i y_i c_i: y_i >= 0 where the upper side of a row is active, <= 0 at the lower side.
struct KktReport {
  bool finite = false;  ///< the point and everything evaluated at it are finite; otherwise the rest is meaningless
  double objective = 0.0;
  double row_violation = 0.0;    ///< absolute
  double bound_violation = 0.0;  ///< absolute
  std::string worst;             ///< name of the most violated row or variable; empty when none is
  double stationarity =
      0.0;  ///< infinity norm of the Lagrangian gradient projected on the bounds, over max(1, |grad f|)
  double complementarity = 0.0;     ///< largest |y_i| times the distance to the side it belongs to, scaled alike
  std::vector<double> multipliers;  ///< the ones these numbers were computed with
};

/// @param x            size n
/// @param multipliers  size m, or empty: then, and where they leave more than `tolerance`, multipliers are estimated by
///                     sign-constrained least squares over the active rows (and, exactly, over active bounds too where
///                     n <= 120), and the best of these is reported
/// @param tolerance    rows and bounds closer than this count as active; so do bounds whose multiplier times distance
/// is below a
///                     hundredth of it
KktReport check_kkt(const Problem& problem, std::span<const double> x, std::span<const double> multipliers = {},
                    double tolerance = 1e-6);

}  // namespace accdec::nlp
