// The optimality conditions judge every solver, so they are tested with points and multipliers that try to deceive
// them.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/nlp/kkt.hpp>
#include <accdec/nlp/violation.hpp>

namespace accdec::nlp {
namespace {

/// (x - p)^2 + (y - q)^2 + r x with the rows  x + y <= 2  and  x <= 10, and bounds on both variables.
class TwoVariables : public Problem {
 public:
  double p = 0.0, q = 0.0, r = 0.0, quadratic = 1.0;
  Bound box{-infinity, infinity};

  int num_variables() const override { return 2; }
  int num_rows() const override { return 2; }
  Bound variable_bound(int) const override { return box; }
  Bound row_bound(int i) const override { return {-infinity, i == 0 ? 2.0 : 10.0}; }
  std::string row_name(int i) const override { return i == 0 ? "sum" : "side"; }
  double objective(std::span<const double> x) const override {
    return quadratic * ((x[0] - p) * (x[0] - p) + (x[1] - q) * (x[1] - q)) + r * x[0];
  }
  void gradient(std::span<const double> x, std::span<double> g) const override {
    g[0] = 2.0 * quadratic * (x[0] - p) + r;
    g[1] = 2.0 * quadratic * (x[1] - q);
  }
  void rows(std::span<const double> x, std::span<double> c) const override {
    c[0] = x[0] + x[1];
    c[1] = x[0];
  }
  const std::vector<Entry>& jacobian_pattern() const override {
    static const std::vector<Entry> pattern{{0, 0}, {0, 1}, {1, 0}};
    return pattern;
  }
  void jacobian(std::span<const double>, std::span<double> values) const override {
    for (double& v : values) v = 1.0;
  }
  bool has_hessian() const override { return false; }
  const std::vector<Entry>& hessian_pattern() const override {
    static const std::vector<Entry> none;
    return none;
  }
  void hessian(std::span<const double>, double, std::span<const double>, std::span<double>) const override {}
};

TEST(Kkt, AcceptsAnOptimumAndFindsItsMultiplier) {
  TwoVariables problem;  // nearest point of x + y <= 2 to (2, 1): (1.5, 0.5), multiplier 1
  problem.p = 2.0, problem.q = 1.0;
  const KktReport report = check_kkt(problem, std::vector{1.5, 0.5});
  EXPECT_TRUE(report.finite);
  EXPECT_NEAR(report.stationarity, 0.0, 1e-12);
  EXPECT_NEAR(report.complementarity, 0.0, 1e-12);
  EXPECT_NEAR(report.multipliers[0], 1.0, 1e-12);
  EXPECT_EQ(report.row_violation, 0.0);
}

TEST(Kkt, FeasibleIsNotStationary) {
  TwoVariables problem;
  problem.p = 2.0, problem.q = 0.0;
  // Gradient (-2, 2) at (1, 1); no multiple >= 0 of the row's (1, 1) makes it smaller than itself.
  EXPECT_NEAR(check_kkt(problem, std::vector{1.0, 1.0}).stationarity, 1.0, 1e-12);
}

TEST(Kkt, RefusesAMultiplierOfTheWrongSign) {
  TwoVariables problem;  // the upper side of the row is active, and the objective pulls away from it
  problem.quadratic = 0.0, problem.r = 1.0;
  const std::vector<double> x{10.0, -8.0};
  for (const auto& y : {std::vector<double>{}, std::vector{0.0, -1.0}}) {
    // Taken at its word, -1 cancels the gradient, but belongs to the row's lower side, which is infinitely far.
    const KktReport report = check_kkt(problem, x, y);
    EXPECT_GT(std::max(report.stationarity, report.complementarity), 0.5);
  }
}

TEST(Kkt, RefusesAMultiplierOfARowThatIsNotActive) {
  TwoVariables problem;
  problem.quadratic = 0.0, problem.r = -1.0;
  const KktReport report = check_kkt(problem, std::vector{0.0, 0.0}, std::vector{0.0, 1.0});
  EXPECT_GT(std::max(report.stationarity, report.complementarity), 0.5);
}

TEST(Kkt, ABoundHoldsTheGradientOnlyWhereItIsActive) {
  TwoVariables problem;
  problem.quadratic = 0.0, problem.r = 1.0, problem.box = {0.0, 1.0};
  EXPECT_NEAR(check_kkt(problem, std::vector{0.0, 0.5}).stationarity, 0.0, 1e-12);
  EXPECT_NEAR(check_kkt(problem, std::vector{0.5, 0.5}).stationarity, 1.0, 1e-12);
  EXPECT_NEAR(check_kkt(problem, std::vector{1.0, 0.5}).stationarity, 1.0, 1e-12);
}

TEST(Kkt, NamesTheWorstRow) {
  TwoVariables problem;
  const KktReport report = check_kkt(problem, std::vector{3.0, 0.5});
  EXPECT_DOUBLE_EQ(report.row_violation, 1.5);
  EXPECT_EQ(report.worst, "sum");
}

TEST(Kkt, SaysWhereNothingIsFinite) {
  TwoVariables problem;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check_kkt(problem, std::vector{nan, 0.0}).finite);
  EXPECT_FALSE(check_kkt(problem, std::vector{infinity, 0.0}).finite);
  EXPECT_EQ(largest_violation(problem, std::vector{nan, 0.0}), infinity);
}

TEST(Kkt, LargeMultipliersHideNoGradient) {
  // The bound holds a large gradient of the first variable; the small one of the second must still be seen.
  TwoVariables problem;
  problem.quadratic = 1e-3, problem.p = -1e6, problem.q = 1.0, problem.box = {0.0, infinity};
  const KktReport report = check_kkt(problem, std::vector{0.0, 0.0});
  // Gradient (2000, -0.002): the bound holds the first, nothing the second; scaled by the first it is 1e-6.
  EXPECT_GT(report.stationarity, 0.5e-6);
}

}  // namespace
}  // namespace accdec::nlp
