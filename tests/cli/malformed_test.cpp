#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/malformed_loads.hpp"
#include "support/malformed_tasks.hpp"
#include "support/run.hpp"

namespace accdec {
namespace {

using ::testing::StartsWith;

class MalformedTask : public ::testing::TestWithParam<malformed::Case> {};

/// Every malformed task, through every command that takes one: exit code 2, the position first on standard error,
/// nothing written.
TEST_P(MalformedTask, IsRefusedWithNothingWritten) {
  const malformed::Case& bad = GetParam();
  for (const char* command : {"evaluate", "design"}) {
    SCOPED_TRACE(command);
    const TemporaryFolder folder;
    const std::string task = folder.write("task.toml", bad.text);
    const Outcome outcome = run({command, task, "--json", folder.path("result.json")});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, StartsWith(task + ":" + bad.position + ": "));
    EXPECT_EQ(folder.count(), 1U);
    EXPECT_EQ(folder.read("task.toml"), bad.text);
  }
}
INSTANTIATE_TEST_SUITE_P(Cli, MalformedTask, ::testing::ValuesIn(malformed::cases()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });
INSTANTIATE_TEST_SUITE_P(Loads, MalformedTask, ::testing::ValuesIn(malformed::load_cases()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

}  // namespace
}  // namespace accdec
