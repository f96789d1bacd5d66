#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/run.hpp"

// The program alone, without the modules that connect the solver libraries.

namespace accdec {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class WithoutModules : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::copy_file(test_support::program(), folder_.path("accdec")); }
  Outcome run_copy(const std::string& arguments) const {
    const std::string command = "exec " + quoted(folder_.path("accdec")) + " " + arguments;
    const int code =
        test_support::wait_for(test_support::start_shell(command, folder_.path("out"), folder_.path("err")));
    return {code, folder_.read("out"), folder_.read("err")};
  }
  const std::string task_ = quoted(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
  TemporaryFolder folder_;
};

TEST_F(WithoutModules, ProofsNeedNone) {
  const Outcome outcome = run_copy("design " + task_);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(run_copy("--version").code, 0);
}

TEST_F(WithoutModules, AMissingOneIsNamedWithItsSolver) {
  const Outcome outcome = run_copy("design --method nlp --solver nlopt-slsqp " + task_);
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("nlopt-slsqp"), HasSubstr("accdec-nlopt.so")));
  EXPECT_THAT(run_copy("design --method nlp --solver nonsense " + task_).err, HasSubstr("unknown solver"));
}

TEST_F(WithoutModules, SolversSaysWhichAreMissing) {
  const Outcome outcome = run_copy("solvers");
  for (const char* module : {"ipopt", "nlopt", "ceres", "clp"})
    EXPECT_THAT(outcome.out, HasSubstr("cannot load accdec-" + std::string(module) + ".so"));
}

}  // namespace
}  // namespace accdec
