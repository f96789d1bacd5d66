#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/comparison/comparison_data.hpp>
#include <accdec/comparison/comparison_report.hpp>

namespace accdec {
namespace {

using comparison::ComparisonData;
using comparison::Judgement;
using ::testing::HasSubstr;

const std::string header =
    R"({"record":"comparison","schema":"accdec.comparison/1","title":"t","notes":"","starts":1,"repeats":3,"seed":1,"time_limit_s":1,"kill_after_s":2,)"
    R"("evaluation_limit":100,"tolerance":1e-8,"feasibility":1e-6,"accuracy":1e-4,"targets":[0.1,0.01],"solvers":[)"
    R"({"name":"good","library":"L 1","uses":"first derivatives","search":"local","form":"sparse"},)"
    R"({"name":"rigged","library":"L 2","uses":"values","search":"local","form":"reduced"}]})";

std::string problem(int index, const std::string& proof, const std::string& bounds,
                    const std::string& expected = "feasible") {
  return fmt::format(
      R"({{"record":"problem","index":{0},"case":{0},"problem":"p{0}","family":"f","question":"margin","size":1,"order":9,"variables":9,"rows":20,)"
      R"("expected":"{3}","proof":"{1}",{2},"method":"m"}})",
      index, proof, bounds, expected);
}

std::string run(int c, const std::string& solver, const std::string& claim, const std::string& verdict,
                double objective, double time = 1.0, int repeat = 0, const std::string& more = "") {
  return fmt::format(
      R"({{"record":"run","case":{},"start":0,"solver":"{}","repeat":{},"claim":"{}","verdict":"{}","objective":{},"violation":0.5,)"
      R"("evaluations":{{"objective":20,"gradient":5,"rows":30,"jacobian":6,"hessian":7}},"wall_time_s":{},"evaluation_time_s":0.1{}}})",
      c, solver, repeat, claim, verdict, objective, time, more);
}

/// Entry of a table in the first row that has these texts in these columns.
std::string cell(const ComparisonTable& table, const std::map<std::size_t, std::string>& row,
                 const std::string& column) {
  const auto at = std::find(table.head.begin(), table.head.end(), column) - table.head.begin();
  for (const auto& cells : table.rows) {
    if (std::all_of(row.begin(), row.end(),
                    [&](const auto& wanted) { return cells.at(wanted.first) == wanted.second; }))
      return cells.at(static_cast<std::size_t>(at));
  }
  return "no such row";
}

const std::string proved_two = R"("lower":2.0,"upper":2.0)";

TEST(ComparisonData, ARiggedClaimLandsInItsCell) {
  const std::vector<std::string> lines{header, problem(0, "proved", proved_two),
                                       run(0, "good", "solved", "optimal", 2.0001),
                                       run(0, "rigged", "solved", "infeasible", 1.0)};
  const ComparisonData data = comparison::read_comparison(lines);
  EXPECT_EQ(data.attempt(0, 0, 0).judgement, Judgement::reached);
  const comparison::Attempt& rigged = data.attempt(0, 0, 1);
  EXPECT_EQ(rigged.judgement, Judgement::violates);
  EXPECT_FALSE(rigged.success);
  EXPECT_TRUE(std::isinf(rigged.end_cost)) << "a refuted claim is infinitely slow, not dropped";
  EXPECT_TRUE(data.contradictions.empty()) << "a point that breaks a limit proves nothing";

  const ComparisonTable confusion = confusion_table(data), summary = summary_table(data);
  EXPECT_EQ(cell(confusion, {{0, "rigged"}, {1, "solved"}}, "breaks a limit"), "1");
  EXPECT_EQ(cell(confusion, {{0, "rigged"}, {1, "solved"}}, "reference reached"), "0");
  EXPECT_EQ(cell(confusion, {{0, "good"}, {1, "solved"}}, "reference reached"), "1");
  EXPECT_EQ(cell(confusion, {{0, "all"}, {1, "solved"}}, "breaks a limit"), "1");
  EXPECT_EQ(cell(summary, {{0, "rigged"}}, "claimed solved, refuted"), "1");
  EXPECT_EQ(cell(summary, {{0, "good"}}, "claimed solved, refuted"), "0");
}

TEST(ComparisonData, WrongClaimsThatThereIsNoAnswerAreInTheSummary) {
  for (const char* claim : {"infeasible", "unbounded"}) {
    const ComparisonTable summary = summary_table(comparison::read_comparison(
        {header, problem(0, "proved", proved_two), run(0, "good", "solved", "optimal", 2.0001),
         run(0, "rigged", claim, "none", 1.0)}));
    EXPECT_EQ(cell(summary, {{0, "rigged"}}, "wrong claims"), "1") << claim;
    EXPECT_EQ(cell(summary, {{0, "good"}}, "wrong claims"), "0") << claim;
  }
}

// Below 2.2e-308 numbers have fewer digits, but they are numbers.
TEST(ComparisonData, RecordsNumbersBelowTheNormalRange) {
  for (const double x : {1e-310, 5e-324, 0.0, -1e-310}) EXPECT_EQ(batch::number(x).get<double>(), x);
  EXPECT_TRUE(batch::number(INFINITY).is_null());
}

// Variants are entries under names of their own; an algorithm's own name, or one of its forms, is none.
TEST(ComparisonData, TellsVariantsFromPlainSolvers) {
  std::string four = header;
  const std::size_t list = four.find(R"("solvers":[)") + 11;
  four =
      four.substr(0, list) +
      R"({"name":"a","solver":"a"},{"name":"a/reduced","solver":"a"},{"name":"a, faster","solver":"a"},{"name":"b","solver":"b"}]})";
  const ComparisonData data = comparison::read_comparison({four, problem(0, "proved", R"("lower":1,"upper":1)")});
  EXPECT_THAT(data.plain, ::testing::ElementsAre(0, 1, 3));
  EXPECT_THAT(data.algorithms, ::testing::ElementsAre("a", "a", "a", "b"));
}

TEST(ComparisonData, StationaryButWorseIsNoSuccessAndMissingRunsAreFailures) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "proved", proved_two), problem(1, "proved", proved_two),
       run(0, "good", "solved", "optimal", 2.5), run(0, "rigged", "solved", "feasible", 2.0)});
  EXPECT_EQ(data.attempt(0, 0, 0).judgement, Judgement::stationary);
  EXPECT_EQ(data.attempt(0, 0, 1).judgement, Judgement::reached)
      << "as good as the proved optimum, whatever its multipliers";
  EXPECT_EQ(data.attempt(1, 0, 0).claim, "missing");
  EXPECT_TRUE(std::isinf(data.attempt(1, 0, 0).end_cost));
  EXPECT_DOUBLE_EQ(
      comparison::at(comparison::distribution(data.costs(false, [](const auto& a) { return a.end_cost; })[1]), 10.0),
      0.5);
}

