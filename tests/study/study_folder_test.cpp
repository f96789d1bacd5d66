#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "support/study_command.hpp"

// The command as a user runs it.

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::StudyCommand;
using accdec::testing::write;

TEST_F(StudyCommand, RunsAndRecordsBadPointsWithoutStopping) {
  study(3);
  const Outcome r = run("study study.toml --out out");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::string csv = content(home_ / "out/rows.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
  EXPECT_THAT(csv, HasSubstr("270"));
  EXPECT_THAT(csv, HasSubstr("allowed is 0 < angle_deg <= 180"));
  EXPECT_THAT(r.output, HasSubstr("3 without an answer"));
  EXPECT_THAT(r.output, Not(HasSubstr("points/s"))) << "no progress bar but on a terminal";
  const std::string html = content(home_ / "out/report.html");
  EXPECT_THAT(html, HasSubstr("<svg"));
  EXPECT_THAT(html, Not(HasSubstr("href=\"http")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
  EXPECT_FALSE(fs::exists(home_ / "out/study.journal"));
  EXPECT_THAT(content(home_ / "out/manifest.json"), HasSubstr("accdec study study.toml --out out"));
}

TEST_F(StudyCommand, ResultsThatDoNotFitIntoMemoryAreRefusedBeforeAnythingIsComputed) {
  write(
      home_ / "study.toml",
      "task = \"task.toml\"\ncompute = [\"given\"]\n[[vary]]\nkey = \"corner.A.angle_deg\"\nrange = { from = 30, to = "
      "150, count = 10000 }\n[[vary]]\nkey = \"corner.A.feed_in_mm_min\"\nrange = { from = 3000, to = 6000, count = "
      "1000 }\n");
  EXPECT_THAT(run("study study.toml --out none").output, HasSubstr("more than 100000 need --large"));
  // Ten million points in 2 GB of address space.
  const Outcome r = run("study study.toml --out none --large", "ulimit -v 2000000");
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.output, HasSubstr("GB of memory"));
  EXPECT_FALSE(fs::exists(home_ / "none"));
}

TEST_F(StudyCommand, GoodPointsAreComputedWhereverTheBadOnesStand) {
  // First, middle and last are bad.
  const std::string head = "task = \"task.toml\"\ncompute = [\"given\"]\n";
  write(home_ / "study.toml", head + "[[vary]]\nkey = \"corner.A.angle_deg\"\nvalues = [0, 30, 60, 0, 90, 120, 200]\n");
  const Outcome list = run("study study.toml --out list");
  EXPECT_EQ(list.exit_code, 0) << list.output;
  EXPECT_THAT(list.output, HasSubstr("7 points: 7 computed"));
  EXPECT_THAT(list.output, HasSubstr("3 without an answer"));
  // 10 to 170 degrees are five of forty values, where no probing by halves would come upon them.
  write(home_ / "study.toml",
        head + "[[vary]]\nkey = \"corner.A.angle_deg\"\nrange = { from = -190, to = 1370, count = 40 }\n");
  EXPECT_THAT(run("study study.toml --out range").output, HasSubstr("35 without an answer"));
  // All are bad, but no one axis is to blame: that is an outcome, with the reasons in the rows.
  write(home_ / "study.toml", head +
                                  "[[vary]]\nkey = \"sample_period_ms\"\nvalues = [0, 1]\n[[vary]]\nkey = "
                                  "\"corner.A.angle_deg\"\nvalues = [270, 300]\n");
  const Outcome none = run("study study.toml --out none");
  EXPECT_EQ(none.exit_code, 1) << none.output;
  EXPECT_THAT(none.output, HasSubstr("4 without an answer"));
}

TEST_F(StudyCommand, AStudyInWhichEveryComputationBreaksOffHasNoAnswer) {
  write(home_ / "bare.toml",
        "sample_period_ms = 1\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
  // Only one of the cases has a filter; clp solves linear problems only and refuses this one with an exception.
  write(home_ / "study.toml",
        "compute = [\"given\"]\n[[case]]\nname = \"a\"\ntask = \"task.toml\"\n[[case]]\nname = \"b\"\ntask = "
        "\"bare.toml\"\n");
  const Outcome one = run("study study.toml --out one");
  EXPECT_EQ(one.exit_code, 0) << one.output;
  EXPECT_THAT(one.output, HasSubstr("1 without an answer"));
  EXPECT_THAT(content(home_ / "one/rows.csv"),
              HasSubstr(",error,\"the task has no [filter], which this computation needs\""));
  write(home_ / "study.toml",
        "task = \"bare.toml\"\ncompute = [\"optimum\"]\nmethod = \"nlp\"\nsolver = \"clp\"\ntime_limit_s = 5\n");
  const Outcome all = run("study study.toml --out all");
  EXPECT_EQ(all.exit_code, 1) << all.output;
  EXPECT_THAT(content(home_ / "all/manifest.json"), HasSubstr("\"points_without_answer\": 1"));
}

TEST_F(StudyCommand, ShardsMergeToTheSameAndSoDoThreadsAndProcesses) {
  study(5);
  ASSERT_EQ(run("study study.toml --out whole --workers 1").exit_code, 0);
  for (const char* shard : {"1/3", "2/3"})
    ASSERT_EQ(run(fmt::format("study study.toml --out parts --shard {}", shard)).exit_code, 0);
  const Outcome early = run("study study.toml --out merged --merge parts");
  EXPECT_EQ(early.exit_code, 2);
  EXPECT_THAT(early.output, HasSubstr("6 of 20 points are missing"));
  EXPECT_FALSE(fs::exists(home_ / "merged"));
  ASSERT_EQ(run("study study.toml --out elsewhere --shard 3/3").exit_code, 0);
  ASSERT_EQ(run("study study.toml --out merged --merge parts elsewhere").exit_code, 0);
  expect_same_results("whole", "merged");
  ASSERT_EQ(run("study study.toml --out many --workers 7").exit_code, 0);
  expect_same_results("whole", "many");
  study(5, "isolation = \"processes\"");
  ASSERT_EQ(run("study study.toml --out children --workers 3").exit_code, 0);
  expect_same_results("whole", "children");
}

TEST_F(StudyCommand, ResultsOfAnotherStudyAreLeftAlone) {
  study(2);
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  const std::string before = content(home_ / "out/rows.csv"), manifest = content(home_ / "out/manifest.json");
  study(3);
  const Outcome other = run("study study.toml --out out");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("another study"));
  EXPECT_EQ(content(home_ / "out/rows.csv"), before);
  EXPECT_EQ(content(home_ / "out/manifest.json"), manifest);
  fs::create_directories(home_ / "mine");
  write(home_ / "mine/thesis.txt", "years of work");
  const Outcome mine = run("study study.toml --out mine");
  EXPECT_EQ(mine.exit_code, 2);
  EXPECT_THAT(mine.output, HasSubstr("holds no study"));
  EXPECT_EQ(std::distance(fs::directory_iterator(home_ / "mine"), fs::directory_iterator()), 1);
  // A journal is no passport: somebody else's report stays.
  write(home_ / "mine/other.journal", "diary");
  write(home_ / "mine/report.html", "years of work");
  EXPECT_EQ(run("study study.toml --out mine").exit_code, 2);
  EXPECT_EQ(content(home_ / "mine/report.html"), "years of work");
  // The marker of another study is none of this one.
  fs::create_directories(home_ / "marked");
  write(home_ / "marked/accdec-folder.json", R"({"schema": "accdec.study/1", "study_hash": "other"})");
  EXPECT_EQ(run("study study.toml --out marked").exit_code, 2);
  // The base task is part of the study: changing a limit in it must not mix old rows with new.
  ASSERT_EQ(run("study study.toml --out two").exit_code, 0);
  std::string task = content(home_ / "task.toml");
  write(home_ / "task.toml", task.replace(task.find("8000"), 4, "9000"));
  EXPECT_EQ(run("study study.toml --out two").exit_code, 2);
}

TEST_F(StudyCommand, DamagedRowsAreComputedAnew) {
  study(5);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  ASSERT_EQ(run("study study.toml --out out --shard 1/2").exit_code, 0);
  const std::string journal = content(home_ / "out/shard-1-of-2.journal");
  const std::string head = journal.substr(0, journal.find('\n') + 1);
  fs::remove(home_ / "out/shard-1-of-2.journal");
  // Beyond the study, not JSON, and of another point.
  write(home_ / "out/study.journal", head +
                                         "99999 0.1 {\"index\":99999,\"point\":\"ok\"}\n3 0.1 {\"index\":3,oops}\n4 "
                                         "0.1 {\"index\":5,\"point\":\"ok\"}\n");
  const Outcome r = run("study study.toml --out out");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_THAT(r.output, HasSubstr("20 computed"));
  expect_same_results("whole", "out");
  std::string rows = content(home_ / "out/rows.jsonl");
  const std::size_t second = rows.find('\n') + 1;
  write(home_ / "out/rows.jsonl", rows.replace(second, rows.find('\n', second) - second, "garbage"));
  EXPECT_THAT(run("study study.toml --out out").output, HasSubstr("1 computed"));
  expect_same_results("whole", "out");
}

TEST_F(StudyCommand, TheManifestStatesTheShareOfTimeInTheMethod) {
  study(40);
  ASSERT_EQ(run("study study.toml --out out --workers 2").exit_code, 0);
  const std::string manifest = content(home_ / "out/manifest.json");
  const auto number = [&](const std::string& key) {
    const std::size_t at = manifest.find(fmt::format("\"{}\": ", key));
    return at == std::string::npos ? -1.0 : std::stod(manifest.substr(at + key.size() + 4));
  };
  EXPECT_EQ(number("workers"), 2.0);
  EXPECT_GT(number("method_share"), 0.0);
  EXPECT_LE(number("method_share"), 1.0);
  EXPECT_NEAR(number("method_share"), number("method_time_s") / (2.0 * number("wall_time_s")), 1e-9);
}

TEST_F(StudyCommand, TheReportSaysWhereTimeCutOptimaOff) {
  const std::string text = "task = \"bare.toml\"\ncompute = [\"optimum\"]\n";
  // Hundreds of samples: far more than ten milliseconds' work.
  write(home_ / "bare.toml",
        "sample_period_ms = 0.1\n[[axis]]\nacceleration_max_mm_s2 = 8000\njerk_max_mm_s3 = 800000\n"
        "[[corner]]\nangle_deg = 77\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
  write(home_ / "study.toml", text + "time_limit_s = 0.01\n");
  const Outcome r = run("study study.toml --out short");
  EXPECT_THAT(content(home_ / "short/rows.csv"), HasSubstr("time limit")) << r.output;
  EXPECT_THAT(content(home_ / "short/report.html"),
              HasSubstr("1 computation was cut off by the study's time limit of 0.01 s"));
  study(2);
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  EXPECT_THAT(content(home_ / "out/report.html"), Not(HasSubstr("cut off")));
}

constexpr const char* head = "task = \"task.toml\"\ncompute = [\"delays\"]\n";

std::string vary(const std::string& key, const std::string& values) {
  return fmt::format("[[vary]]\nkey = \"{}\"\nvalues = {}\n", key, values);
}

/// Studies that are refused before anything is written.
class BadStudy : public StudyCommand {
 protected:
  using Cases = std::vector<std::pair<std::string, std::string>>;  // a study, and what is said of it
  void refused(const Cases& cases) {
    write(home_ / "bare.toml",
          "sample_period_ms = 1\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
    write(home_ / "broken.toml", "sample_period_ms = 1\n[[corner]]\nangle_deg = 190\nfeed_in_mm_min = 6000\n");
    for (const auto& [text, message] : cases) {
      write(home_ / "study.toml", text);
      const Outcome r = run("study study.toml --out out");
      EXPECT_EQ(r.exit_code, 2) << text << r.output;
      EXPECT_THAT(r.output, HasSubstr(message)) << text;
      EXPECT_FALSE(fs::exists(home_ / "out")) << text;
    }
  }
};

TEST_F(BadStudy, BaseTaskAndVariedKeysAreChecked) {
  refused({
      {"compute = [\"delays\"]\n", "needs a base `task`"},
      {"task = \"task.toml\"\n", "needs `compute`"},
      {"task = \"none.toml\"\ncompute = [\"delays\"]\n", "study.toml:1:8: none.toml does not exist"},
      {"task = \"task.toml\"\ncompute = [\"optimun\"]\n", "unknown computation \"optimun\"; did you mean \"optimum\"?"},
      {head + vary("corner.A.error_max_mm", "[1]"), "did you mean `error_max_um`"},
      {head + vary("corner.B.error_max_um", "[1]"), "no corner `B`; it has A"},
      {head + vary("error_max_um", "[1]"), "did you mean `corner.*.error_max_um`"},
      {head + vary("axes.x.mass_kg", "[1]"), "a task has no `axes`"},
      {head + vary("corner", "[1]"), "is a table of a task"},
      {head + vary("corner.error_max_um", "[1]"), "corner.NAME.KEY"},
      {head + vary("corner.A.error_max_um", "[]"), "is empty"},
      {head + vary("corner.A.error_max_um", "[1, \"x\"]"), "values"},
      {std::string(head) + "[[vary]]\nkey = \"corner.A.error_max_um\"\n", "either `values` or `range`"},
      {std::string(head) + "[[vary]]\nvalues = [1]\n", "needs `key`"},
      {std::string(head) +
           "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = 0, to = 1, count = 3, log = true }\n",
       "above 0"},
      {std::string(head) + "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = 0, to = 1, count = 0 }\n",
       "count"},
  });
}

TEST_F(BadStudy, SamplingFiguresAndCasesAreChecked) {
  refused({
      {std::string(head) + "samples = 3\n", "goes with sampling"},
      {std::string(head) + "sampling = \"latin-hypercube\"\nsamples = 3\n", "at least one [[vary]]"},
      {std::string(head) + "[[figure]]\nx = \"index\"\ny = \"delays.cycle_time\"\n", "no column `delays.cycle_time`"},
      {std::string(head) + "[[figure]]\nname = \"../x\"\nx = \"index\"\ny = \"index\"\n", "small letters"},
      {std::string(head) + "[[figur]]\nx = 1\n", "did you mean `figure`"},
      {std::string(head) + "[[case]]\nname = \"a\"\n[[case]]\nname = \"a\"\n", "taken already"},
      {std::string(head) + "[[case]]\nname = \"a\"\nset = { \"filter.ordr\" = 3 }\n", "did you mean `order`"},
      {head + vary("corner.A.angle_deg", "[200, 300]"),
       "study.toml:4:7: no value of `corner.A.angle_deg` makes a task: "},
      {head + vary("corner.A.angle_deg", "[200, 300]"), "0 < angle_deg <= 180"},
      {head + vary("corner.A.error_max_um", "[1, 2]") + vary("filter.kind", "[1]"),
       "study.toml:7:7: no value of `filter.kind` makes a task: "},
      {head + vary("", "[1]"), "a task key is empty; write for example `corner.*.error_max_um`"},
      {std::string(head) + "[[case]]\nname = \"a\"\n[[case]]\nname = \"b\"\nset = { \"corner.A.angle_deg\" = 200 }\n",
       "study.toml:7:7: `set` of case \"b\" makes no task: "},
      {std::string(head) + "method = \"nlp\"\nsolver = \"ipotp\"\n",
       "study.toml:4:10: unknown solver \"ipotp\"; did you mean \"ipopt\"? known are "},
      {"task = \"bare.toml\"\ncompute = [\"boxcar\", \"given\"]\n",
       "study.toml:2:11: `given` is of a given filter, and bare.toml has no [filter]"},
      {"task = \"broken.toml\"\ncompute = [\"boxcar\"]\n" + vary("corner.A.error_max_um", "[1, 2]"),
       "broken.toml:3:13: "},
      {std::string(head) +
           "[[vary]]\nname = \"a\"\nkey = \"corner.A.angle_deg\"\nvalues = [1]\n[[vary]]\nname = \"a\"\nkey = "
           "\"corner.A.heading_deg\"\nvalues = [1]\n",
       "two variations"},
  });
}

TEST_F(BadStudy, NothingIsSetOrNamedTwice) {
  refused({
      // Values that would be overwritten without a word: a place set twice, a column named twice.
      {head + vary("corner.A.error_max_um", "[1]") +
           "[[vary]]\nname = \"b\"\nkey = \"corner.0.error_max_um\"\nvalues = [2]\n",
       "is set by the variation `corner.A.error_max_um` already"},
      {head + vary("corner.*.error_max_um", "[1]") + vary("corner.A.error_max_um", "[2]"),
       "is set by the variation `corner.*.error_max_um` already"},
      {std::string(head) + "[[vary]]\nname = \"index\"\nkey = \"corner.A.angle_deg\"\nvalues = [1]\n",
       "column of that name"},
      {std::string(head) + "[[vary]]\nname = \"delays.status\"\nkey = \"corner.A.angle_deg\"\nvalues = [1]\n",
       "column of that name"},
      {std::string(head) + "[[ratio]]\nname = \"point\"\nof = \"index\"\nto = \"index\"\n", "a column `point` already"},
  });
}

TEST_F(BadStudy, ValuesAreFinite) {
  refused({
      {head + vary("corner.A.error_max_um", "[nan]"), "must be finite"},
      {head + vary("corner.A.error_max_um", "[inf]"), "must be finite"},
      {std::string(head) + "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = 1, to = nan, count = 3 }\n",
       "must be finite"},
      {std::string(head) +
           "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = -1, to = 1, count = 3, log = true }\n",
       "above 0"},
  });
}

TEST_F(BadStudy, TooManyPointsAreRefused) {
  write(
      home_ / "study.toml",
      std::string(head) + "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = 1, to = 9, count = 100001 }\n");
  EXPECT_THAT(run("study study.toml --out out").output,
              HasSubstr("study.toml:5:9: the study has 100001 points, most by the 100001 values of "
                        "`corner.A.error_max_um`; more than 100000 need --large"));
  write(home_ / "study.toml",
        std::string(head) + "[[vary]]\nkey = \"corner.A.error_max_um\"\nrange = { from = 1, to = 9, count = 10000 }\n" +
            "[[vary]]\nkey = \"corner.A.angle_deg\"\nrange = { from = 1, to = 9, count = 10000 }\n");
  EXPECT_THAT(run("study study.toml --out out --large").output, HasSubstr("allowed is up to 10000000"));
  EXPECT_FALSE(fs::exists(home_ / "out"));
}

TEST_F(BadStudy, ShardsThatAreNotThereAreRefused) {
  study(2);
  for (const char* shard : {"0/3", "4/3", "1", "x/2", "-1/2", "1/2/3", "1/2x", "1/99999999999999999999"}) {
    EXPECT_EQ(run(fmt::format("study study.toml --out out --shard={}", shard)).exit_code, 2) << shard;
  }
  EXPECT_FALSE(fs::exists(home_ / "out"));
}

}  // namespace
