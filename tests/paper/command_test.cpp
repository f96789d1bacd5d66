#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

#include <accdec/files/process.hpp>

#include "support/paths.hpp"

namespace accdec {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> names(const fs::path& folder) {
  std::set<std::string> all;
  for (const auto& entry : fs::directory_iterator(folder)) all.insert(entry.path().filename().string());
  return all;
}

TEST(PaperCommand, GivesTheCommittedFilesByteForByte) {
  const fs::path fresh = fs::temp_directory_path() / ("accdec-paper-" + std::to_string(::getpid()));
  const fs::path committed = fs::path(accdec::test_support::source_folder()) / "results/paper";
  const ProcessOutput run =
      run_process({accdec::test_support::program(), "paper", "--out", fresh.string()}, "", "accdec");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_EQ(run.errors, "");
  EXPECT_EQ(names(fresh), names(committed));
  for (const std::string& name : names(fresh)) {
    if (name == "manifest.json") continue;  // names the command and the versions, which may differ
    EXPECT_TRUE(content(fresh / name) == content(committed / name))
        << name << " differs; run accdec paper and look why";
  }
  fs::remove_all(fresh);
}

TEST(PaperCommand, WritesNothingWhereItCannot) {
  const ProcessOutput run =
      run_process({accdec::test_support::program(), "paper", "--out", "/dev/null/here"}, "", "accdec");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.errors.find("/dev/null/here"), std::string::npos) << run.errors;
}

}  // namespace
}  // namespace accdec