TEST(ComparisonData, MedianOfTheRepeatsCounts) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "proved", proved_two),
       run(0, "good", "solved", "optimal", 2.0, 9.0, 1, R"(,"history":[[8,4.0,2.15],[12,5.0,2.0]])"),
       run(0, "good", "solved", "optimal", 2.0, 1.0, 0, R"(,"history":[[3,0.1,2.9],[8,0.4,2.15],[12,0.5,2.0]])"),
       run(0, "good", "solved", "optimal", 2.0, 2.0, 2, R"(,"history":[[8,0.7,2.15]])")});
  const comparison::Attempt& a = data.attempt(0, 0, 0);
  EXPECT_EQ(a.end_cost, 2.0);
  EXPECT_EQ(a.successes, 3U);
  EXPECT_EQ(a.evaluations, 30) << "the larger of objective and rows";
  // Targets are 2 + 0.1 * 2 = 2.2 and 2.02; the last repeat met the second only with its answer, after 2 s and 30
  // evaluations.
  EXPECT_THAT(a.target_time, ::testing::ElementsAre(0.7, 2.0));
  EXPECT_THAT(a.target_evaluations, ::testing::ElementsAre(8, 12));
}

std::string with_history(const std::string& history) {
  return fmt::format(R"(,"history":{})", history);
}

