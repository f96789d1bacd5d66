#include <algorithm>

#include <Eigen/QR>

#include <accdec/nlp/nonnegative.hpp>

namespace accdec::nlp {
namespace {

/// The same least squares, up to a constant, with as many rows as unknowns.
void make_triangular(Eigen::MatrixXd& a, Eigen::VectorXd& b) {
  if (a.rows() <= a.cols()) return;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  b = (qr.householderQ().adjoint() * b).head(a.cols()).eval();
  a = qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

}  // namespace

Eigen::VectorXd nonnegative_least_squares(Eigen::MatrixXd a, Eigen::VectorXd b,
                                          const std::vector<char>& signed_column) {
  const Eigen::Index n = a.cols();
  make_triangular(a, b);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  std::vector<char> passive(signed_column.size());
  std::transform(signed_column.begin(), signed_column.end(), passive.begin(), [](char s) { return !s; });
  const double small = 1e-12 * std::max(1.0, (a.transpose() * b).cwiseAbs().maxCoeff());

  const auto solve = [&] {
    std::vector<Eigen::Index> columns;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (passive[static_cast<std::size_t>(j)]) columns.push_back(j);
    }
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
    if (columns.empty()) return z;
    const Eigen::MatrixXd part = a(Eigen::all, columns);
    const Eigen::VectorXd s = part.completeOrthogonalDecomposition().solve(b);
    for (std::size_t j = 0; j < columns.size(); ++j) z[columns[j]] = s[static_cast<Eigen::Index>(j)];
    return z;
  };

  w = solve();
  for (Eigen::Index round = 0; round < 3 * n + 10; ++round) {
    const Eigen::VectorXd slope = a.transpose() * (b - a * w);
    Eigen::Index best = -1;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!passive[static_cast<std::size_t>(j)] && slope[j] > small && (best < 0 || slope[j] > slope[best])) best = j;
    }
    if (best < 0) break;
    passive[static_cast<std::size_t>(best)] = 1;
    for (;;) {
      const Eigen::VectorXd z = solve();
      double step = 1.0;
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto i = static_cast<std::size_t>(j);
        if (passive[i] && signed_column[i] && z[j] <= 0.0 && w[j] > z[j]) step = std::min(step, w[j] / (w[j] - z[j]));
      }
      w += step * (z - w);
      if (step == 1.0) break;
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto i = static_cast<std::size_t>(j);
        if (passive[i] && signed_column[i] && w[j] <= 1e-15 && z[j] <= 0.0) passive[i] = 0, w[j] = 0.0;
      }
    }
  }
  return w;
}

}  // namespace accdec::nlp
