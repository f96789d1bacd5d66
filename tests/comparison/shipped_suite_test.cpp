#include <map>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/solver.hpp>

#include "support/paths.hpp"

namespace {

TEST(ShippedSuite, HasThirtyProblemsOfEveryKindAndThreeSizes) {
  const accdec::Suite suite = accdec::read_suite(accdec::test_support::source_folder() + "/problems/suite/full.toml");
  std::map<std::string, std::set<int>> sizes;
  std::set<std::string> families;
  int largest = 0;
  for (const auto& c : suite.cases) {
    sizes[c.name].insert(c.size);
    families.insert(c.family);
    largest = std::max(largest, c.order);
  }
  EXPECT_GE(sizes.size(), 30u);
  EXPECT_GE(std::count_if(sizes.begin(), sizes.end(), [](const auto& s) { return s.second.size() >= 3; }), 8);
  EXPECT_THAT(families, ::testing::IsSupersetOf({"convex", "power and speed", "many corners", "infeasible",
                                                 "badly scaled", "large", "design"}));
  EXPECT_GE(largest, 1000);
  EXPECT_GE(suite.settings.repeats, 5);
  std::set<std::string> solvers;
  for (const auto& competitor : suite.settings.solvers) solvers.insert(competitor.solver);
  std::size_t continuous = 0;
  for (const auto& solver : accdec::solvers::registry()) continuous += solver->capabilities().integers ? 0 : 1;
  EXPECT_EQ(solvers.size(), continuous);
  for (const char* name : {"quick", "patience", "forms", "options", "external", "rivals"})
    EXPECT_NO_THROW(accdec::read_suite(accdec::test_support::source_folder() + "/problems/suite/" + name + ".toml"))
        << name;
}

}  // namespace
