#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

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

// A folder of the paper's results or of a table of optima, told by its manifest, is written again; any other is left as
// it is.
TEST(PaperCommand, AndOptimaLeaveFoldersAloneThatAreNotTheirs) {
  const fs::path folder = fs::temp_directory_path() / ("accdec-folders-" + std::to_string(::getpid()));
  const std::string task = accdec::test_support::source_folder() + "/problems/corner/acceleration-jerk.toml";
  const auto write = [&](const std::string& command, const std::string& name, const std::string& text) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(folder / name) << text;
    std::vector<std::string> words{accdec::test_support::program(), command};
    if (command == "optima") words.push_back(task);
    words.insert(words.end(), {"--out", folder.string()});
    const ProcessOutput run = run_process(words, "", "accdec");
    if (run.exit_code == 2) {
      EXPECT_EQ(content(folder / name), text);
      EXPECT_EQ(names(folder), std::set<std::string>{name}) << run.errors;
    }
    return run.exit_code;
  };
  const auto manifest_of = [](const std::string& results) {
    return content(fs::path(accdec::test_support::source_folder()) / "results" / results / "manifest.json");
  };
  EXPECT_EQ(write("optima", "optima.csv", "mine"), 2);
  EXPECT_EQ(write("paper", "table1.csv", "mine"), 2);
  EXPECT_EQ(write("optima", "manifest.json", manifest_of("paper")), 2);
  EXPECT_EQ(write("paper", "manifest.json", manifest_of("optima")), 2);
  EXPECT_EQ(write("optima", "manifest.json", "{}"), 2);
  EXPECT_EQ(write("optima", "manifest.json", manifest_of("optima")), 0);
  EXPECT_EQ(write("paper", "manifest.json", manifest_of("paper")), 0);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace accdec