TEST(ComparisonData, TimeToAccuracyIsFreeOfPolishingAndNeedsAnAcceptedAnswer) {
  // Accuracy 1e-4 of the reference 2: within are objectives up to 2.0002. The targets, 0.1 and 0.01, are coarser.
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "proved", proved_two), problem(1, "proved", proved_two),
       // Within at 0.5, 0.3 and 0.8 s (2.00021 is outside, 2.00019 inside); ended at 4, 5 and 6 s.
       run(0, "good", "solved", "optimal", 2.0, 4.0, 0,
           with_history("[[2,0.1,2.5],[9,0.4,2.00021],[12,0.5,2.00019],[30,3.9,2.0]]")),
       run(0, "good", "solved", "optimal", 2.0, 5.0, 1, with_history("[[2,0.1,2.1],[9,0.3,2.0001]]")),
       run(0, "good", "solved", "optimal", 2.0, 6.0, 2, with_history("[[2,0.2,2.1],[9,0.8,2.0001]]")),
       // Came as near three times, but twice handed back something worse: no success, whatever was met on the way.
       run(0, "rigged", "solved", "feasible", 2.1, 1.0, 0, with_history("[[9,0.1,2.0]]")),
       run(0, "rigged", "solved", "infeasible", 1.5, 1.0, 1, with_history("[[9,0.1,2.0]]")),
       run(0, "rigged", "solved", "feasible", 2.0, 1.0, 2, with_history("[[9,0.1,2.0]]")),
       // Two of three repeats succeed: one at 0.4 s, and one only by its answer, at the end after 7 s. The third counts
       // as infinite, so the median is 7 s.
       run(1, "good", "solved", "feasible", 2.0, 1.0, 0, with_history("[[9,0.4,2.0]]")),
       run(1, "good", "solved", "feasible", 2.0, 7.0, 1, with_history("[[9,0.4,2.001]]")),
       run(1, "good", "time limit", "feasible", 2.001, 3.0, 2, with_history("[[9,0.2,2.0]]"))});
  const comparison::Attempt &good = data.attempt(0, 0, 0), &rigged = data.attempt(0, 0, 1),
                            &mixed = data.attempt(1, 0, 0);
  EXPECT_EQ(good.accuracy_cost, 0.5) << "of 0.3, 0.5 and 0.8";
  EXPECT_EQ(good.end_cost, 5.0);
  EXPECT_FALSE(rigged.success);
  EXPECT_TRUE(std::isinf(rigged.accuracy_cost));
  EXPECT_TRUE(std::isinf(rigged.end_cost));
  EXPECT_THAT(rigged.target_time, ::testing::ElementsAre(0.1, 0.1)) << "targets count whatever came after";
  EXPECT_EQ(mixed.accuracy_cost, 7.0);
  EXPECT_EQ(mixed.end_cost, 7.0) << "of 1, 7 and infinity";

  EXPECT_EQ(cell(runs_table(data), {{0, "p0"}, {4, "good"}}, "time to accuracy median / s"), "0.5");
  EXPECT_EQ(cell(runs_table(data), {{0, "p0"}, {4, "good"}}, "time to end median / s"), "5");
  EXPECT_EQ(cell(runs_table(data), {{0, "p0"}, {4, "rigged"}}, "time to accuracy median / s"), "");
  // Ratios of end to accuracy: 5 / 0.5 and 7 / 7. By linear interpolation the median of 1 and 10 is 5.5, and that of
  // 0.5 and 7 is 3.75.
  EXPECT_EQ(cell(summary_table(data), {{0, "good"}}, "median of time to end / time to accuracy"), "5.5");
  EXPECT_EQ(cell(summary_table(data), {{0, "good"}}, "time to accuracy median / s"), "3.75");
}

TEST(ComparisonData, ProfilesByTimeToAccuracyAndToTheEndMayDisagree) {
  // To accuracy 0.1 against 0.2 s: good first, by a factor of 2. To the end 4 against 1 s: rigged first, by 4.
  const std::vector<std::string> lines{
      header, problem(0, "proved", proved_two),
      run(0, "good", "solved", "optimal", 2.0, 4.0, 0, with_history("[[9,0.1,2.0]]")),
      run(0, "rigged", "solved", "optimal", 2.0, 1.0, 0, with_history("[[9,0.2,2.0]]"))};
  const ComparisonData data = comparison::read_comparison(lines);
  const ComparisonTable pairs = pairs_table(data);
  EXPECT_EQ(cell(pairs, {{1, "good"}, {2, "rigged"}}, "least time to accuracy or equal (ratio 1)"), "1");
  EXPECT_EQ(cell(pairs, {{1, "rigged"}, {2, "good"}}, "least time to accuracy or equal (ratio 1)"), "0");
  EXPECT_EQ(cell(pairs, {{1, "rigged"}, {2, "good"}}, "within ratio 2"), "1");
  // Panels are one of solvers with derivatives and one of solvers with values only. Lines are at 1 from the ratio on,
  // at 0 before.
  const auto share = [&](const std::string& figure, std::size_t panel, double ratio) {
    for (const auto& [name, drawn] : comparison_figures(data)) {
      if (name != figure) continue;
      const Series& s = drawn.panels.at(panel).series.at(0);
      return s.y.at(static_cast<std::size_t>(std::upper_bound(s.x.begin(), s.x.end(), ratio) - s.x.begin()) - 1);
    }
    return -1.0;
  };
  EXPECT_EQ(share("performance", 0, 1.0), 1.0);
  EXPECT_EQ(share("performance", 1, 1.9), 0.0);
  EXPECT_EQ(share("performance", 1, 2.1), 1.0);
  EXPECT_EQ(share("performance-end", 0, 3.9), 0.0);
  EXPECT_EQ(share("performance-end", 0, 4.1), 1.0);
  EXPECT_EQ(share("performance-end", 1, 1.0), 1.0);
}

