#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/process.hpp"

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
    const std::string command =
        fmt::format("cd '{}' && {} && exec '{}' {}", home_.string(), before, test_support::program(), arguments);
    return test_support::start_shell(command, home_ / "log", home_ / "log");
  }
  Outcome run(const std::string& arguments, const std::string& before = ":") {
    const int code = test_support::wait_for(start(arguments, before));
    return {code, content(home_ / "log")};
  }

  std::filesystem::path home_;
};

}  // namespace accdec::testing
