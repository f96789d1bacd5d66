#include <algorithm>
#include <cmath>

#include <accdec/exact/lp_answer.hpp>

namespace accdec::exact {
namespace {

std::size_t number(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

bool LpAnswer::take_point(const Tableau& basis, const std::vector<double>& value, const std::vector<double>& dual) {
  const LpRows& given = basis.given();
  const int columns = given.columns();
  std::copy_n(value.begin(), columns, point_.begin());
  for (int j = 0; j < columns; ++j) {
    const int v = basis.nonbasic(j);
    if (v < columns) continue;
    const double residual = value[number(v)] - given.activity(v - columns, point_);
    if (std::abs(residual) < 1e-15) continue;
    if (std::abs(residual) > 1e-6) return false;
    residuals_.emplace_back(j, residual);
  }
  const std::span<const int> basic = basis.basic();
  for (std::size_t i = 0; i < basic.size() && !residuals_.empty(); ++i) {
    if (basic[i] >= columns) continue;
    const double* row = basis.entries(static_cast<int>(i));
    for (const auto& [j, residual] : residuals_) point_[number(basic[i])] += row[j] * residual;
  }
  residuals_.clear();
  if (!holds(basis, value)) return false;
  multipliers_.assign(number(given.rows()), 0.0);
  for (int j = 0; j < columns; ++j) {
    if (basis.nonbasic(j) >= columns) multipliers_[number(basis.nonbasic(j) - columns)] = dual[number(j)];
  }
  return true;
}

/// Clamps the point to the columns' bounds and compares it with the rows.
bool LpAnswer::holds(const Tableau& basis, const std::vector<double>& value) {
  constexpr double granted = 2.0 * tolerance;
  const LpRows& given = basis.given();
  objective_ = 0.0;
  for (int j = 0; j < given.columns(); ++j) {
    double& x = point_[number(j)];
    if (x < given.low(j) - granted || x > given.high(j) + granted) return false;
    x = std::clamp(x, given.low(j), given.high(j));
    objective_ += given.cost(j) * x;
  }
  for (int r = 0; r < given.rows(); ++r) {
    const double is = given.activity(r, point_);
    const int v = given.columns() + r;
    if (is < given.low(v) - granted || is > given.high(v) + granted) return false;
    if (!basis.is_basic(v) && std::abs(is - value[number(v)]) > granted * (1.0 + std::abs(is))) return false;
  }
  return true;
}

bool LpAnswer::take_ray(const Tableau& basis, int leaving, const double* row, double sigma) {
  const int columns = basis.given().columns();
  multipliers_.assign(number(basis.given().rows()), 0.0);
  if (leaving >= columns) multipliers_[number(leaving - columns)] = -sigma;
  for (int j = 0; j < columns; ++j) {
    if (basis.nonbasic(j) >= columns) multipliers_[number(basis.nonbasic(j) - columns)] = sigma * row[j];
  }
  return basis.given().refutes(multipliers_);
}

void LpAnswer::take_contradiction(const LpRows& given, int variable) {
  multipliers_.assign(number(given.rows()), 0.0);
  if (variable >= given.columns()) multipliers_[number(variable - given.columns())] = 1.0;
}

}  // namespace accdec::exact
