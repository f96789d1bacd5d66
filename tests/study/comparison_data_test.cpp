#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/io/comparison_report.hpp>
#include <accdec/study/comparison_data.hpp>

namespace accdec {
namespace {

using study::ComparisonData;
using study::Judgement;
using ::testing::HasSubstr;

const std::string header =
    R"({"record":"comparison","schema":"accdec.comparison/1","title":"t","notes":"","starts":1,"repeats":3,"seed":1,"time_limit_s":1,"kill_after_s":2,)"
    R"("evaluation_limit":100,"tolerance":1e-8,"feasibility":1e-6,"accuracy":1e-4,"targets":[0.1,0.01],"solvers":[)"
    R"({"name":"good","library":"L 1","uses":"first derivatives","search":"local","form":"sparse"},)"
    R"({"name":"rigged","library":"L 2","uses":"values","search":"local","form":"reduced"}]})";

std::string problem(int index, const std::string& proof, const std::string& bounds, const std::string& expected = "feasible") {
  return fmt::format(R"({{"record":"problem","index":{0},"case":{0},"problem":"p{0}","family":"f","question":"margin","size":1,"order":9,"variables":9,"rows":20,)"
                     R"("expected":"{3}","proof":"{1}",{2},"method":"m"}})",
                     index, proof, bounds, expected);
}

std::string run(int c, const std::string& solver, const std::string& claim, const std::string& verdict, double objective, double time = 1.0, int repeat = 0,
                const std::string& more = "") {
  return fmt::format(R"({{"record":"run","case":{},"start":0,"solver":"{}","repeat":{},"claim":"{}","verdict":"{}","objective":{},"violation":0.5,)"
                     R"("evaluations":{{"objective":20,"gradient":5,"rows":30,"jacobian":6,"hessian":7}},"wall_time_s":{},"evaluation_time_s":0.1{}}})",
                     c, solver, repeat, claim, verdict, objective, time, more);
}

const std::string proved_two = R"("lower":2.0,"upper":2.0)";

TEST(ComparisonData, ARiggedClaimLandsInItsCell) {
  const std::vector<std::string> lines{header, problem(0, "proved", proved_two), run(0, "good", "solved", "optimal", 2.0001),
                                       run(0, "rigged", "solved", "infeasible", 1.0)};
  const ComparisonData data = study::read_comparison(lines);
  EXPECT_EQ(data.attempt(0, 0, 0).judgement, Judgement::reached);
  const study::Attempt& rigged = data.attempt(0, 0, 1);
  EXPECT_EQ(rigged.judgement, Judgement::violates);
  EXPECT_FALSE(rigged.success);
  EXPECT_TRUE(std::isinf(rigged.cost)) << "a refuted claim is infinitely slow, not dropped";
  EXPECT_TRUE(data.contradictions.empty()) << "a point that breaks a limit proves nothing";

  const ComparisonTable confusion = confusion_table(data);
  const auto cell = [&](const std::string& solver, const std::string& claim, const std::string& verified) {
    const auto column = std::find(confusion.head.begin(), confusion.head.end(), verified) - confusion.head.begin();
    for (const auto& row : confusion.rows) {
      if (row[0] == solver && row[1] == claim) return row.at(static_cast<std::size_t>(column));
    }
    return std::string();
  };
  EXPECT_EQ(cell("rigged", "solved", "breaks a limit"), "1");
  EXPECT_EQ(cell("rigged", "solved", "reference reached"), "0");
  EXPECT_EQ(cell("good", "solved", "reference reached"), "1");
  EXPECT_EQ(cell("all", "solved", "breaks a limit"), "1");
  const ComparisonTable summary = summary_table(data);
  const auto refuted = std::find(summary.head.begin(), summary.head.end(), "claimed solved, refuted") - summary.head.begin();
  EXPECT_EQ(summary.rows[1].at(static_cast<std::size_t>(refuted)), "1");
  EXPECT_EQ(summary.rows[0].at(static_cast<std::size_t>(refuted)), "0");
}

TEST(ComparisonData, StationaryButWorseIsNoSuccessAndMissingRunsAreFailures) {
  const ComparisonData data = study::read_comparison({header, problem(0, "proved", proved_two), problem(1, "proved", proved_two),
                                                      run(0, "good", "solved", "optimal", 2.5), run(0, "rigged", "solved", "feasible", 2.0)});
  EXPECT_EQ(data.attempt(0, 0, 0).judgement, Judgement::stationary);
  EXPECT_EQ(data.attempt(0, 0, 1).judgement, Judgement::reached) << "as good as the proved optimum, whatever its multipliers";
  EXPECT_EQ(data.attempt(1, 0, 0).claim, "missing");
  EXPECT_TRUE(std::isinf(data.attempt(1, 0, 0).cost));
  EXPECT_DOUBLE_EQ(study::at(study::distribution(data.costs(false, [](const auto& a) { return a.cost; })[1]), 10.0), 0.5);
}

TEST(ComparisonData, MedianOfTheRepeatsCounts) {
  const ComparisonData data =
      study::read_comparison({header, problem(0, "proved", proved_two), run(0, "good", "solved", "optimal", 2.0, 9.0, 1, R"(,"history":[[8,4.0,2.15],[12,5.0,2.0]])"),
                              run(0, "good", "solved", "optimal", 2.0, 1.0, 0, R"(,"history":[[3,0.1,2.9],[8,0.4,2.15],[12,0.5,2.0]])"),
                              run(0, "good", "solved", "optimal", 2.0, 2.0, 2, R"(,"history":[[8,0.7,2.15]])")});
  const study::Attempt& a = data.attempt(0, 0, 0);
  EXPECT_EQ(a.cost, 2.0);
  EXPECT_EQ(a.successes, 3U);
  EXPECT_EQ(a.evaluations, 30) << "the larger of objective and rows";
  // Targets are 2 + 0.1 * 2 = 2.2 and 2.02; the last repeat met the second only with its answer, after 2 s and 30 evaluations.
  EXPECT_THAT(a.target_time, ::testing::ElementsAre(0.7, 2.0));
  EXPECT_THAT(a.target_evaluations, ::testing::ElementsAre(8, 12));
}

TEST(ComparisonData, MostRepeatsDecide) {
  const ComparisonData data = study::read_comparison(
      {header, problem(0, "proved", proved_two), run(0, "good", "time limit", "feasible", 2.1, 1.0, 0), run(0, "good", "solved", "optimal", 2.0, 0.9, 1),
       run(0, "good", "solved", "optimal", 2.0, 0.8, 2), run(0, "rigged", "solved", "optimal", 2.0, 0.1, 0), run(0, "rigged", "time limit", "feasible", 2.1, 1.0, 1),
       run(0, "rigged", "time limit", "infeasible", 1.0, 1.0, 2)});
  const study::Attempt &good = data.attempt(0, 0, 0), &rigged = data.attempt(0, 0, 1);
  EXPECT_TRUE(good.success);
  EXPECT_EQ(good.claim, "solved") << "of a repeat that went as most did";
  EXPECT_EQ(good.cost, 0.9) << "of 0.8, 0.9 and infinity";
  EXPECT_FALSE(rigged.success);
  EXPECT_EQ(rigged.successes, 1U);
  EXPECT_EQ(rigged.judgement, Judgement::feasible);
  EXPECT_TRUE(std::isinf(rigged.cost));
}

TEST(ComparisonData, RunsThatANoisyClockMayDecideAreTimedAgain) {
  const auto worth = [](const std::string& claim, double objective) {
    return study::read_comparison({header, problem(0, "proved", proved_two), run(0, "good", claim, "feasible", objective)}).worth_repeating(0, 0, 0);
  };
  EXPECT_TRUE(worth("solved", 5.0)) << "its time is of interest in a pair of solvers that both come to 5";
  EXPECT_TRUE(worth("time limit", 2.0));
  EXPECT_TRUE(worth("time limit", 2.0019)) << "ten times 1e-4 of 2 is 2e-3";
  EXPECT_FALSE(worth("time limit", 2.0021));
  for (const std::string claim : {"refused", "crashed", "error"}) EXPECT_FALSE(worth(claim, 2.0)) << claim;
  EXPECT_FALSE(study::read_comparison({header, problem(0, "proved", proved_two), run(0, "good", "killed", "none", 2.0)}).worth_repeating(0, 0, 0));
}

TEST(ComparisonData, BestVerifiedAnswerIsTheReferenceWhereNothingIsProved) {
  const ComparisonData data =
      study::read_comparison({header, problem(0, "bound", R"("lower":1.0,"upper":null)"), problem(1, "bound", R"("lower":3.0,"upper":null)"),
                              problem(2, "bound", R"("lower":0.0,"upper":null)"), run(0, "good", "solved", "optimal", 4.0),
                              run(0, "rigged", "solved", "infeasible", 2.0), run(1, "good", "solved", "feasible", 3.0001)});
  EXPECT_EQ(data.cases[0].proof, "best known");
  EXPECT_EQ(data.cases[0].reference, 4.0) << "an answer that breaks a limit sets no record";
  EXPECT_EQ(data.cases[1].proof, "proved") << "the bound is reached";
  EXPECT_EQ(data.cases[2].proof, "unknown");
  EXPECT_TRUE(std::isnan(data.cases[2].reference));
}

TEST(ComparisonData, ContradictionsAreTold) {
  const ComparisonData data = study::read_comparison(
      {header, problem(0, "infeasible proved", R"("lower":null,"upper":null)", "infeasible"), problem(1, "proved", proved_two),
       problem(2, "infeasible proved", R"("lower":null,"upper":null)"), run(0, "good", "infeasible", "infeasible", 1.0), run(0, "rigged", "solved", "feasible", 1.0),
       run(1, "good", "solved", "optimal", 1.5)});
  EXPECT_TRUE(data.attempt(0, 0, 0).success) << "saying so is the right answer";
  EXPECT_FALSE(data.attempt(0, 0, 1).success);
  EXPECT_EQ(data.attempt(0, 0, 1).judgement, Judgement::impossible);
  EXPECT_THAT(data.contradictions, ::testing::ElementsAre(HasSubstr("p0 (size 1): proved infeasible, but rigged has a feasible point"),
                                                          HasSubstr("p1 (size 1): good is below the proved bound 2: 1.5"),
                                                          HasSubstr("p2 (size 1): the suite says feasible, but it is proved infeasible")));
}

TEST(ComparisonData, RefusesWhatIsNoRawData) {
  EXPECT_THROW(study::read_comparison({}), std::invalid_argument);
  EXPECT_THROW(study::read_comparison({header}), std::invalid_argument);
  EXPECT_THROW(study::read_comparison({R"({"record":"run")"}), std::invalid_argument);
  EXPECT_THROW(study::read_comparison({R"({"point":"ok"})"}), std::invalid_argument);
  EXPECT_THROW(study::read_comparison({header, problem(0, "proved", proved_two), run(5, "good", "solved", "optimal", 2.0)}), std::invalid_argument);
  EXPECT_THROW(study::read_comparison({header, problem(0, "proved", proved_two), run(0, "stranger", "solved", "optimal", 2.0)}), std::invalid_argument);
}

}  // namespace
}  // namespace accdec
