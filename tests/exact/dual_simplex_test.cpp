#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "dense_lp.hpp"

namespace accdec::exact {
namespace {

TEST(DualSimplex, FindsTheLeastVertexOfSmallProgrammes) {
  RandomLp random(1);
  int optimal = 0, infeasible = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const Lp lp = random.small();
    DualSimplex simplex = make(lp);
    const DualSimplex::Status status = simplex.solve();
    const auto best = least_vertex(lp);
    if (best) {
      ASSERT_EQ(status, DualSimplex::Status::optimal);
      EXPECT_NEAR(simplex.objective(), *best, 1e-8);
      expect_optimal(lp, simplex, 1e-8);
      ++optimal;
    } else {
      ASSERT_EQ(status, DualSimplex::Status::infeasible);
      expect_ray(lp, simplex);
      ++infeasible;
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(optimal, 1000);
  EXPECT_GT(infeasible, 400);
}

TEST(DualSimplex, AgreesWithClp) {
  RandomLp random(2);
  int counts[5] = {}, compared = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    Lp lp = random.medium(i % 3 == 0);
    DualSimplex simplex = make(lp);
    const DualSimplex::Status status = simplex.solve();
    ++counts[static_cast<int>(status)];
    if (status == DualSimplex::Status::trouble) continue;
    const ByClp reference = by_clp(lp);
    if (reference.status > 2) continue;  // Clp gave up
    ++compared;
    if (status == DualSimplex::Status::optimal) {
      ASSERT_EQ(reference.status, 0);
      EXPECT_NEAR(simplex.objective(), reference.objective, 1e-6 * (1.0 + std::abs(reference.objective)));
      expect_optimal(lp, simplex, 1e-7);
    } else if (status == DualSimplex::Status::infeasible) {
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
  RandomLp random(3);
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
      const DualSimplex::Status status = simplex.solve();
      DualSimplex cold = make(part);
      const DualSimplex::Status fresh = cold.solve();
      if (status == DualSimplex::Status::trouble || fresh == DualSimplex::Status::trouble) continue;
      ++compared;
      ASSERT_EQ(status, fresh) << change;
      if (status == DualSimplex::Status::optimal) {
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
  EXPECT_EQ(none.solve(), DualSimplex::Status::optimal);
  none.add_row({}, {}, -1.0, 1.0);
  EXPECT_EQ(none.solve(), DualSimplex::Status::optimal);
  none.add_row({}, {}, 1.0, 2.0);
  EXPECT_EQ(none.solve(), DualSimplex::Status::infeasible);
  DualSimplex bounds(2);
  bounds.set_cost(0, -1.0);
  bounds.set_column_bounds(0, -2.0, 3.0);
  bounds.set_column_bounds(1, -no_bound, no_bound);
  EXPECT_EQ(bounds.solve(), DualSimplex::Status::optimal);
  EXPECT_EQ(bounds.objective(), -3.0);
  bounds.set_cost(1, 1.0);
  EXPECT_EQ(bounds.solve(), DualSimplex::Status::unbounded);
}

TEST(DualSimplex, StopsWhenAsked) {
  RandomLp random(4);
  Lp lp = random.medium(false);
  while (lp.rows.size() < 60 || lp.columns() < 50) lp = random.medium(false);
  DualSimplex simplex = make(lp);
  simplex.set_stop([] { return true; });
  const DualSimplex::Status status = simplex.solve();
  EXPECT_TRUE(status == DualSimplex::Status::stopped || simplex.pivots() < 16);
}

}  // namespace
}  // namespace accdec::exact
