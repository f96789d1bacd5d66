// Adding an algorithm: this file, and one line that registers it.

#include <set>

#include <conformance/cases.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/solver.hpp>
#include <accdec/solvers/run.hpp>

namespace accdec::testing {
namespace {

/// Returns the start.
class Dummy final : public solvers::Solver {
 public:
  std::string name() const override { return "dummy"; }
  std::string library_version() const override { return "none"; }
  solvers::Capabilities capabilities() const override { return {}; }

 protected:
  solvers::Result do_solve(const nlp::Problem& problem, std::span<const double> start,
                           const solvers::Options& options) const override {
    nlp::Evaluator evaluator(problem, solvers::limits_of(options));
    solvers::Result result;
    result.x.assign(start.begin(), start.end());
    result.claimed_objective = evaluator.objective(start);
    result.claim = solvers::Claim::solved;
    solvers::conclude(evaluator, result);
    return result;
  }
};

TEST(Registration, TheBuildKnowsTheVersionsOfTheLoadedLibraries) {
  EXPECT_THAT(solvers::missing_modules(), ::testing::IsEmpty());
  std::set<std::string> built, loaded;
  for (const auto& [name, version] : solvers::libraries()) built.insert(name + " " + version);
  for (const auto& solver : solvers::registry()) {
    if (solver->name() != "dummy") loaded.insert(solver->library_version());
  }
  EXPECT_EQ(built, loaded);
}

TEST(Registration, ADummySolverIsOneFileAndOneLine) {
  solvers::register_solver(std::make_unique<Dummy>());
  const solvers::Solver& dummy = solvers::find_solver("dummy");
  const Case& c = cases()[1];  // HS004: the start is feasible and not optimal
  const solvers::Result result = dummy.solve(c.problem, c.start);
  EXPECT_EQ(result.claim, solvers::Claim::solved);
  EXPECT_EQ(result.verification.verdict, solvers::Verdict::feasible);
  EXPECT_THROW(solvers::register_solver(std::make_unique<Dummy>()), std::invalid_argument);
  EXPECT_THROW(solvers::find_solver("no such"), std::invalid_argument);
}

}  // namespace
}  // namespace accdec::testing
