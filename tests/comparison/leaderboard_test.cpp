#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/comparison/comparison_data.hpp>
#include <accdec/comparison/comparison_report.hpp>

namespace accdec {
namespace {

using ::testing::HasSubstr;

const std::string board_header =
    R"({"record":"comparison","schema":"accdec.comparison/1","title":"Mine & yours","notes":"Not tried: theirs.","starts":1,"repeats":1,"time_limit_s":1,)"
    R"("accuracy":1e-4,"targets":[0.1],"solvers":[{"name":"slow","library":"L 1"},{"name":"quick","library":"L 2"},)"
    R"({"name":"liar","library":"L 3"}]})";

std::string board_problem(int c, const std::string& proof, int work) {
  const std::string bounds = proof == "bound" ? R"("lower":1,"upper":null)" : R"("lower":2,"upper":2)";
  return fmt::format(
      R"({{"record":"problem","index":{0},"case":{0},"problem":"p{0}","family":"f","question":"design","size":1,"order":9,"variables":9,)"
      R"("rows":0,"expected":"unknown","proof":"{1}",{2},"method":"m","work":{3}}})",
      c, proof, bounds, work);
}

std::string board_run(int c, const std::string& solver, const std::string& claim, const std::string& verdict,
                      const std::string& objective, double time) {
  return fmt::format(
      R"({{"record":"run","case":{},"start":0,"solver":"{}","repeat":0,"claim":"{}","verdict":"{}","objective":{},"wall_time_s":{}}})",
      c, solver, claim, verdict, objective, time);
}

std::string board_cell(const ComparisonTable& table, const std::string& solver, const std::string& column) {
  const auto at = std::find(table.head.begin(), table.head.end(), column) - table.head.begin();
  for (const auto& row : table.rows) {
    if (row.front() == solver) return row.at(static_cast<std::size_t>(at));
  }
  return "no such row";
}

/// Easy, hard and open problems and one without an answer; counted by hand.
std::vector<std::string> board_lines() {
  return {board_header,
          board_problem(0, "proved", 10),
          board_problem(1, "proved", 1000),
          board_problem(2, "bound", 5000),
          board_problem(3, "infeasible proved", 3),
          board_run(0, "slow", "solved", "feasible", "2", 0.4),
          board_run(1, "slow", "solved", "feasible", "2", 0.6),
          board_run(2, "slow", "solved", "feasible", "3", 0.6),
          board_run(3, "slow", "infeasible", "none", "null", 0.1),
          board_run(0, "quick", "solved", "feasible", "2", 0.1),
          board_run(1, "quick", "solved", "feasible", "3", 0.1),
          board_run(2, "quick", "killed", "none", "null", 1.0),
          board_run(3, "quick", "solved", "infeasible", "1", 0.1),
          board_run(0, "liar", "solved", "infeasible", "1", 0.1),
          board_run(1, "liar", "infeasible", "none", "null", 0.1),
          board_run(2, "liar", "infeasible", "none", "null", 0.1),
          board_run(3, "liar", "refused", "none", "null", 0.1)};
}

TEST(Leaderboard, CountsByDifficulty) {
  const ComparisonTable t = leaderboard_table(comparison::read_comparison(board_lines()));
  ASSERT_EQ(t.rows.size(), 3u);
  EXPECT_EQ(t.rows[0][0], "slow") << "the most optima first";
  EXPECT_EQ(t.rows[2][0], "liar");
  EXPECT_EQ(board_cell(t, "slow", "optima reached / %"), "100.0");
  EXPECT_EQ(board_cell(t, "slow", "of"), "2") << "open problems and those without answer do not count";
  EXPECT_EQ(board_cell(t, "slow", "easy / %"), "100.0");
  EXPECT_EQ(board_cell(t, "slow", "median time / s"), "0.5");
  EXPECT_EQ(board_cell(t, "slow", "infeasibility recognised"), "1");
  EXPECT_EQ(board_cell(t, "slow", "wrong claims"), "0");
  EXPECT_EQ(board_cell(t, "quick", "easy / %"), "100.0");
  EXPECT_EQ(board_cell(t, "quick", "hard / %"), "0.0");
  EXPECT_EQ(board_cell(t, "quick", "claimed solved, but worse"), "1");
  EXPECT_EQ(board_cell(t, "quick", "wrong claims"), "1");
  EXPECT_EQ(board_cell(t, "quick", "out of time"), "1");
  EXPECT_EQ(board_cell(t, "liar", "reached"), "0");
  EXPECT_EQ(board_cell(t, "liar", "wrong claims"), "3") << "a solution that breaks a limit, twice that there is none";
  EXPECT_EQ(board_cell(t, "liar", "claims"), "3");
  EXPECT_EQ(board_cell(t, "liar", "claimed infeasible, but is not"), "2");
  EXPECT_EQ(board_cell(t, "liar", "refused"), "1");
  EXPECT_EQ(board_cell(t, "liar", "without a claim"), "0");
  EXPECT_EQ(board_cell(t, "liar", "median time / s"), "");
}

TEST(Leaderboard, PageSaysHowToJoinAndWhatIsFair) {
  const auto documents = comparison_documents(board_lines());
  const auto page =
      std::find_if(documents.begin(), documents.end(), [](const auto& d) { return d.first == "leaderboard.html"; });
  ASSERT_NE(page, documents.end());
  EXPECT_THAT(page->second, HasSubstr("Mine &amp; yours"));
  EXPECT_THAT(page->second, HasSubstr("4 problems: 2 with a proved optimum, 1 proved to have no answer, 1 open."));
  EXPECT_THAT(page->second, HasSubstr("1 easy, 1 hard"));
  EXPECT_THAT(page->second, HasSubstr("[[external]]"));
  EXPECT_THAT(page->second, HasSubstr("Fairness"));
  EXPECT_THAT(page->second, HasSubstr("Not tried: theirs."));
  EXPECT_THAT(page->second, HasSubstr("asked of the library"));
  EXPECT_THAT(page->second, ::testing::Not(HasSubstr("src=")));
}

TEST(Leaderboard, CostsAreNeverUnbounded) {
  std::vector<std::string> lines = board_lines();
  for (const int c : {0, 2, 3})
    lines[static_cast<std::size_t>(13 + c)] = board_run(c, "liar", "unbounded", "none", "null", 0.1);
  const ComparisonTable t = leaderboard_table(comparison::read_comparison(lines));
  EXPECT_EQ(board_cell(t, "liar", "wrong claims"), "4") << "also of the problem without an answer";
  EXPECT_EQ(board_cell(t, "liar", "claimed infeasible, but is not"), "1");
}

TEST(Leaderboard, OnlyWhatRanTooLongIsOutOfTime) {
  std::vector<std::string> lines = board_lines();
  const char* const claims[] = {"crashed", "failed", "invalid number", "time limit"};
  for (int c = 0; c < 4; ++c)
    lines[static_cast<std::size_t>(13 + c)] = board_run(c, "liar", claims[c], "none", "null", 0.1);
  const ComparisonTable t = leaderboard_table(comparison::read_comparison(lines));
  EXPECT_EQ(board_cell(t, "liar", "out of time"), "1");
  EXPECT_EQ(board_cell(t, "liar", "without a claim"), "3");
  EXPECT_EQ(board_cell(t, "liar", "claims"), "0");
}

TEST(Leaderboard, OlderRawDataHaveNoDifficulties) {
  std::vector<std::string> old = board_lines();
  for (std::string& line : old) {
    if (const std::size_t at = line.find(",\"work\":"); at != std::string::npos) line = line.substr(0, at) + "}";
  }
  const ComparisonTable t = leaderboard_table(comparison::read_comparison(old));
  EXPECT_EQ(board_cell(t, "slow", "optima reached / %"), "100.0");
  EXPECT_EQ(std::find(t.head.begin(), t.head.end(), "easy / %"), t.head.end());
}

}  // namespace
}  // namespace accdec
