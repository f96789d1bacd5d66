#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>

#include <accdec/files/limited_process.hpp>

#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(LimitedProcess, LargeFilesAreCutOff) {
  const TemporaryFolder folder;
  ProcessLimits limits;
  limits.seconds = 20.0;
  limits.most_file_bytes = 100'000;
  const LimitedOutput output =
      run_limited({"dd", "if=/dev/zero", "of=large", "bs=1000", "count=1000000"}, folder.path(""), limits);
  EXPECT_LE(std::filesystem::file_size(folder.path("large")), 100'000u);
  EXPECT_THAT(output.stopped, HasSubstr("wrote a file of more than 100000 bytes"));
}

/// Whether a program with these words still runs.
bool runs(const std::string& words) {
  return std::system(("cat /proc/[0-9]*/cmdline 2> /dev/null | tr '\\0' ' ' | grep -q '" + words + "'").c_str()) == 0;
}

// The program's parent is its guard. Without it, or if it stands still, what the program started ends as well.
TEST(LimitedProcess, KillingItsParentLeavesNothingRunning) {
  const std::string mark = "6543" + std::to_string(::getpid());
  for (const char* signal : {"KILL", "STOP"}) {
    const LimitedOutput output = run_limited(
        {"sh", "-c", "setsid -f sleep " + mark + "; kill -" + signal + " $PPID; sleep " + mark}, ".", {.seconds = 1.0});
    EXPECT_TRUE(output.exit_code != 0 || !output.stopped.empty()) << signal;
    EXPECT_FALSE(runs("slee[p] " + mark)) << signal;
  }
}

// A process that runs a program and dies, as a comparison does that is ended by Ctrl-C.
TEST(LimitedProcess, NothingOutlivesTheCaller) {
  const TemporaryFolder folder;
  const std::string mark = "5432" + std::to_string(::getpid());
  const fs::path scratch = folder.path("scratch");
  fs::create_directory(scratch);
  const pid_t caller = ::fork();
  if (caller == 0) {
    ProcessLimits limits;
    limits.folder_goes = true;
    run_limited({"sh", "-c", "setsid sleep " + mark + " & setsid -f sleep " + mark + "; sleep " + mark},
                scratch.string(), limits);
    ::_exit(0);
  }
  const auto wait_until = [](const auto& holds) {
    for (int tries = 0; tries < 200 && !holds(); ++tries) ::usleep(50'000);
    return holds();
  };
  EXPECT_TRUE(wait_until([&] { return runs("slee[p] " + mark); }));
  ::kill(caller, SIGKILL);
  ::waitpid(caller, nullptr, 0);
  EXPECT_TRUE(wait_until([&] { return !runs("slee[p] " + mark) && !fs::exists(scratch); }));
}

}  // namespace
}  // namespace accdec
