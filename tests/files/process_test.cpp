#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/files/process.hpp>

namespace accdec {
namespace {

TEST(Process, IsKilledAtTheDeadline) {
  const ProcessOutput done = run_process({"sleep", "100"}, "", "coreutils", Deadline(0.1));
  EXPECT_TRUE(done.killed);
  EXPECT_EQ(done.exit_code, 128 + 9);
}

TEST(Process, IsKilledWhenItWritesTooMuch) {
  constexpr std::size_t most = 100'000;
  const ProcessOutput done = run_process({"yes"}, "", "coreutils", {}, most);
  EXPECT_TRUE(done.killed);
  EXPECT_GT(done.output.size(), most);
}

TEST(Process, MayTakeItsTime) {
  const ProcessOutput done = run_process({"cat"}, "text", "coreutils", Deadline(100.0), 4);
  EXPECT_FALSE(done.killed);
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.output, "text");
}

}  // namespace
}  // namespace accdec
