#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/batch/cluster.hpp>
#include <accdec/batch/journal.hpp>
#include <accdec/batch/shards.hpp>
#include <accdec/study/point_set.hpp>
#include <accdec/study/row_store.hpp>
#include <accdec/study/study_folder.hpp>

#include "support/study_command.hpp"

namespace accdec::study {

using namespace batch;
namespace {

namespace fs = std::filesystem;
using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::StudyCommand;
using accdec::testing::write;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Shards, RangesAreWhatSlurmTakes) {
  EXPECT_EQ(ranges_text({}), "");
  EXPECT_EQ(ranges_text({4}), "4");
  EXPECT_EQ(ranges_text({1, 2, 3, 7, 9, 10}), "1-3,7,9-10");
}

TEST(Shards, ShareOutEveryPoint) {
  std::vector<std::size_t> all;
  for (std::size_t i = 1; i <= 4; ++i) {
    const auto part = shard(10, i, 4);
    all.insert(all.end(), part.begin(), part.end());
  }
  std::sort(all.begin(), all.end());
  EXPECT_THAT(all, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_THAT(shard(2, 3, 3), ElementsAre());
  EXPECT_THROW(shard(10, 0, 4), std::invalid_argument);
  EXPECT_THROW(shard(10, 5, 4), std::invalid_argument);
}

TEST(Shards, OfAGridHaveTheirPartOfEveryValueOfEveryAxis) {
  // 20 values and 10 shards: stripes would give each shard two of the twenty.
  const std::size_t values = 20, others = 500, shards = 10;
  for (std::size_t number = 1; number <= shards; ++number) {
    const auto part = shard(values * others, number, shards);
    ASSERT_EQ(part.size(), values * others / shards);
    EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
    std::vector<int> fast(values), slow(values);
    for (const std::size_t i : part) ++fast[i % values], ++slow[i / others];
    for (std::size_t v = 0; v < values; ++v) {
      // Drawn 500 times with a chance of 1/10: 50 on average, with a deviation of 6.7.
      EXPECT_NEAR(fast[v], 50, 4.5 * 6.7) << number << " " << v;
      EXPECT_EQ(slow[v], 50) << number << " " << v;
    }
  }
  EXPECT_EQ(shard(7, 1, 1).size(), 7u);
  EXPECT_EQ(shard(7, 3, std::size_t{1} << 60).size(), 1u) << "more shards than points cost no memory";
}

TEST(Shards, AreTheSameOnEveryPlatform) {
  // The generator is that of the standard, which fixes its 10000th value from seed 5489. A deal computed here in whole
  // numbers shows that the shards use only integers and exact floating point.
  std::mt19937_64 rng(1);
  std::vector<std::size_t> deal(6);
  std::iota(deal.begin(), deal.end(), std::size_t{0});
  for (std::size_t i = deal.size(); i > 1; --i)
    std::swap(deal[i - 1], deal[static_cast<std::size_t>(((rng() >> 11) * i) >> 53)]);
  for (std::size_t number = 1; number <= deal.size(); ++number)
    EXPECT_THAT(shard(6, number, 6), ElementsAre(deal[number - 1]));
}

TEST(Shards, OwnersAreThoseWhoseShardsHaveThePoint) {
  for (const auto& [size, count] : {std::pair(100, 7), std::pair(5, 5), std::pair(12, 4), std::pair(3, 8)}) {
    const auto owners = shard_owners(static_cast<std::size_t>(size), static_cast<std::size_t>(count));
    for (int s = 1; s <= count; ++s) {
      std::vector<std::size_t> owned;
      for (std::size_t i = 0; i < owners.size(); ++i) {
        if (owners[i] == static_cast<std::uint32_t>(s)) owned.push_back(i);
      }
      EXPECT_EQ(owned, shard(owners.size(), static_cast<std::size_t>(s), static_cast<std::size_t>(count)));
    }
  }
}

TEST(RowStore, TakesRowsOfTheirPointsOnlyAndNoLostOneForAnAnswer) {
  const std::string path = ::testing::TempDir() + "accdec_row_store";
  const std::string rows[] = {R"({"index":0,"point":"ok"})", R"({"index":1,"point":"lost"})",
                              R"({"index":0,"point":"lost"})", R"({"index":1,"point":"ok"})"};
  write(path, rows[0] + rows[1] + rows[2] + rows[3]);
  RowStore store(3);
  const std::size_t file = store.add_file(path);
  store.put(0, file, 0, rows[0]);
  store.put(1, file, rows[0].size(), rows[1]);
  store.put(1, file, rows[0].size(), R"({"index":1,"point":"ok")");  // torn
  store.put(2, file, 0, rows[0]);                                    // of another point
  store.put(7, file, 0, R"({"index":7,"point":"ok"})");
  store.put(0, file, rows[0].size() + rows[1].size(), rows[2]);
  EXPECT_EQ(store.count(), 2u);
  EXPECT_EQ(store.count_lost(), 1u);
  EXPECT_EQ(store.row(0), rows[0]);
  store.drop_lost();
  EXPECT_FALSE(store.has(1));
  store.put(1, file, rows[0].size() + rows[1].size() + rows[2].size(), rows[3]);
  EXPECT_EQ(store.row(1), rows[3]);
  EXPECT_EQ(store.count_unanswered(), 0u);
  // The file grows, as a journal does.
  const std::string more = R"({"index":2,"point":"bad"})";
  const std::size_t end = content(path).size();
  write(path, content(path) + more);
  store.put(2, file, end, more);
  EXPECT_EQ(store.row(2), more);
  EXPECT_EQ(store.count_unanswered(), 1u);
}

TEST(Journal, IsInUseWhileItIsOpen) {
  const std::string path = ::testing::TempDir() + "accdec_journal_in_use";
  fs::remove(path);
  EXPECT_FALSE(journal_in_use(path));
  {
    Journal journal(path, "s");
    EXPECT_TRUE(journal_in_use(path));
  }
  EXPECT_FALSE(journal_in_use(path));
}

TEST_F(StudyCommand, AMergeNamesTheShardsThatLackPoints) {
  study(5);
  for (const char* shard : {"1/3", "3/3"})
    ASSERT_EQ(run(fmt::format("study study.toml --out parts --shard {}", shard)).exit_code, 0);
  EXPECT_THAT(run("study study.toml --out parts --merge parts").output,
              HasSubstr("7 of 20 points are missing from the shards"));
  EXPECT_THAT(run("study study.toml --out parts --merge parts").output,
              HasSubstr("Missing: shard 2/3 (0 of 7 points)"));
  const Study read = read_study((home_ / "study.toml").string());
  const auto states = study_shards(read, (home_ / "parts").string(), 3);
  ASSERT_EQ(states.size(), 3u);
  EXPECT_TRUE(states[0].complete() && states[2].complete());
  EXPECT_FALSE(states[1].complete());
  EXPECT_EQ(states[0].points + states[1].points + states[2].points, 20u);
  EXPECT_EQ(states[0].done, states[0].points);
  EXPECT_EQ(stranded_shards(states, {}), std::vector<std::size_t>{2});
  EXPECT_TRUE(stranded_shards(states, {{"17", 2, "PD", "0:00", "", "Resources"}}).empty());
}

TEST_F(StudyCommand, FrozenInputsAreTheSameStudyWhateverBecomesOfTheOriginals) {
  fs::create_directories(home_ / "a");
  fs::create_directories(home_ / "b");
  fs::copy(home_ / "task.toml", home_ / "a/task.toml");
  std::string other = content(home_ / "task.toml");
  write(home_ / "b/task.toml", other.replace(other.find("8000"), 4, "7000.1"));
  // Two files of one name, one of them by an absolute path, and one of the study's own name.
  fs::copy(home_ / "task.toml", home_ / "b/study.toml");
  write(home_ / "study.toml",
        fmt::format("compute = [\"given\"]\n[[case]]\nname = \"a\"\ntask = \"a/task.toml\"\n[[case]]\nname = \"b\"\n"
                    "task = \"{}\"\n[[case]]\nname = \"c\"\ntask = \"b/study.toml\"\n[[vary]]\nkey = "
                    "\"corner.A.angle_deg\"\nvalues = [0.1, 1e-3, 90]\n",
                    (home_ / "b/task.toml").string()));
  const std::string hash = read_study((home_ / "study.toml").string()).hash();
  const std::string frozen = freeze_inputs((home_ / "study.toml").string(), (home_ / "out/slurm/inputs").string());
  for (const char* original : {"a", "b", "study.toml", "task.toml"}) fs::remove_all(home_ / original);
  EXPECT_EQ(read_study(frozen).hash(), hash);
  EXPECT_EQ(std::distance(fs::directory_iterator(home_ / "out/slurm/inputs"), fs::directory_iterator()), 4);
}

TEST_F(StudyCommand, WithoutSlurmTheScriptsSayHowToDoWithout) {
  study(5);
  // A PATH without sbatch.
  const Outcome r = run("study study.toml --out out --slurm 3", "PATH=/nowhere");
  EXPECT_EQ(r.exit_code, 2) << r.output;
  EXPECT_THAT(r.output, HasSubstr("sbatch is not installed"));
  EXPECT_THAT(content(home_ / "out/slurm/array.sh"), HasSubstr("--resume-failed --sshloginfile nodes.txt"));
  const Outcome first = run("study --status out", "PATH=/nowhere");
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_THAT(first.output, HasSubstr("0 of 20 points are done"));
  // The scripts do by themselves what Slurm would have them do.
  for (const int shard : {1, 2, 3})
    ASSERT_EQ(std::system(fmt::format("bash '{}/out/slurm/array.sh' {} >/dev/null", home_.string(), shard).c_str()), 0);
  ASSERT_EQ(std::system(fmt::format("bash '{}/out/slurm/merge.sh' >/dev/null", home_.string()).c_str()), 0);
  ASSERT_EQ(run("study study.toml --out whole").exit_code, 0);
  EXPECT_EQ(content(home_ / "out/rows.csv"), content(home_ / "whole/rows.csv"));
  const Outcome done = run("study --status out");
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_THAT(done.output, HasSubstr("20 of 20 points are done"));
  EXPECT_THAT(run("study study.toml --out out --slurm 4").output, HasSubstr("go on with --slurm 3"));
  EXPECT_THAT(run("study study.toml --out out --slurm 3").output, HasSubstr("is complete"));
  EXPECT_THAT(run("study --status whole").output, HasSubstr("nothing was submitted from here"));
}

/// A Slurm that takes every job, runs none, and notes what it was told.
TEST_F(StudyCommand, ARepeatedSubmissionHasTheArgumentsOfTheFirst) {
  study(5);
  fs::create_directories(home_ / "bin");
  for (const char* tool : {"sbatch", "squeue", "scancel"}) {
    write(home_ / "bin" / tool,
          fmt::format("#!/bin/sh\n[ {} = sbatch ] || exit 0\necho \"$@\" >> {}/told\necho 7\n", tool, home_.string()));
    fs::permissions(home_ / "bin" / tool, fs::perms::owner_all);
  }
  const auto submit = [&](const std::string& more) {
    fs::remove(home_ / "told");
    const Outcome r =
        run("study study.toml --out out --slurm 3" + more, fmt::format("PATH={}/bin:$PATH", home_.string()));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    return r.output + content(home_ / "told");
  };
  const std::string first = "--parsable --array=1-3 --time=10 --qos=a b /";
  EXPECT_THAT(submit(" --sbatch-arg --time=10 --sbatch-arg '--qos=a b'"), HasSubstr(first));
  const std::string again = submit("");
  EXPECT_THAT(again, HasSubstr(first));
  EXPECT_THAT(again, HasSubstr("With the arguments for sbatch of before: --time=10 --qos=a b"));
  EXPECT_THAT(content(home_ / "out/slurm/array.sh"), HasSubstr("sbatch --array=1-3 '--time=10' '--qos=a b' '/"));
  EXPECT_THAT(submit(" --sbatch-arg --time=20"), HasSubstr("--parsable --array=1-3 --time=20 /"));
  EXPECT_THAT(submit(""), HasSubstr("--parsable --dependency=afterany:7 --time=20 /"));
}

// Text that ends a comment of the script would be run on the nodes; an array said again would win over ours.
TEST_F(StudyCommand, ArgumentsThatTheScriptsCannotHoldAreRefused) {
  study(5);
  for (const char* more : {"--sbatch-arg \"$(printf 'a\\nb')\"", "--sbatch-arg=--array=1-99", "--sbatch-arg=-d=3"}) {
    const Outcome r = run(std::string("study study.toml --out out --slurm 3 ") + more);
    EXPECT_EQ(r.exit_code, 2) << r.output;
    EXPECT_THAT(r.output, HasSubstr("--sbatch-arg")) << r.output;
    EXPECT_FALSE(fs::exists(home_ / "out/slurm")) << "nothing is half written";
  }
  EXPECT_EQ(run("study study.toml --out 'out\"x' --slurm 3").exit_code, 2);
}

}  // namespace
}  // namespace accdec::study
