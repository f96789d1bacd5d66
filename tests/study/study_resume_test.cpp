#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>

#include <sys/wait.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "support/study_command.hpp"

// The command as a user runs it, ended in the middle by whatever ends it, and run again.

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::write;

class StudyResume : public accdec::testing::StudyCommand {};

TEST_F(StudyResume, KilledAtAnyMomentItGoesOnWhereItWas) {
  study(60);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  int kills = 0;
  for (int attempt = 0; attempt < 12 && kills < 3; ++attempt) {
    if (!killed_after("study study.toml --out killed --workers 1", "killed", 20)) break;
    ++kills;
  }
  EXPECT_GE(kills, 1);
  EXPECT_FALSE(fs::exists(home_ / "killed/report.html"));
  const Outcome last = run("study study.toml --out killed");
  ASSERT_EQ(last.exit_code, 0) << last.output;
  EXPECT_THAT(last.output, Not(HasSubstr("240 computed"))) << "what was done before the kill is not done again";
  expect_same_results("whole", "killed");
  EXPECT_THAT(run("study study.toml --out killed").output, HasSubstr("240 points: 0 computed"));
}

TEST_F(StudyResume, AKilledFreshRunGoesOnWithoutFreshAndTakesNothingOld) {
  study(60);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  // Rows that tell where they come from: whatever is taken from the old results keeps the mark.
  std::string rows = content(home_ / "out/rows.jsonl");
  for (std::size_t at = 0; (at = rows.find("\"point\":\"ok\"", at)) != std::string::npos; at += 20)
    rows.insert(at, "\"old\":1,");
  write(home_ / "out/rows.jsonl", rows);
  ASSERT_TRUE(killed_after("study study.toml --out out --fresh --workers 1", "out", 80));
  EXPECT_EQ(content(home_ / "out/rows.jsonl"), rows) << "the old results stay until the new ones are complete";
  // Killed again on the way, and started fresh again: only the last start counts.
  ASSERT_TRUE(killed_after("study study.toml --out out --workers 1", "out", 20));
  const auto done = journal_lines("out") - 2;  // without the header and the mark
  EXPECT_GE(done, 90);
  const Outcome rest = run("study study.toml --out out");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_THAT(rest.output, HasSubstr(fmt::format("240 points: {} computed", 240 - done)));
  expect_same_results("whole", "out");
  ASSERT_TRUE(killed_after("study study.toml --out out --fresh --workers 1", "out", 80));
  EXPECT_THAT(run("study study.toml --out out --fresh").output, HasSubstr("240 points: 240 computed"));
  EXPECT_THAT(run("study study.toml --out out").output, HasSubstr("240 points: 0 computed"));
  expect_same_results("whole", "out");
}

TEST_F(StudyResume, AFreshRunTakesOverTheFolderOfAnEarlierForm) {
  study(60);
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  const std::string before = content(home_ / "out/rows.jsonl");
  study(50);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  EXPECT_EQ(run("study study.toml --out out").exit_code, 2);
  EXPECT_EQ(content(home_ / "out/rows.jsonl"), before);
  ASSERT_TRUE(killed_after("study study.toml --out out --fresh --workers 1", "out", 60));
  EXPECT_EQ(content(home_ / "out/rows.jsonl"), before) << "the old results stay until the new ones are complete";
  const Outcome rest = run("study study.toml --out out");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_THAT(rest.output, Not(HasSubstr("200 points: 200 computed")));
  expect_same_results("whole", "out");
  // A folder that is no study's stays untouched.
  fs::create_directory(home_ / "other");
  write(home_ / "other/rows.jsonl", "mine");
  EXPECT_EQ(run("study study.toml --out other --fresh").exit_code, 2);
  EXPECT_EQ(content(home_ / "other/rows.jsonl"), "mine");
}

