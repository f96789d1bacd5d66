#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>

// Points and rays of the dual simplex method, checked against the rows as they were given.

namespace accdec::exact {
namespace {

std::size_t number(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

/// Computes the point from its basis and refines it once against the rows as given. False: the point does not hold
/// them.
bool DualSimplex::take_point() {
  constexpr double tolerance = 2.0 * primal_tolerance;
  std::copy_n(value_.begin(), columns_, point_.begin());
  for (int j = 0; j < columns_; ++j) {
    const int v = nonbasic_[number(j)];
    if (v < columns_) continue;
    const double residual = value_[number(v)] - activity(v - columns_, point_);
    if (std::abs(residual) < 1e-15) continue;
    if (std::abs(residual) > 1e-6) return false;
    scratch_.emplace_back(j, residual);
  }
  for (std::size_t i = 0; i < basic_.size() && !scratch_.empty(); ++i) {
    if (basic_[i] >= columns_) continue;
    const double* row = tableau_row(static_cast<int>(i));
    for (const auto& [j, residual] : scratch_) point_[number(basic_[i])] += row[j] * residual;
  }
  scratch_.clear();
  objective_ = 0.0;
  for (int j = 0; j < columns_; ++j) {
    if (point_[number(j)] < low_[number(j)] - tolerance || point_[number(j)] > high_[number(j)] + tolerance)
      return false;
    point_[number(j)] = std::clamp(point_[number(j)], low_[number(j)], high_[number(j)]);
    objective_ += cost_[number(j)] * point_[number(j)];
  }
  for (int r = 0; r < rows(); ++r) {
    const double value = activity(r, point_);
    const auto v = number(columns_ + r);
    if (value < low_[v] - tolerance || value > high_[v] + tolerance) return false;
    if (slot_[v] < 0 && std::abs(value - value_[v]) > tolerance * (1.0 + std::abs(value))) return false;
  }
  multipliers_.assign(number(rows()), 0.0);
  for (int j = 0; j < columns_; ++j) {
    if (nonbasic_[number(j)] >= columns_) multipliers_[number(nonbasic_[number(j)] - columns_)] = dual_[number(j)];
  }
  return true;
}

/// A leaving variable's row of the tableau as a Farkas ray. False: it proves nothing against the rows as given.
bool DualSimplex::take_ray(int leaving, const double* row, double sigma) {
  multipliers_.assign(number(rows()), 0.0);
  if (leaving >= columns_) multipliers_[number(leaving - columns_)] = -sigma;
  for (int j = 0; j < columns_; ++j) {
    if (nonbasic_[number(j)] >= columns_) multipliers_[number(nonbasic_[number(j)] - columns_)] = sigma * row[j];
  }
  return refutes(multipliers_);
}

bool DualSimplex::refutes(std::vector<double>& ray) const {
  std::vector<double> sum(number(columns_), 0.0);
  double sides = 0.0, magnitude = 1.0;
  for (int r = 0; r < rows(); ++r) {
    double& y = ray[number(r)];
    if (std::abs(y) < 1e-13) y = 0.0;
    if (y == 0.0) continue;
    const double side = y > 0.0 ? low_[number(columns_ + r)] : high_[number(columns_ + r)];
    if (std::isinf(side)) {
      // The columns' bounds imply as much without this row.
      y = 0.0;
      continue;
    }
    sides += y * side;
    magnitude += std::abs(y * side);
    const Row& from = rows_[number(r)];
    for (std::size_t e = 0; e < from.columns.size(); ++e) sum[number(from.columns[e])] += y * from.values[e];
  }
  double most = 0.0;
  for (int j = 0; j < columns_; ++j) {
    if (std::abs(sum[number(j)]) < 1e-12) continue;
    const double side = sum[number(j)] > 0.0 ? high_[number(j)] : low_[number(j)];
    if (std::isinf(side)) return false;
    most += sum[number(j)] * side;
  }
  return most < sides - 1e-14 * magnitude;
}

}  // namespace accdec::exact
