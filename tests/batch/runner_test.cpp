#include <csignal>
#include <map>
#include <numeric>
#include <stdexcept>

#include <unistd.h>

#include <gmock/gmock.h>

#include <accdec/batch/runner.hpp>

namespace accdec::batch {
namespace {

using ::testing::HasSubstr;

std::vector<std::size_t> first(std::size_t n) {
  std::vector<std::size_t> indices(n);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

std::map<std::size_t, std::string> run(std::size_t n, const std::function<std::string(std::size_t)>& compute,
                                       RunOptions options) {
  std::map<std::size_t, std::string> rows;
  run_points(
      first(n), compute, [](std::size_t i, const std::string& why) { return std::to_string(i) + " lost: " + why; },
      [&](std::size_t i, const Entry& entry) { EXPECT_TRUE(rows.emplace(i, entry.row).second); }, options);
  return rows;
}

TEST(Runner, EveryPointOnceWhateverTheWorkers) {
  const auto square = [](std::size_t i) { return std::to_string(i * i); };
  const auto expected = run(200, square, {1, Isolation::threads, 0});
  EXPECT_EQ(expected.size(), 200u);
  EXPECT_EQ(expected.at(14), "196");
  for (const Isolation isolation : {Isolation::threads, Isolation::processes}) {
    for (const int workers : {1, 2, 5}) EXPECT_EQ(run(200, square, {workers, isolation, 0}), expected);
  }
  EXPECT_TRUE(run(0, square, {2, Isolation::threads, 0}).empty());
  EXPECT_TRUE(run(0, square, {2, Isolation::processes, 0}).empty());
}

TEST(Runner, ACrashCostsItsPointOnly) {
  const auto rows = run(20,
                        [](std::size_t i) {
                          if (i == 3 || i == 11 || i == 19) ::raise(SIGKILL);
                          if (i == 5) throw std::runtime_error("no such corner");
                          if (i == 7) ::_exit(3);
                          return "row " + std::to_string(i);
                        },
                        {2, Isolation::processes, 0});
  ASSERT_EQ(rows.size(), 20u);
  EXPECT_THAT(rows.at(3), HasSubstr("signal 9"));
  EXPECT_THAT(rows.at(19), HasSubstr("signal 9"));
  EXPECT_THAT(rows.at(5), HasSubstr("no such corner"));
  EXPECT_THAT(rows.at(7), HasSubstr("ended early"));
  for (const std::size_t i : {0, 4, 6, 12, 18}) EXPECT_EQ(rows.at(i), "row " + std::to_string(i));
}

TEST(Runner, AHangingPointIsGivenUp) {
  const auto rows = run(4,
                        [](std::size_t i) {
                          if (i == 1) ::pause();
                          return "row " + std::to_string(i);
                        },
                        {2, Isolation::processes, 0.3});
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_THAT(rows.at(1), HasSubstr("given up after 0.3 s"));
  EXPECT_EQ(rows.at(3), "row 3");
}

TEST(Runner, AnyPointMayHaveATimeOfItsOwn) {
  RunOptions options{2, Isolation::processes, 0.2};
  options.kill_after_of = [](std::size_t i) { return i == 1 ? 60.0 : 0.2; };
  const auto rows = run(
      3,
      [](std::size_t i) -> std::string {
        if (i < 2) ::usleep(1'000'000);
        return "row " + std::to_string(i);
      },
      options);
  EXPECT_THAT(rows.at(0), HasSubstr("given up after 0.2 s"));
  EXPECT_EQ(rows.at(1), "row 1");
  EXPECT_EQ(rows.at(2), "row 2");
}

TEST(Runner, FreshChildrenServeOnePointEach) {
  RunOptions options{2, Isolation::processes, 0.0};
  options.fresh_children = true;
  const auto rows = run(
      9,
      [](std::size_t i) -> std::string {
        static int served = 0;
        if (i == 4) ::raise(SIGKILL);
        return std::to_string(++served);
      },
      options);
  EXPECT_THAT(rows.at(4), HasSubstr("signal 9"));
  for (const std::size_t i : {0, 1, 2, 3, 5, 6, 7, 8}) EXPECT_EQ(rows.at(i), "1");
}

TEST(Runner, LongRowsPassThePipeWhole) {
  const auto rows = run(6, [](std::size_t i) { return std::string(2'000'000 + i, 'x'); }, {2, Isolation::processes, 0});
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(rows.at(i).size(), 2'000'000 + i);
}

}  // namespace
}  // namespace accdec::batch
