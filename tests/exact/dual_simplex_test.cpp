#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <coin/ClpSimplex.hpp>
#include <gtest/gtest.h>

#include <accdec/exact/dual_simplex.hpp>

namespace accdec::exact {
namespace {

constexpr double infinity = DualSimplex::infinity;
using Status = DualSimplex::Status;

/// A linear program as plain dense data.
struct Lp {
  std::vector<double> cost, low, high, row_low, row_high;
  std::vector<std::vector<double>> rows;
  std::size_t columns() const { return cost.size(); }
};

void add_rows(DualSimplex& simplex, const Lp& lp, std::size_t first = 0) {
  for (std::size_t r = first; r < lp.rows.size(); ++r) {
    std::vector<int> columns;
    std::vector<double> values;
    for (std::size_t j = 0; j < lp.columns(); ++j) {
      if (lp.rows[r][j] != 0.0) columns.push_back(static_cast<int>(j)), values.push_back(lp.rows[r][j]);
    }
    simplex.add_row(columns, values, lp.row_low[r], lp.row_high[r]);
  }
}

void replace(DualSimplex& simplex, const Lp& lp, std::size_t r) {
  std::vector<int> columns;
  std::vector<double> values;
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    if (lp.rows[r][j] != 0.0) columns.push_back(static_cast<int>(j)), values.push_back(lp.rows[r][j]);
  }
  simplex.replace_row(static_cast<int>(r), columns, values, lp.row_low[r], lp.row_high[r]);
}

void set_columns(DualSimplex& simplex, const Lp& lp) {
  for (std::size_t j = 0; j < lp.columns(); ++j) {
    simplex.set_cost(static_cast<int>(j), lp.cost[j]);
    simplex.set_column_bounds(static_cast<int>(j), lp.low[j], lp.high[j]);
  }
}

DualSimplex make(const Lp& lp) {
  DualSimplex simplex(static_cast<int>(lp.columns()));
  set_columns(simplex, lp);
  add_rows(simplex, lp);
  return simplex;
}

/// The optimality conditions, from nothing but the linear program, the point and the multipliers.
void expect_optimal(const Lp& lp, const DualSimplex& simplex, double tolerance) {
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
void expect_ray(const Lp& lp, const DualSimplex& simplex) {
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
std::optional<double> least_vertex(const Lp& lp) {
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

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}
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
      lp.row_low.push_back(equal || chance(0.5) ? side : -infinity);
      lp.row_high.push_back(equal                                           ? side
                            : lp.row_low.back() == -infinity || chance(0.5) ? side + integer(0, 4)
                                                                            : infinity);
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
      lp.low.push_back(kind < 0.1   ? -infinity
                       : kind < 0.2 ? x.back()
                                    : x.back() - (chance(0.5) ? 0.0 : std::abs(number(5))));
      lp.high.push_back(kind < 0.05 || kind > 0.9   ? infinity
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
      lp.row_low.push_back(equal ? value : kind < 0.4 ? -infinity : value - (chance(0.6) ? 0.0 : std::abs(number(5))));
      lp.row_high.push_back(equal ? value : kind > 0.7 ? infinity : value + (chance(0.6) ? 0.0 : std::abs(number(5))));
    }
    return lp;
  }

 private:
  std::mt19937 rng_;
};

struct Reference {
  int status;  // of Clp: 0 optimal, 1 infeasible, 2 unbounded
  double objective;
};

Reference by_clp(const Lp& lp) {
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

TEST(DualSimplex, FindsTheLeastVertexOfSmallProgrammes) {
  Random random(1);
  int optimal = 0, infeasible = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const Lp lp = random.small();
    DualSimplex simplex = make(lp);
    const Status status = simplex.solve();
    const auto best = least_vertex(lp);
    if (best) {
      ASSERT_EQ(status, Status::optimal);
      EXPECT_NEAR(simplex.objective(), *best, 1e-8);
      expect_optimal(lp, simplex, 1e-8);
      ++optimal;
    } else {
      ASSERT_EQ(status, Status::infeasible);
      expect_ray(lp, simplex);
      ++infeasible;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(optimal, 1000);
  EXPECT_GT(infeasible, 400);
}

TEST(DualSimplex, AgreesWithClp) {
  Random random(2);
  int counts[5] = {}, compared = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    Lp lp = random.medium(i % 3 == 0);
    DualSimplex simplex = make(lp);
    const Status status = simplex.solve();
    ++counts[static_cast<int>(status)];
    if (status == Status::trouble) continue;
    const Reference reference = by_clp(lp);
    if (reference.status > 2) continue;  // Clp gave up
    ++compared;
    if (status == Status::optimal) {
      ASSERT_EQ(reference.status, 0);
      EXPECT_NEAR(simplex.objective(), reference.objective, 1e-6 * (1.0 + std::abs(reference.objective)));
      expect_optimal(lp, simplex, 1e-7);
    } else if (status == Status::infeasible) {
      ASSERT_EQ(reference.status, 1);
      expect_ray(lp, simplex);
    } else {
      // Clp's primal simplex calls some of these infeasible.
      ASSERT_NE(reference.status, 0);
      lp.cost.assign(lp.columns(), 0.0);
      ASSERT_EQ(by_clp(lp).status, 0);
    }
    if (HasFailure()) break;
  }
  printf("optimal %d infeasible %d unbounded %d stopped %d trouble %d\n", counts[0], counts[1], counts[2], counts[3],
         counts[4]);
  EXPECT_LT(counts[4], 60);
  EXPECT_GT(compared, 2900);
}

TEST(DualSimplex, WarmStartsAgreeWithColdOnes) {
  Random random(3);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    Lp lp = random.medium(false);
    for (std::size_t j = 0; j < lp.columns(); ++j)
      lp.low[j] = std::max(lp.low[j], -20.0), lp.high[j] = std::min(lp.high[j], 20.0);
    DualSimplex simplex(static_cast<int>(lp.columns()));
    set_columns(simplex, lp);
    const std::size_t kept = lp.rows.size() / 2;
    Lp part = lp;
    part.rows.resize(kept), part.row_low.resize(kept), part.row_high.resize(kept);
    add_rows(simplex, part);
    for (int change = 0; change < 8; ++change) {
      if (change % 4 == 0) {
        for (std::size_t r = part.rows.size(); r < lp.rows.size(); ++r) {
          part.rows.push_back(lp.rows[r]), part.row_low.push_back(lp.row_low[r]),
              part.row_high.push_back(lp.row_high[r]);
        }
        add_rows(simplex, part, static_cast<std::size_t>(simplex.rows()));
      } else if (change % 4 == 1) {
        for (std::size_t r = kept; r < part.rows.size(); ++r) {
          if (random.chance(0.3)) continue;
          const bool other = random.chance(0.2);
          for (double& a : part.rows[r]) {
            if (other)
              a = random.chance(0.7) ? random.uniform(-2.0, 2.0) : 0.0;
            else if (random.chance(0.2))
              a *= random.uniform(0.5, 2.0);
          }
          replace(simplex, part, r);
        }
      } else if (change % 4 == 2) {
        for (std::size_t j = 0; j < lp.columns(); ++j) {
          if (!random.chance(0.3)) continue;
          part.high[j] = part.low[j] + (random.chance(0.3) ? 0.0 : random.uniform(0.0, 10.0));
          simplex.set_column_bounds(static_cast<int>(j), part.low[j], part.high[j]);
        }
      } else {
        for (std::size_t r = part.rows.size(); r-- > 0;) {
          if (random.chance(0.6)) continue;
          simplex.remove_row(static_cast<int>(r));
          part.rows[r] = part.rows.back(), part.row_low[r] = part.row_low.back(),
          part.row_high[r] = part.row_high.back();
          part.rows.pop_back(), part.row_low.pop_back(), part.row_high.pop_back();
        }
      }
      const Status status = simplex.solve();
      DualSimplex cold = make(part);
      const Status fresh = cold.solve();
      if (status == Status::trouble || fresh == Status::trouble) continue;
      ++compared;
      ASSERT_EQ(status, fresh) << change;
      if (status == Status::optimal) {
        EXPECT_NEAR(simplex.objective(), cold.objective(), 1e-7 * (1.0 + std::abs(cold.objective())));
        expect_optimal(part, simplex, 1e-7);
      } else {
        expect_ray(part, simplex);
      }
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(compared, 2300);
}

TEST(DualSimplex, NoRowsAndNoColumns) {
  DualSimplex none(0);
  EXPECT_EQ(none.solve(), Status::optimal);
  none.add_row({}, {}, -1.0, 1.0);
  EXPECT_EQ(none.solve(), Status::optimal);
  none.add_row({}, {}, 1.0, 2.0);
  EXPECT_EQ(none.solve(), Status::infeasible);
  DualSimplex bounds(2);
  bounds.set_cost(0, -1.0);
  bounds.set_column_bounds(0, -2.0, 3.0);
  bounds.set_column_bounds(1, -infinity, infinity);
  EXPECT_EQ(bounds.solve(), Status::optimal);
  EXPECT_EQ(bounds.objective(), -3.0);
  bounds.set_cost(1, 1.0);
  EXPECT_EQ(bounds.solve(), Status::unbounded);
}

TEST(DualSimplex, StopsWhenAsked) {
  Random random(4);
  Lp lp = random.medium(false);
  while (lp.rows.size() < 60 || lp.columns() < 50) lp = random.medium(false);
  DualSimplex simplex = make(lp);
  simplex.set_stop([] { return true; });
  const Status status = simplex.solve();
  EXPECT_TRUE(status == Status::stopped || simplex.pivots() < 16);
}

}  // namespace
}  // namespace accdec::exact
