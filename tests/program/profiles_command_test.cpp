#include <cmath>
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
  EXPECT_THAT(read("r.json"), HasSubstr("\"samples\": " + std::to_string(rows - 1)));
}

TEST_F(ProfilesCommand, RefusesWhatBelongsToOneFilter) {
  for (const char* option : {"--emit x.ngc", "--delays x.csv"}) {
    EXPECT_EQ(run(std::string("--plan profiles ") + option), 2) << option;
    EXPECT_THAT(read("err"), HasSubstr("needs --plan fixed"));
  }
  EXPECT_EQ(run("--stream x.txt"), 2);
  EXPECT_THAT(read("err"), HasSubstr("--stream needs --plan profiles"));
}

// People read both with the same eyes: the same counts in the same words, every value in its unit, in the same columns.
TEST_F(ProfilesCommand, AllPlansPrintTheSameColumnsAndCounts) {
  std::vector<std::vector<std::string>> columns, counts;
  // So long a filter that profiles are the faster plan, beside a limit of power that motions along arcs do not keep.
  const std::string filter = "jerk_max_mm_s3 = 500000\n[filter]\nkind = \"trapezoid\"\norder = 300\nramp = 40\n";
  for (const std::string plan : {"fixed", "profiles", "free"}) {
    write("task.toml", task_ + (plan == "profiles" ? "mass_kg = 1\npower_max_W = 1000\n" : "") + filter);
    ASSERT_EQ(run("--time-limit 1 --json r.json --plan " + plan), 0) << read("err");
    const std::string json = read("r.json"), text = read("out");
    ASSERT_THAT(json, HasSubstr("\"plan\": \"" + plan + "\"")) << "the program is to be planned each way";
    EXPECT_THAT(text, HasSubstr("plan " + plan + ", "));
    EXPECT_THAT(text, HasSubstr("ignored: vibration of the machine"));
    std::vector<std::string> heads;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("program.ngc: ")) counts.push_back({line.substr(0, line.find(" in "))});
      if (line.starts_with("  limit ") || line.starts_with("  worst corners ")) heads.push_back(line);
    }
    columns.push_back(heads);
    // 1000 mm/s^2 and the jerk in mm/s^3, as the task says them.
    EXPECT_THAT(text, testing::ContainsRegex("acceleration +x +[0-9.]+ +1000 mm/s\\^2"));
    EXPECT_THAT(text, testing::ContainsRegex("jerk +x +[0-9.]+ +500000 mm/s\\^3"));
    EXPECT_THAT(text, testing::ContainsRegex("planned and verified in [0-9.e-]+ s, at most [0-9]+ MB of memory"));
  }
  EXPECT_EQ(columns[0].size(), 2U);
  EXPECT_THAT(columns, testing::Each(columns[0]));
  // Four lines and an arc, however many chords each plan cuts that into.
  EXPECT_THAT(counts, testing::Each(testing::ElementsAre("program.ngc: 4 blocks")));
}

TEST_F(ProfilesCommand, PerLegSaysWhatReplacesIt) {
  for (const char* option : {"--plan per-leg", "--per-leg"}) {
    EXPECT_EQ(run(option), 2);
    EXPECT_THAT(read("err"), HasSubstr("leave out [filter] to have one designed"));
  }
}

// Its ramps choose the speed of every sample, so that there is no plan to give.
TEST_F(ProfilesCommand, KeepsNoFeeds) {
  EXPECT_EQ(run("--plan profiles --feeds keep --json r.json"), 2);
  EXPECT_THAT(read("err"), HasSubstr("only plan fixed keeps feeds"));
  EXPECT_FALSE(fs::exists(folder_ / "r.json"));
}

TEST_F(ProfilesCommand, HoldsVibrationBounds) {
  write("task.toml", task_ + "[[mode]]\nfrequency_Hz = 50\nresidual_max = 0.1\n");
  EXPECT_EQ(run("--plan profiles --time-limit 1"), 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("vibration"));
  write("task.toml", task_ + "[[mode]]\nfrequency_Hz = [1, 499]\nresidual_max = 1e-9\n");
  EXPECT_EQ(run("--plan profiles"), 2);
  EXPECT_THAT(read("err"), HasSubstr("finds no filter for the vibration bounds"));
}

