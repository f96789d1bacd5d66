#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <coin/ClpSimplex.hpp>
#include <gtest/gtest.h>

#include <accdec/exact/dual_simplex.hpp>

// Small dense linear programs, their optimality conditions, and two other ways to solve them.

namespace accdec::exact {

constexpr double no_bound = DualSimplex::infinity;

/// A linear program as plain dense data.
struct Lp {
  std::vector<double> cost, low, high, row_low, row_high;
  std::vector<std::vector<double>> rows;
  std::size_t columns() const { return cost.size(); }
};

inline void add_rows(DualSimplex& simplex, const Lp& lp, std::size_t first = 0) {
  for (std::size_t r = first; r < lp.rows.size(); ++r) {
    std::vector<int> columns;
    std::vector<double> values;
    for (std::size_t j = 0; j < lp.columns(); ++j) {
      if (lp.rows[r][j] != 0.0) columns.push_back(static_cast<int>(j)), values.push_back(lp.rows[r][j]);
    }
    simplex.add_row(columns, values, lp.row_low[r], lp.row_high[r]);
  }
}

inline void replace(DualSimplex& simplex, const Lp& lp, std::size_t r) {
  std::vector<int> columns;
  std::vector<double> values;
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    if (lp.rows[r][j] != 0.0) columns.push_back(static_cast<int>(j)), values.push_back(lp.rows[r][j]);
  }
  simplex.replace_row(static_cast<int>(r), columns, values, lp.row_low[r], lp.row_high[r]);
}

inline void set_columns(DualSimplex& simplex, const Lp& lp) {
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    simplex.set_cost(static_cast<int>(j), lp.cost[j]);
    simplex.set_column_bounds(static_cast<int>(j), lp.low[j], lp.high[j]);
  }
}

inline DualSimplex make(const Lp& lp) {
  DualSimplex simplex(static_cast<int>(lp.columns()));
  set_columns(simplex, lp);
  add_rows(simplex, lp);
  return simplex;
}

/// The optimality conditions, from nothing but the linear program, the point and the multipliers.
inline void expect_optimal(const Lp& lp, const DualSimplex& simplex, double tolerance) {
  const auto x = simplex.point();
  const auto y = simplex.multipliers();
  for (std::size_t r = 0; r < lp.rows.size(); ++r) {
    double value = 0.0;
    for (std::size_t j = 0; j < lp.columns(); ++j) value += lp.rows[r][j] * x[j];
    EXPECT_GE(value, lp.row_low[r] - tolerance);
    EXPECT_LE(value, lp.row_high[r] + tolerance);
    if (y[r] > tolerance) {
      EXPECT_NEAR(value, lp.row_low[r], tolerance);
    }
    if (y[r] < -tolerance) {
      EXPECT_NEAR(value, lp.row_high[r], tolerance);
    }
  }
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    EXPECT_GE(x[j], lp.low[j] - tolerance);
    EXPECT_LE(x[j], lp.high[j] + tolerance);
    double d = lp.cost[j];
    for (std::size_t r = 0; r < lp.rows.size(); ++r) d -= y[r] * lp.rows[r][j];
    if (d > tolerance) {
      EXPECT_NEAR(x[j], lp.low[j], tolerance);
    }
    if (d < -tolerance) {
      EXPECT_NEAR(x[j], lp.high[j], tolerance);
    }
  }
}

/// sum y_r (A x)_r is below the sum of the sides for every x within its bounds.
inline void expect_ray(const Lp& lp, const DualSimplex& simplex) {
  const auto y = simplex.multipliers();
  double sides = 0.0, most = 0.0;
  for (std::size_t r = 0; r < lp.rows.size(); ++r) {
    if (y[r] != 0.0) sides += y[r] * (y[r] > 0.0 ? lp.row_low[r] : lp.row_high[r]);
  }
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    double sum = 0.0;
    for (std::size_t r = 0; r < lp.rows.size(); ++r) sum += y[r] * lp.rows[r][j];
    if (std::abs(sum) > 1e-11) most += sum * (sum > 0.0 ? lp.high[j] : lp.low[j]);
  }
  EXPECT_LT(most, sides);
}

/// Least cost over all points where as many sides of rows and columns as there are columns meet. All columns are
/// bounded.
inline std::optional<double> least_vertex(const Lp& lp) {
  const std::size_t n = lp.columns();
  std::vector<std::vector<double>> planes;  // coefficients, then the side
  const auto add = [&](const std::vector<double>& a, double low, double high) {
    for (const double side : {low, high}) {
      if (std::isinf(side)) continue;
      planes.push_back(a);
      planes.back().push_back(side);
    }
  };
  for (std::size_t r = 0; r < lp.rows.size(); ++r) add(lp.rows[r], lp.row_low[r], lp.row_high[r]);
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> unit(n, 0.0);
    unit[j] = 1.0;
    add(unit, lp.low[j], lp.high[j]);
  }
  std::optional<double> best;
  std::vector<char> chosen(planes.size(), 0);
  std::fill(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(n), 1);
  do {
    std::vector<std::vector<double>> m;
    for (std::size_t p = 0; p < planes.size(); ++p) {
      if (chosen[p] != 0) m.push_back(planes[p]);
    }
    bool regular = true;
    for (std::size_t c = 0; c < n && regular; ++c) {
      std::size_t pivot = c;
      for (std::size_t r = c; r < n; ++r) {
        if (std::abs(m[r][c]) > std::abs(m[pivot][c])) pivot = r;
      }
      if (std::abs(m[pivot][c]) < 1e-9) regular = false;
      std::swap(m[c], m[pivot]);
      for (std::size_t r = 0; r < n && regular; ++r) {
        if (r == c) continue;
        const double f = m[r][c] / m[c][c];
        for (std::size_t k = c; k <= n; ++k) m[r][k] -= f * m[c][k];
      }
    }
    if (!regular) continue;
    std::vector<double> x(n);
    double value = 0.0;
    for (std::size_t j = 0; j < n; ++j) x[j] = m[j][n] / m[j][j], value += lp.cost[j] * x[j];
    bool holds = true;
    for (std::size_t j = 0; j < n; ++j) holds = holds && x[j] >= lp.low[j] - 1e-9 && x[j] <= lp.high[j] + 1e-9;
    for (std::size_t r = 0; r < lp.rows.size() && holds; ++r) {
      double a = 0.0;
      for (std::size_t j = 0; j < n; ++j) a += lp.rows[r][j] * x[j];
      holds = a >= lp.row_low[r] - 1e-9 && a <= lp.row_high[r] + 1e-9;
    }
    if (holds && (!best || value < *best)) best = value;
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return best;
}

