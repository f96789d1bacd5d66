// The cases themselves: derivatives by differences, the stated minimisers by the optimality conditions.

#include <gtest/gtest.h>

#include <accdec/nlp/derivative_check.hpp>
#include <accdec/nlp/kkt.hpp>
#include <conformance/cases.hpp>

namespace accdec::testing {
namespace {

TEST(Cases, DerivativesAreExact) {
  for (const Case& c : cases()) {
    std::vector<double> x = c.solution;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += 0.1 + 0.05 * static_cast<double>(i);
    for (const nlp::WrongDerivative& wrong : nlp::check_derivatives(c.problem, x)) ADD_FAILURE() << c.problem.name() << ": " << wrong.text;
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

}  // namespace
}  // namespace accdec::testing
