// The cases themselves: derivatives by differences, the stated minimisers by the optimality conditions.

#include <algorithm>
#include <cmath>

#include <conformance/cases.hpp>
#include <gtest/gtest.h>

#include <accdec/nlp/derivative_check.hpp>
#include <accdec/nlp/kkt.hpp>

namespace accdec::testing {
namespace {

TEST(Cases, DerivativesAreExact) {
  for (const Case& c : cases()) {
    std::vector<double> x = c.solution;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.1 + 0.05 * static_cast<double>(i);
    for (const nlp::WrongDerivative& wrong : nlp::check_derivatives(c.problem, x))
      ADD_FAILURE() << c.problem.name() << ": " << wrong.text;
  }
}

TEST(Cases, StatedMinimisersSatisfyTheOptimalityConditions) {
  for (const Case& c : cases()) {
    const nlp::KktReport kkt = nlp::check_kkt(c.problem, c.solution);
    ASSERT_TRUE(kkt.finite) << c.problem.name();
    // Solutions printed with ten digits leave that much of the rows.
    EXPECT_LT(std::max(kkt.row_violation, kkt.bound_violation), 1e-7) << c.problem.name();
    EXPECT_NEAR(kkt.objective, c.optimum, 1e-8 * std::max(1.0, std::abs(c.optimum))) << c.problem.name();
    if (!c.regular) continue;
    EXPECT_LT(kkt.stationarity, 1e-8) << c.problem.name();
    EXPECT_LT(kkt.complementarity, 1e-7) << c.problem.name();
  }
}

/// HS071 with one derivative off.
class OneWrong : public FormulaProblem {
 public:
  enum class Where { gradient, jacobian, hessian };
  OneWrong(const FormulaProblem& right, Where where, std::size_t entry)
      : FormulaProblem(right), where_(where), entry_(entry) {}
  void gradient(std::span<const double> x, std::span<double> g) const override {
    FormulaProblem::gradient(x, g);
    spoil(Where::gradient, g);
  }
  void jacobian(std::span<const double> x, std::span<double> values) const override {
    FormulaProblem::jacobian(x, values);
    spoil(Where::jacobian, values);
  }
  void hessian(std::span<const double> x, double factor, std::span<const double> y,
               std::span<double> values) const override {
    FormulaProblem::hessian(x, factor, y, values);
    spoil(Where::hessian, values);
  }

 private:
  void spoil(Where where, std::span<double> values) const {
    if (where == where_)
      values[entry_] += 0.01;  // constant: what it is a derivative of, or has as derivative, stays right
  }
  Where where_;
  std::size_t entry_;
};

TEST(DerivativeChecker, NamesTheOneWrongEntry) {
  using Kind = nlp::WrongDerivative::Kind;
  using Where = OneWrong::Where;
  const auto hs071 =
      std::find_if(cases().begin(), cases().end(), [](const Case& c) { return c.problem.name() == "HS071"; });
  ASSERT_NE(hs071, cases().end());
  const FormulaProblem& right = hs071->problem;
  const std::vector<double> x{1.2, 4.1, 3.3, 1.7};
  const auto only = [&](Where where, std::size_t entry) {
    const std::vector<nlp::WrongDerivative> found = nlp::check_derivatives(OneWrong(right, where, entry), x);
    EXPECT_EQ(found.size(), 1U) << "entry " << entry;
    return found.empty() ? nlp::WrongDerivative{} : found.front();
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const nlp::WrongDerivative wrong = only(Where::gradient, i);
    EXPECT_EQ(wrong.kind, Kind::gradient);
    EXPECT_EQ(wrong.column, static_cast<int>(i));
    EXPECT_NE(wrong.text.find(right.variable_name(static_cast<int>(i))), std::string::npos) << wrong.text;
  }
  for (std::size_t k = 0; k < right.jacobian_pattern().size(); ++k) {
    const nlp::WrongDerivative wrong = only(Where::jacobian, k);
    EXPECT_EQ(wrong.kind, Kind::jacobian);
    EXPECT_EQ(wrong.row, right.jacobian_pattern()[k].row);
    EXPECT_EQ(wrong.column, right.jacobian_pattern()[k].column);
    EXPECT_NE(wrong.text.find(right.row_name(wrong.row)), std::string::npos) << wrong.text;
  }
  // A second derivative is wrong at both of its places; they are one entry of the lower triangle.
  for (std::size_t k = 0; k < right.hessian_pattern().size(); ++k) {
    const nlp::Entry entry = right.hessian_pattern()[k];
    const std::vector<nlp::WrongDerivative> found = nlp::check_derivatives(OneWrong(right, Where::hessian, k), x);
    ASSERT_FALSE(found.empty());
    for (const nlp::WrongDerivative& wrong : found) {
      EXPECT_EQ(wrong.kind, Kind::hessian);
      EXPECT_EQ(std::max(wrong.row, wrong.column), entry.row);
      EXPECT_EQ(std::min(wrong.row, wrong.column), entry.column);
    }
  }
}

/// The integral of max(0, x - 1): its second derivative jumps from 0 to 1 at 1, where the class says `at_knot`.
class Ramp : public FormulaProblem {
 public:
  explicit Ramp(double at_knot)
      : FormulaProblem("ramp", {{0.0, 2.0}}, [](const Variables& x) { return x[0] * x[0]; }, {}), at_knot_(at_knot) {}
  double objective(std::span<const double> x) const override { return 0.5 * std::pow(std::max(0.0, x[0] - 1.0), 2); }
  void gradient(std::span<const double> x, std::span<double> g) const override { g[0] = std::max(0.0, x[0] - 1.0); }
  void hessian(std::span<const double> x, double factor, std::span<const double>,
               std::span<double> values) const override {
    values[0] = factor * (std::abs(x[0] - 1.0) < 1e-4 ? at_knot_ : x[0] > 1.0 ? 1.0 : 0.0);
  }

 private:
  double at_knot_;
};

TEST(DerivativeChecker, TakesTheDerivativeOfEitherSideWhereItJumps) {
  for (const double x : {1.0, 1.0 - 2e-5, 1.0 + 2e-5}) {
    const auto wrong = [&](double at_knot) { return nlp::check_derivatives(Ramp(at_knot), std::vector{x}).size(); };
    EXPECT_EQ(wrong(0.4), 1U) << x;
    EXPECT_EQ(wrong(2.0), 1U) << x;
    EXPECT_EQ(x == 1.0 ? wrong(0.0) + wrong(1.0) : wrong(x > 1.0 ? 1.0 : 0.0), 0U) << x;
  }
}

// Minimises x with two opposed rows 1e-7 apart; x itself is free to fall. Multipliers of 1e9 and more on both rows must
// not make x = 0.5 look stationary, because nothing balances its gradient.
TEST(Kkt, HugeOpposedMultipliersDoNotHideAGradient) {
  const FormulaProblem pinched("pinched", {{0.0, 1.0}, {0.0, 1.0}}, [](const Variables& x) { return x[0]; },
                               {{{-nlp::infinity, 0.5 + 1e-7}, [](const Variables& x) { return x[1]; }},
                                {{0.5, nlp::infinity}, [](const Variables& x) { return x[1]; }}});
  const std::vector<double> x{0.5, 0.5}, y{1e10, -1e10};
  EXPECT_GE(nlp::check_kkt(pinched, x, y).stationarity, 0.99);
  EXPECT_LT(nlp::check_kkt(pinched, std::vector<double>{0.0, 0.5}, y).stationarity, 1e-9);
}

}  // namespace
}  // namespace accdec::testing
