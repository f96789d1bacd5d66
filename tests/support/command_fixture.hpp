#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"

namespace accdec::testing {

inline std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

struct Outcome {
  int exit_code;
  std::string output;  ///< standard output and error
};

/// The program as a user runs it, in a folder of its own, so that it can be killed.
class CommandInFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    home_ = std::filesystem::path(::testing::TempDir()) /
            fmt::format("accdec_{}_{}", ::getpid(), ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(home_);
    std::filesystem::create_directories(home_);
  }
  void TearDown() override { std::filesystem::remove_all(home_); }

  /// @param before  shell commands in front of it
  pid_t start(const std::string& arguments, const std::string& before = ":") {
    const pid_t child = ::fork();
    if (child == 0) {
      const int log = ::open((home_ / "log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
      ::dup2(log, 1);
      ::dup2(log, 2);
      const std::string command = fmt::format("cd '{}' && {} && exec '{}' {}", home_.string(), before,
                                              accdec::test_support::program(), arguments);
      ::execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    return child;
  }
  Outcome run(const std::string& arguments, const std::string& before = ":") {
    int status = 0;
    ::waitpid(start(arguments, before), &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(home_ / "log")};
  }

  std::filesystem::path home_;
};

}  // namespace accdec::testing
