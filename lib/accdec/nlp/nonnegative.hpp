#pragma once

#include <vector>

#include <Eigen/Core>

namespace accdec::nlp {

/// Minimises |A w - b| over w with w_j >= 0 where `signed_column[j]`. It uses the active-set method of Lawson and
/// Hanson, Solving Least Squares Problems (1974), chapter 23. Columns without a sign are always in the passive set.
/// Dense: O(rows * columns^2 + columns^4) at worst.
Eigen::VectorXd nonnegative_least_squares(Eigen::MatrixXd a, Eigen::VectorXd b, const std::vector<char>& signed_column);

}  // namespace accdec::nlp