class RandomLp {
 public:
  explicit RandomLp(unsigned seed) : rng_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng_); }
  bool chance(double p) { return uniform(0.0, 1.0) < p; }

  /// Whole numbers, so that many vertices coincide.
  Lp small() {
    Lp lp;
    const int n = integer(1, 4), m = integer(0, 4);
    for (int j = 0; j < n; ++j) {
      const int low = integer(-3, 2);
      lp.cost.push_back(integer(-3, 3));
      lp.low.push_back(low);
      lp.high.push_back(chance(0.15) ? low : low + integer(1, 5));
    }
    for (int r = 0; r < m; ++r) {
      std::vector<double> row;
      for (int j = 0; j < n; ++j) row.push_back(chance(0.3) ? 0 : integer(-3, 3));
      lp.rows.push_back(row);
      const int side = integer(-6, 6);
      const bool equal = chance(0.15);
      lp.row_low.push_back(equal || chance(0.5) ? side : -no_bound);
      lp.row_high.push_back(equal                                           ? side
                            : lp.row_low.back() == -no_bound || chance(0.5) ? side + integer(0, 4)
                                                                            : no_bound);
    }
    return lp;
  }

  /// Around a known point unless `infeasible`: free, fixed and half-bounded columns, rows and columns of zeros, many
  /// ties.
  Lp medium(bool infeasible) {
    Lp lp;
    const int n = integer(5, 60), m = integer(1, 70);
    const bool whole = chance(0.5);
    const double filled = uniform(0.05, 1.0);
    std::vector<double> x;
    const auto number = [&](double size) { return whole ? std::round(uniform(-size, size)) : uniform(-size, size); };
    for (int j = 0; j < n; ++j) {
      lp.cost.push_back(chance(0.4) ? 0.0 : number(3));
      x.push_back(number(4));
      const double kind = uniform(0.0, 1.0);
      lp.low.push_back(kind < 0.1   ? -no_bound
                       : kind < 0.2 ? x.back()
                                    : x.back() - (chance(0.5) ? 0.0 : std::abs(number(5))));
      lp.high.push_back(kind < 0.05 || kind > 0.9   ? no_bound
                        : kind < 0.2 && kind >= 0.1 ? x.back()
                                                    : x.back() + (chance(0.5) ? 0.0 : std::abs(number(5))));
    }
    for (int r = 0; r < m; ++r) {
      std::vector<double> row(static_cast<std::size_t>(n), 0.0);
      double value = 0.0;
      const bool zero = chance(0.03);
      for (int j = 0; j < n; ++j) {
        if (!zero && j != 1 && chance(filled)) row[static_cast<std::size_t>(j)] = number(3);  // column 1 is of zeros
        value += row[static_cast<std::size_t>(j)] * x[static_cast<std::size_t>(j)];
      }
      lp.rows.push_back(row);
      if (infeasible && chance(0.2)) value += number(10);
      const bool equal = chance(0.1);
      const double kind = uniform(0.0, 1.0);
      lp.row_low.push_back(equal ? value : kind < 0.4 ? -no_bound : value - (chance(0.6) ? 0.0 : std::abs(number(5))));
      lp.row_high.push_back(equal ? value : kind > 0.7 ? no_bound : value + (chance(0.6) ? 0.0 : std::abs(number(5))));
    }
    return lp;
  }

 private:
  std::mt19937 rng_;
};

struct ByClp {
  int status;  // of Clp: 0 optimal, 1 infeasible, 2 unbounded
  double objective;
};

inline ByClp by_clp(const Lp& lp) {
  ClpSimplex clp;
  clp.setLogLevel(0);
  clp.setPrimalTolerance(1e-9);
  clp.resize(0, static_cast<int>(lp.columns()));
  const auto side = [](double b) { return std::isinf(b) ? (b > 0 ? COIN_DBL_MAX : -COIN_DBL_MAX) : b; };
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    clp.setColumnBounds(static_cast<int>(j), side(lp.low[j]), side(lp.high[j]));
    clp.setObjectiveCoefficient(static_cast<int>(j), lp.cost[j]);
  }
  for (std::size_t r = 0; r < lp.rows.size(); ++r) {
    std::vector<int> columns;
    std::vector<double> values;
    for (std::size_t j = 0; j < lp.columns(); ++j) {
      if (lp.rows[r][j] != 0.0) columns.push_back(static_cast<int>(j)), values.push_back(lp.rows[r][j]);
    }
    clp.addRow(static_cast<int>(columns.size()), columns.data(), values.data(), side(lp.row_low[r]),
               side(lp.row_high[r]));
  }
  clp.primal();
  return {clp.status(), clp.objectiveValue()};
}

}  // namespace accdec::exact
