#pragma once

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <sys/wait.h>

#include <fmt/format.h>

#include "support/command_fixture.hpp"

namespace accdec::testing {

class StudyCommand : public CommandInFolder {
 protected:
  void SetUp() override {
    CommandInFolder::SetUp();
    write(home_ / "task.toml", R"(sample_period_ms = 1.0
[filter]
kind = "hann"
order = 40
[[axis]]
acceleration_max_mm_s2 = 8000
jerk_max_mm_s3 = 800000
[[corner]]
name = "A"
angle_deg = 90
feed_in_mm_min = 6000
error_max_um = 50
)");
  }

  std::ptrdiff_t journal_lines(const std::string& folder) const {
    const std::string journal = content(home_ / folder / "study.journal");
    return std::count(journal.begin(), journal.end(), '\n');
  }

  /// Kills the run once its journal has grown by so many lines. Whether there was still a run to kill.
  bool killed_after(const std::string& arguments, const std::string& folder, std::ptrdiff_t lines) {
    const auto before = journal_lines(folder);
    const pid_t child = start(arguments);
    int status = 0;
    while (journal_lines(folder) < before + lines) {
      if (::waitpid(child, &status, WNOHANG) != 0) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }

  /// Writes study.toml: 4 x `count` points of everything cheap.
  void study(int count, const std::string& more = "") {
    write(home_ / "study.toml", fmt::format(R"(task = "task.toml"
compute = ["delays", "boxcar", "trapezoid"]
{}
[[vary]]
name = "angle"
key = "corner.A.angle_deg"
values = [30, 60, 90, 270]
[[vary]]
key = "corner.*.error_max_um"
range = {{ from = 1, to = 300, count = {}, log = true }}
[[figure]]
name = "times"
x = "corner.*.error_max_um"
y = ["delays.cycle_time_ms", "boxcar.cycle_time_ms"]
where = {{ angle = 60 }}
)",
                                            more, count));
  }

  void expect_same_results(const std::string& a, const std::string& b) {
    for (const char* name : {"rows.csv", "rows.jsonl", "report.html", "times.svg", "times.png"}) {
      ASSERT_TRUE(std::filesystem::exists(home_ / a / name)) << a << "/" << name;
      EXPECT_EQ(content(home_ / a / name), content(home_ / b / name)) << name;
    }
  }
};

}  // namespace accdec::testing