TEST(ComparisonData, ASearchWithoutADesignHasRecognisedNothing) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "infeasible proved", R"("lower":null,"upper":null)", "infeasible"),
       problem(1, "proved", proved_two), run(0, "good", "infeasible", "infeasible", 1.0),
       run(0, "rigged", "no design", "none", 0.0), run(1, "rigged", "no design", "none", 0.0)});
  EXPECT_TRUE(data.attempt(0, 0, 0).success);
  EXPECT_FALSE(data.attempt(0, 0, 1).success);
  const ComparisonTable summary = summary_table(data), confusion = confusion_table(data);
  EXPECT_EQ(cell(summary, {{0, "good"}}, "infeasible recognised"), "1");
  EXPECT_EQ(cell(summary, {{0, "good"}}, "infeasible: no design found"), "0");
  EXPECT_EQ(cell(summary, {{0, "rigged"}}, "infeasible recognised"), "0");
  EXPECT_EQ(cell(summary, {{0, "rigged"}}, "infeasible: no design found"), "1")
      << "not the one on the feasible problem";
  EXPECT_EQ(cell(summary, {{0, "rigged"}}, "infeasible in all"), "1");
  EXPECT_EQ(cell(confusion, {{0, "rigged"}, {1, "no design"}}, "problem infeasible"), "1");
  EXPECT_EQ(cell(confusion, {{0, "rigged"}, {1, "no design"}}, "no point"), "1");
}

TEST(ComparisonData, ReportNamesOptionsAndWhatIsMeasured) {
  std::string with_options = header;
  with_options.replace(with_options.find(R"("form":"sparse")"), 15,
                       R"("form":"sparse","options":{"mu_strategy":"<adaptive>","max_iter":"5"})");
  const auto html = [](const std::string& head) {
    for (const auto& [name, text] :
         comparison_documents({head, problem(0, "proved", proved_two), run(0, "good", "solved", "optimal", 2.0)})) {
      if (name == "report.html") return text;
    }
    return std::string();
  };
  EXPECT_THAT(html(with_options), HasSubstr("mu_strategy = &lt;adaptive&gt;, max_iter = 5"));
  const std::string plain = html(header);
  EXPECT_THAT(plain, ::testing::Not(HasSubstr("options of the library")));
  EXPECT_THAT(plain, HasSubstr("Jacobians and Hessians are free"));
  EXPECT_THAT(plain, HasSubstr("nearer by a tenth of the target's distance"));
}

TEST(ComparisonData, MostRepeatsDecide) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "proved", proved_two), run(0, "good", "time limit", "feasible", 2.1, 1.0, 0),
       run(0, "good", "solved", "optimal", 2.0, 0.9, 1), run(0, "good", "solved", "optimal", 2.0, 0.8, 2),
       run(0, "rigged", "solved", "optimal", 2.0, 0.1, 0), run(0, "rigged", "time limit", "feasible", 2.1, 1.0, 1),
       run(0, "rigged", "time limit", "infeasible", 1.0, 1.0, 2)});
  const comparison::Attempt &good = data.attempt(0, 0, 0), &rigged = data.attempt(0, 0, 1);
  EXPECT_TRUE(good.success);
  EXPECT_EQ(good.claim, "solved") << "of a repeat that went as most did";
  EXPECT_EQ(good.end_cost, 0.9) << "of 0.8, 0.9 and infinity";
  EXPECT_FALSE(rigged.success);
  EXPECT_EQ(rigged.successes, 1U);
  EXPECT_EQ(rigged.judgement, Judgement::feasible);
  EXPECT_TRUE(std::isinf(rigged.end_cost));
}

