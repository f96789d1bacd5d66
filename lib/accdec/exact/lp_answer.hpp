#pragma once

#include <span>
#include <utility>
#include <vector>

#include <accdec/exact/tableau.hpp>

// Internal to the dual simplex method.

namespace accdec::exact {

/// A point or a ray taken from a basis. It is taken only if it holds against the rows as given.
class LpAnswer {
 public:
  static constexpr double tolerance = 1e-10;  ///< on bounds of columns and rows, absolute; points may use it twice

  explicit LpAnswer(int columns) : point_(static_cast<std::size_t>(columns), 0.0) {}

  /// Computes the point from its basis and refines it once against the rows as given. False: the point does not hold
  /// them. @param value  by variable @param dual  by position
  bool take_point(const Tableau& basis, const std::vector<double>& value, const std::vector<double>& dual);
  /// A leaving variable's row of the tableau as a Farkas ray. False: it proves nothing against the rows as given.
  bool take_ray(const Tableau& basis, int leaving, const double* row, double sigma);
  /// A variable's lower bound exceeds its upper one. For a row, its multiplier names it: no ray tells the sides apart.
  void take_contradiction(const LpRows& given, int variable);

  double objective() const { return objective_; }
  std::span<const double> point() const { return point_; }
  std::span<const double> multipliers() const { return multipliers_; }

 private:
  bool holds(const Tableau& basis, const std::vector<double>& value);

  double objective_ = 0.0;
  std::vector<double> point_, multipliers_;
  std::vector<std::pair<int, double>> residuals_;  ///< by position
};

}  // namespace accdec::exact
