#include <limits>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <accdec/nlp/nonnegative.hpp>

namespace accdec::nlp {
namespace {

TEST(NonnegativeLeastSquares, ClipsWhereColumnsAreOrthogonal) {
  Eigen::VectorXd b(3);
  b << 1.0, -2.0, 3.0;
  const Eigen::VectorXd w = nonnegative_least_squares(Eigen::MatrixXd::Identity(3, 3), b, {1, 1, 1});
  EXPECT_NEAR(w[0], 1.0, 1e-14);
  EXPECT_NEAR(w[1], 0.0, 1e-14);
  EXPECT_NEAR(w[2], 3.0, 1e-14);
}

TEST(NonnegativeLeastSquares, LeavesColumnsWithoutSignFree) {
  Eigen::VectorXd b(2);
  b << -1.0, -2.0;
  const Eigen::VectorXd w = nonnegative_least_squares(Eigen::MatrixXd::Identity(2, 2), b, {1, 0});
  EXPECT_NEAR(w[0], 0.0, 1e-14);
  EXPECT_NEAR(w[1], -2.0, 1e-14);
}

/// The least residual over every choice of columns that may be other than zero: what the active-set method must reach.
double least_residual(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const std::vector<char>& signed_column) {
  const int n = static_cast<int>(a.cols());
  double best = b.norm();
  for (int set = 1; set < 1 << n; ++set) {
    std::vector<int> columns;
    for (int j = 0; j < n; ++j) {
      if ((set >> j & 1) != 0) columns.push_back(j);
    }
    Eigen::MatrixXd part(a.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j) part.col(static_cast<Eigen::Index>(j)) = a.col(columns[j]);
    const Eigen::VectorXd w = part.completeOrthogonalDecomposition().solve(b);
    bool allowed = true;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const double value = w[static_cast<Eigen::Index>(j)];
      allowed = allowed && (signed_column[static_cast<std::size_t>(columns[j])] == 0 || value >= -1e-12);
    }
    if (allowed) best = std::min(best, (part * w - b).norm());
  }
  return best;
}

TEST(NonnegativeLeastSquares, IsAsGoodAsTryingEverySetOfColumns) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 1 + trial % 5, columns = 1 + trial % 6;
    Eigen::MatrixXd a(rows, columns);
    Eigen::VectorXd b(rows);
    for (double& x : a.reshaped()) x = normal(random);
    for (double& x : b) x = normal(random);
    if (trial % 3 == 0 && columns > 1) a.col(1) = a.col(0);  // dependent
    if (trial % 7 == 0) a.col(0).setZero();
    std::vector<char> signs(static_cast<std::size_t>(columns));
    for (std::size_t j = 0; j < signs.size(); ++j) signs[j] = (j + static_cast<std::size_t>(trial)) % 4 != 0 ? 1 : 0;
    const Eigen::VectorXd w = nonnegative_least_squares(a, b, signs);
    for (std::size_t j = 0; j < signs.size(); ++j) {
      if (signs[j] != 0) {
        EXPECT_GE(w[static_cast<Eigen::Index>(j)], 0.0) << trial;
      }
    }
    EXPECT_NEAR((a * w - b).norm(), least_residual(a, b, signs), 1e-9) << trial;
  }
}

}  // namespace
}  // namespace accdec::nlp
