#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

/// `accdec program --plan profiles` as people run it.
class ProfilesCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("accdec_profiles_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("task.toml", task_);
    write("program.ngc", "G64 P0.05 F6000\nG1 X30\nG1 Y30\nG3 X10 Y30 I-10\nG1 X0 Y0\nM2\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string read(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  int run(const std::string& arguments) {
    const std::string line = "cd " + folder_.string() + " && " + accdec::test_support::program() +
                             " program program.ngc --task task.toml " + arguments + " > out 2> err";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  const std::string task_ =
      "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n";
  fs::path folder_;
};

TEST_F(ProfilesCommand, WritesTheSameMotionAsATableAndAsAStream) {
  ASSERT_EQ(run("--plan profiles --samples s.csv --stream s.txt --json r.json"), 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("verified: every sample"));
  EXPECT_THAT(read("r.json"), HasSubstr("\"corner_bound_s\""));
  std::ifstream table(folder_ / "s.csv"), stream(folder_ / "s.txt");
  std::string header, line;
  std::getline(table, header);
  EXPECT_EQ(header, "time_s,x_mm,x_mm_s,y_mm,y_mm_s");
  std::size_t rows = 0;
  double last_x = 0.0, last_y = 0.0;
  for (double x = 0.0, y = 0.0; std::getline(table, line); ++rows) {
    std::vector<std::string> cells;
    std::stringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 5U);
    ASSERT_TRUE(stream >> x >> y);
    EXPECT_EQ(std::stod(cells[1]), x);
    EXPECT_EQ(std::stod(cells[3]), y);
    last_x = x;
    last_y = y;
  }
  EXPECT_FALSE(stream >> last_x);
  EXPECT_EQ(last_y, 0.0);
  EXPECT_GT(rows, 1000U);
  EXPECT_THAT(read("r.json"), HasSubstr("\"samples\": " + std::to_string(rows)));
}

TEST_F(ProfilesCommand, RefusesWhatBelongsToOneFilter) {
  for (const char* option : {"--emit x.ngc", "--delays x.csv", "--figure x.svg"}) {
    EXPECT_EQ(run(std::string("--plan profiles ") + option), 2) << option;
    EXPECT_THAT(read("err"), HasSubstr("needs --plan fixed or per-leg"));
  }
  EXPECT_EQ(run("--stream x.txt"), 2);
  EXPECT_THAT(read("err"), HasSubstr("--stream needs --plan profiles"));
}

TEST_F(ProfilesCommand, RefusesVibrationBounds) {
  write("task.toml", task_ + "[[mode]]\nfrequency_Hz = 50\nresidual_max = 0.1\n");
  EXPECT_EQ(run("--plan profiles"), 2);
  EXPECT_THAT(read("err"), HasSubstr("plan profiles cannot hold vibration bounds"));
}

}  // namespace
