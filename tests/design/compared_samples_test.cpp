#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design/compared_samples.hpp>
#include <accdec/filter.hpp>

namespace accdec {
namespace {

/// Least squares of a start and the motions of two legs, sample by sample, are those of the fewer values.
TEST(ComparedSamples, HaveTheSumsOfAllSamples) {
  const Filter filter({0.3, 0.0, 0.2, 0.5});
  std::vector<int> rows;
  for (int k = 3; k < 120; ++k) {
    if (k < 60 || k > 72) rows.push_back(k);
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  std::mt19937 engine(1);
  std::normal_distribution<double> error(0.0, 1.0);
  Eigen::MatrixXd at(count, 2);
  for (Eigen::Index r = 0; r < count; ++r) at(r, 0) = error(engine), at(r, 1) = 100.0 + error(engine);

  const std::vector<int> begins{20, 23, 90};  // the first two bend in one part
  ComparedSamples samples(filter, rows, at, {{90, 93}, {20, 23}, {22, 26}});
  EXPECT_LT(samples.at().rows(), 20);
  Eigen::MatrixXd all(count, 4), few(samples.at().rows(), 4);
  all.col(3).setOnes(), few.col(3) = samples.ones();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const int begin = begins[static_cast<std::size_t>(i)];
    few.col(i) = samples.from(begin);
    for (Eigen::Index r = 0; r < count; ++r) {
      double way = 0.0;
      for (int tap = 0; tap <= filter.order(); ++tap)
        way += filter.tap(tap) * std::max(0, rows[static_cast<std::size_t>(r)] - begin - tap);
      all(r, i) = way;
    }
  }
  // Sums of 100 products of up to 100 * 100, each rounded to 1e-16 of itself.
  EXPECT_LT((all.transpose().lazyProduct(all) - few.transpose().lazyProduct(few)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((all.transpose().lazyProduct(at) - few.transpose().lazyProduct(samples.at())).cwiseAbs().maxCoeff(), 1e-9);
  const Eigen::VectorXd squares = samples.at().colwise().squaredNorm().transpose() + samples.beside_lines();
  EXPECT_LT((squares - at.colwise().squaredNorm().transpose()).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace accdec
