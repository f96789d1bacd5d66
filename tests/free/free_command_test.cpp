#include <array>
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

/// `accdec program --plan free` as people run it.
class FreeCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("accdec_free_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("task.toml", "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 1000\n");
    write("program.ngc", "G64 P0.05 F6000\nG1 X30\nG1 Y30\nG3 X10 Y30 I-10\nG1 X0 Y0\nM2\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string read(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  int run(const std::string& arguments, const std::string& before = "") {
    const std::string line = "cd " + folder_.string() + " && " + before + " " + accdec::test_support::program() + " " +
                             arguments + " > out 2> err";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  fs::path folder_;
};

TEST_F(FreeCommand, WritesAResultThatVerifyAcceptsUntilItIsChanged) {
  ASSERT_EQ(run("program program.ngc --task task.toml --plan free --json r.json --samples s.csv --stream s.txt "
                "--figure f.html"),
            0)
      << read("err");
  EXPECT_THAT(read("out"), HasSubstr("plan free, "));
  EXPECT_THAT(read("out"), HasSubstr("verified: every sample"));
  EXPECT_EQ(run("verify r.json"), 0) << read("out");
  std::string text = read("r.json");
  const auto at = text.find("\"positions_m\":[") + 15;
  const auto middle = text.find(',', at + 2000);
  text.replace(middle, 1, ",9");  // tens of metres
  write("changed.json", text);
  EXPECT_NE(run("verify changed.json"), 0);
  const auto counts = text.find("\"samples_of_block\":[") + 20;
  text = read("r.json");
  text.insert(counts, "1");
  write("changed.json", text);
  EXPECT_NE(run("verify changed.json"), 0);
  EXPECT_THAT(read("out") + read("err"), HasSubstr("commands.trajectory"));
}

TEST_F(FreeCommand, KeepsTheBestMotionAfterAnInterruption) {
  // Plan free takes ten times as long as the plan that it begins with, on slow machines too.
  std::string program = "G64 P0.1 F6000\n";
  for (int i = 0; i < 1200; ++i) program += "G1 X" + std::to_string(i % 2 * 15) + " Y" + std::to_string(i % 7) + "\n";
  write("program.ngc", program + "M2\n");
  ASSERT_EQ(run("program program.ngc --task task.toml --plan free --threads 1 --json r.json",
                "timeout --preserve-status -s INT 4"),
            0)
      << read("err");
  EXPECT_THAT(read("err"), HasSubstr("Ctrl-C ended the search during: "));
  EXPECT_EQ(run("verify r.json"), 0) << read("out");
}

// Reading, profiles, bounds and windows are cut short.
TEST_F(FreeCommand, EndsInEveryPhaseWithAPlanOrWithoutFiles) {
  std::string program = "G64 P0.1 F6000\n";
  for (int i = 0; i < 2000; ++i) program += "G1 X" + std::to_string(i % 2 * 15) + " Y" + std::to_string(i % 7) + "\n";
  write("program.ngc", program + "M2\n");
  for (const char* seconds : {"0.02", "0.1", "0.4", "1.5"}) {
    const int code = run("program program.ngc --task task.toml --plan free --threads 1 --json r.json --samples s.csv",
                         std::string("timeout --preserve-status -s INT ") + seconds);
    std::vector<std::string> files;
    for (const auto& file : fs::directory_iterator(folder_)) files.push_back(file.path().filename());
    if (code == 0) {
      EXPECT_THAT(read("err"), HasSubstr("Ctrl-C ended the search during: ")) << seconds;
      EXPECT_THAT(files, testing::UnorderedElementsAre("task.toml", "program.ngc", "out", "err", "r.json", "s.csv"));
      EXPECT_EQ(run("verify r.json"), 0) << seconds << read("out");
    } else {
      EXPECT_THAT(files, testing::UnorderedElementsAre("task.toml", "program.ngc", "out", "err")) << seconds;
    }
    fs::remove(folder_ / "r.json"), fs::remove(folder_ / "s.csv");
  }
}

TEST_F(FreeCommand, ProvesItsBoundAndVerifyRefusesAChangedProof) {
  ASSERT_EQ(run("program program.ngc --task task.toml --plan free --json r.json"), 0) << read("err");
  ASSERT_EQ(run("verify r.json"), 0);
  EXPECT_THAT(read("out"), HasSubstr("bound accepted: multipliers prove that any motion takes "));
  const std::string good = read("r.json");
  const auto refused = [&](const std::string& after, const std::string& put, const std::string& reason) {
    std::string text = good;
    const auto proof = text.find("\"any_motion_proof\"");
    const auto at = text.find(after, proof) + after.size();
    write("changed.json", text.replace(at, 1, put));
    EXPECT_NE(run("verify changed.json"), 0) << after;
    EXPECT_THAT(read("out") + read("err"), HasSubstr(reason)) << after;
  };
  refused("{\"time_s\":", "9", "any_motion_proof.time_s is recorded as ");
  refused("\"first_block\":", "1", "any_motion_proof: the multipliers from block 1 on: ");
  refused("\"way\":[[", "9", "any_motion_proof.time_s is recorded as ");
  refused("\"shares\":[", "1", "shares are not from 0 to 1");
}

TEST_F(FreeCommand, SaysNothingOfCornersOfALegAlone) {
  write("leg.ngc", "F6000 G61.1\nG1 X30\nM2\n");
  for (const char* plan : {"free", "fixed"}) {
    ASSERT_EQ(run(std::string("program leg.ngc --task task.toml --plan ") + plan), 0) << read("err");
    EXPECT_THAT(read("out"), HasSubstr("no corner grants a tolerance"));
    EXPECT_THAT(read("out"), testing::Not(HasSubstr("line 0")));
    EXPECT_THAT(read("out"), testing::Not(HasSubstr("0 of 0")));
  }
}

TEST_F(FreeCommand, RefusesWhatBelongsToOneFilter) {
  for (const char* option : {"--emit x.ngc", "--delays x.csv", "--feeds keep"}) {
    EXPECT_EQ(run(std::string("program program.ngc --task task.toml --plan free ") + option), 2) << option;
    EXPECT_THAT(read("err"), HasSubstr("fixed"));
  }
}

TEST_F(FreeCommand, RefusesKeysWhereTheyStand) {
  const std::string axis = "[[axis]]\nvelocity_max_mm_s = 200\n", fast = axis + "acceleration_max_mm_s2 = 1000\n";
  const std::string drive = fast + "mass_kg = 10\nforce_max_N = 90\n";
  // The task, the line and column of the key, what it is, and what is allowed.
  const std::vector<std::array<std::string, 4>> all{
      {drive + "power_max_W = 20\n", "7:1", "keeps no limit of power: `power_max_W`", "use --plan profiles or fixed"},
      {drive + "regeneration_max_W = 9\n", "7:1", "keeps no limit of regeneration: `regeneration_max_W`",
       "use --plan profiles or fixed"},
      {fast + "[[mode]]\nfrequency_Hz = 30\n  residual_max = 0.1\n", "7:3",
       "keeps no vibration bound: `residual_max` of [[mode]]", "use --plan profiles or fixed"},
      {fast + "servo_gain_1_s = 100\n[program]\ncontour_max_um = 9\n", "5:1", "does not consider the servo of an axis",
       "use --plan fixed"},
      {fast + "[controller]\nprefilter_taps = [0.5, 0.5]\n", "6:1", "does not consider the control's prefilter_taps",
       "use --plan fixed"},
      {fast + "[design]\nfamily = [\"averages\"]\n", "6:1", "the task's control has one filter", "use --plan fixed"},
      {fast + "[controller]\nname = \"sinumerik-840d\"\n", "5:2", "the task's control has one filter",
       "use --plan fixed"},
      {axis, "2:3", "needs a limit of acceleration", "give one"}};
  for (const auto& [text, place, what, allowed] : all) {
    write("key.toml", "sample_period_ms = 1.0\n" + text);
    EXPECT_EQ(run("program program.ngc --task key.toml --plan free"), 2) << text;
    EXPECT_THAT(read("err"), HasSubstr("key.toml:" + place + ": plan free ")) << text;
    EXPECT_THAT(read("err"), HasSubstr(what)) << text;
    EXPECT_THAT(read("err"), HasSubstr(allowed)) << text;
  }
}

}  // namespace