TEST(ComparisonData, RunsThatANoisyClockMayDecideAreTimedAgain) {
  const auto worth = [](const std::string& claim, double objective) {
    return comparison::read_comparison(
               {header, problem(0, "proved", proved_two), run(0, "good", claim, "feasible", objective)})
        .worth_repeating(0, 0, 0);
  };
  EXPECT_TRUE(worth("solved", 5.0)) << "its time is of interest in a pair of solvers that both come to 5";
  EXPECT_TRUE(worth("time limit", 2.0));
  EXPECT_TRUE(worth("time limit", 2.0019)) << "ten times 1e-4 of 2 is 2e-3";
  EXPECT_FALSE(worth("time limit", 2.0021));
  for (const std::string claim : {"refused", "crashed", "error"}) EXPECT_FALSE(worth(claim, 2.0)) << claim;
  EXPECT_FALSE(
      comparison::read_comparison({header, problem(0, "proved", proved_two), run(0, "good", "killed", "none", 2.0)})
          .worth_repeating(0, 0, 0));
}

TEST(ComparisonData, BestVerifiedAnswerIsTheReferenceWhereNothingIsProved) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "bound", R"("lower":1.0,"upper":null)"), problem(1, "bound", R"("lower":3.0,"upper":null)"),
       problem(2, "bound", R"("lower":0.0,"upper":null)"), run(0, "good", "solved", "optimal", 4.0),
       run(0, "rigged", "solved", "infeasible", 2.0), run(1, "good", "solved", "feasible", 3.0001)});
  EXPECT_EQ(data.cases[0].proof, "best known");
  EXPECT_EQ(data.cases[0].reference, 4.0) << "an answer that breaks a limit sets no record";
  EXPECT_EQ(data.cases[1].proof, "proved") << "the bound is reached";
  EXPECT_EQ(data.cases[2].proof, "unknown");
  EXPECT_TRUE(std::isnan(data.cases[2].reference));
}

TEST(ComparisonData, ContradictionsAreTold) {
  const ComparisonData data = comparison::read_comparison(
      {header, problem(0, "infeasible proved", R"("lower":null,"upper":null)", "infeasible"),
       problem(1, "proved", proved_two), problem(2, "infeasible proved", R"("lower":null,"upper":null)"),
       run(0, "good", "infeasible", "infeasible", 1.0), run(0, "rigged", "solved", "feasible", 1.0),
       run(1, "good", "solved", "optimal", 1.5)});
  EXPECT_TRUE(data.attempt(0, 0, 0).success) << "saying so is the right answer";
  EXPECT_FALSE(data.attempt(0, 0, 1).success);
  EXPECT_EQ(data.attempt(0, 0, 1).judgement, Judgement::impossible);
  EXPECT_THAT(data.contradictions,
              ::testing::ElementsAre(HasSubstr("p0 (size 1): proved infeasible, but rigged has a feasible point"),
                                     HasSubstr("p1 (size 1): good is below the proved bound 2: 1.5"),
                                     HasSubstr("p2 (size 1): the suite says feasible, but it is proved infeasible")));
}

TEST(ComparisonData, RefusesWhatIsNoRawData) {
  EXPECT_THROW(comparison::read_comparison({}), std::invalid_argument);
  EXPECT_THROW(comparison::read_comparison({header}), std::invalid_argument);
  EXPECT_THROW(comparison::read_comparison({R"({"record":"run")"}), std::invalid_argument);
  EXPECT_THROW(comparison::read_comparison({R"({"point":"ok"})"}), std::invalid_argument);
  const auto refuse = [](const std::vector<std::string>& lines, const char* words) {
    try {
      comparison::read_comparison(lines);
      ADD_FAILURE() << words;
    } catch (const std::invalid_argument& reason) {
      EXPECT_THAT(reason.what(), HasSubstr(words));
    }
  };
  const auto with = [](const char* more) { return run(0, "good", "solved", "optimal", 2.0, 1.0, 0, more); };
  refuse({header, problem(0, "proved", R"("lower":"NaN","upper":2.0)")}, "line 2: `lower` must be a number");
  refuse({header, problem(0, "proved", proved_two), with(R"(,"history":3)")}, "line 3: `history` must hold");
  std::string far = problem(0, "proved", proved_two);
  refuse({header, far.replace(far.find("\"case\":0"), 8, "\"case\":99999")}, "line 2: case 99999 has another index");
  EXPECT_THROW(
      comparison::read_comparison({header, problem(0, "proved", proved_two), run(5, "good", "solved", "optimal", 2.0)}),
      std::invalid_argument);
  EXPECT_THROW(comparison::read_comparison(
                   {header, problem(0, "proved", proved_two), run(0, "stranger", "solved", "optimal", 2.0)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace accdec