/// The number after a key in JSON.
double value(const std::string& json, const std::string& key) {
  const std::size_t at = json.find("\"" + key + "\": ");
  return at == std::string::npos ? NAN : std::stod(json.substr(at + key.size() + 4));
}

TEST_F(ProfilesCommand, IsNeverSlowerThanTheOtherPlans) {
  // Short blocks under a jerk limit, where one filter may be faster than ramps that wait for the last boxcar.
  std::string zigzag = "G64 P0.02 F6000\n";
  for (int i = 1; i <= 60; ++i)
    zigzag += "G1 X" + std::to_string(0.8 * i) + " Y" + std::to_string(0.5 * (i % 3)) + "\n";
  write("program.ngc", zigzag + "M2\n");
  write("task.toml", task_ + "jerk_max_mm_s3 = 30000\n");
  double fastest = INFINITY;
  ASSERT_EQ(run("--time-limit 2 --json fixed.json --plan fixed"), 0) << read("err");
  fastest = std::min(fastest, value(read("fixed.json"), "cycle_time_s"));
  ASSERT_EQ(run("--time-limit 2 --json p.json --samples p.csv --plan profiles"), 0) << read("err");
  const std::string json = read("p.json");
  EXPECT_THAT(json, HasSubstr("\"candidates\""));
  // One part in a hundred for the search's clock, which may end it elsewhere on a busy machine.
  EXPECT_LE(value(json.substr(json.rfind("\"cycle_time_s\"")), "cycle_time_s"), 1.01 * fastest);
  EXPECT_THAT(read("p.csv"), HasSubstr("time_s,x_mm"));
  // The answer of another plan can be verified as one of its own.
  EXPECT_THAT(json, HasSubstr("\"commands\""));
}

TEST_F(ProfilesCommand, ExactStopsAreRestsAndNameTheLimitTheyBreak) {
  // The path goes there and back. With a delay of N, the last tap of one leg and the first of the next brake the same
  // axis together, with twice the acceleration. So an exact stop needs N + 1.
  write("program.ngc", "G64 P0.05 F6000\nG1 X30\nG1 X0\nM2\n");
  write("task.toml", task_ + "[filter]\nkind = \"boxcar\"\norder = 99\n");
  ASSERT_EQ(run("--json r.json --feeds keep"), 0) << read("err");
  const std::string json = read("r.json");
  EXPECT_THAT(json, HasSubstr("\"exact_stop_breaks\": null"));
  // 300 samples of each leg, N + 1 between and N + 1 at the end.
  EXPECT_NEAR(value(json, "cycle_time_exact_stop_s"), 0.8, 1.001e-3);
}

TEST_F(ProfilesCommand, PagesStandAlone) {
  for (const std::string plan : {"fixed", "profiles"}) {
    ASSERT_EQ(run("--time-limit 1 --figure page.html --plan " + plan), 0) << read("err");
    const std::string page = read("page.html");
    EXPECT_THAT(page, HasSubstr("<canvas id=\"path\""));
    EXPECT_THAT(page, HasSubstr("75 to 105 degrees"));
    EXPECT_THAT(page, testing::Not(HasSubstr("src=")));
  }
}

TEST_F(ProfilesCommand, FiguresOfEveryPlanSayWhatBindsAndWhereTimeIsLost) {
  for (const std::string plan : {"fixed", "profiles"}) {
    ASSERT_EQ(run("--time-limit 1 --figure figure.svg --plan " + plan), 0) << read("err");
    const std::string figure = read("figure.svg");
    EXPECT_THAT(figure, HasSubstr("tolerance or programmed feed"));
    EXPECT_THAT(figure, HasSubstr("75 to 105 degrees"));
  }
}

}  // namespace