TEST_F(StudyResume, PointsLostWithTheirProcessAreComputedByTheNextRun) {
  study(60, "isolation = \"processes\"");
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  const pid_t child = start("study study.toml --out out --workers 2");
  int killed = 0, status = 0;
  while (killed < 2 && ::waitpid(child, &status, WNOHANG) == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::istringstream children(content(fmt::format("/proc/{0}/task/{0}/children", child)));
    pid_t worker = 0;
    if (journal_lines("out") > 5 * (killed + 1) && children >> worker && ::kill(worker, SIGKILL) == 0) ++killed;
  }
  if (status == 0) ::waitpid(child, &status, 0);
  ASSERT_GE(killed, 1);
  const std::string rows = content(home_ / "out/rows.jsonl");
  std::size_t lost = 0;
  for (std::size_t at = 0; (at = rows.find("\"point\":\"lost\"", at)) != std::string::npos; ++at) ++lost;
  ASSERT_GE(lost, 1u);
  EXPECT_THAT(content(home_ / "log"), HasSubstr(fmt::format("{} of them were lost", lost)));
  const Outcome again = run("study study.toml --out out");
  EXPECT_THAT(again.output, HasSubstr(fmt::format("240 points: {} computed", lost)));
  EXPECT_THAT(again.output, Not(HasSubstr("lost")));
  expect_same_results("whole", "out");
}

TEST_F(StudyResume, StoppedByHandItSaysWhatIsKeptOnce) {
  study(200, "isolation = \"processes\"");
  const pid_t child = start("study study.toml --out out --workers 2");
  int status = 0;
  pid_t ended = 0;
  while (journal_lines("out") < 5 && (ended = ::waitpid(child, &status, WNOHANG)) == 0) std::this_thread::yield();
  ASSERT_EQ(ended, 0) << "the study ended before it could be stopped";
  // As a terminal does: to the workers, too.
  std::istringstream children(content(fmt::format("/proc/{0}/task/{0}/children", child)));
  for (pid_t worker = 0; children >> worker;) ::kill(worker, SIGINT);
  ::kill(child, SIGINT);
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
  const std::string said =
      "stopped; the points computed so far are kept in out; the same command goes on with the rest";
  const std::string log = content(home_ / "log");
  ASSERT_NE(log.find(said), std::string::npos) << log;
  EXPECT_EQ(log.find(said), log.rfind(said)) << "the workers say nothing";
  const Outcome rest = run("study study.toml --out out");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_THAT(rest.output, Not(HasSubstr("800 computed")));
}

TEST_F(StudyResume, AFullDiskEndsItAndWithRoomItGoesOn) {
  study(40);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  // No file may grow beyond 16 or 32 KiB, whatever the shell's blocks: the journal needs more.
  const Outcome full = run("study study.toml --out out", "trap '' XFSZ && ulimit -f 32");
  EXPECT_EQ(full.exit_code, 2) << full.output;
  EXPECT_THAT(full.output, HasSubstr("study.journal: File too large"));
  EXPECT_FALSE(fs::exists(home_ / "out/rows.csv"));
  const Outcome rest = run("study study.toml --out out");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_THAT(rest.output, Not(HasSubstr("160 computed")));
  expect_same_results("whole", "out");
}

TEST_F(StudyResume, GoesOnAtOnceThoughTheDeadRunsChildrenAreStillThere) {
  study(60, "isolation = \"processes\"");
  for (int attempt = 0; attempt < 8; ++attempt) {
    const pid_t child = start("study study.toml --out killed --workers 5");
    std::this_thread::sleep_for(std::chrono::milliseconds(15 + 10 * attempt));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
  }
  const Outcome last = run("study study.toml --out killed");
  EXPECT_EQ(last.exit_code, 0) << last.output;
}

TEST_F(StudyResume, AKilledMergeCanBeRepeated) {
  study(40);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  for (const char* shard : {"1/2", "2/2"})
    ASSERT_EQ(run(fmt::format("study study.toml --out parts --shard {}", shard)).exit_code, 0);
  for (const int milliseconds : {5, 10, 20, 40, 60, 80}) {
    const pid_t child = start("study study.toml --out merged --merge parts");
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
  }
  const Outcome last = run("study study.toml --out merged --merge parts");
  ASSERT_EQ(last.exit_code, 0) << last.output;
  expect_same_results("whole", "merged");
  EXPECT_FALSE(fs::exists(home_ / "merged/study.journal"));
}

}  // namespace
