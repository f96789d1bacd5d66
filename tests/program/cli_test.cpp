#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

struct Output {
  int code;
  std::string out, err;
};

class ProgramCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("accdec_program_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    write("task.toml",
          "sample_period_ms = 1.0\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 10\n"
          "[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
          "[program]\nerror_max_um = 20\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  std::string read(const std::string& name) {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  Output run(const std::string& arguments) {
    const std::string line = "cd " + folder_.string() + " && " ACCDEC_BINARY " " + arguments + " > out 2> err";
    const int status = std::system(line.c_str());
    return {WEXITSTATUS(status), read("out"), read("err")};
  }
  fs::path folder_;
};

TEST_F(ProgramCommand, PlansEveryGeneratedProgramAndHoldsEveryBound) {
  for (const char* kind : {"pocket", "zigzag", "trochoid", "engraving", "raster", "star"}) {
    ASSERT_EQ(run(std::string("generate ") + kind + " --blocks 300 --out part.ngc").code, 0);
    const Output done = run("program part.ngc --task task.toml --json r.json --delays d.csv --samples s.csv --emit e.ngc --figure f.svg");
    EXPECT_EQ(done.code, 0) << kind << done.out << done.err;
    EXPECT_EQ(done.err, "");
    EXPECT_THAT(read("r.json"), HasSubstr("\"schema\": \"accdec.program/1\""));
    EXPECT_THAT(read("r.json"), HasSubstr("\"feasible\": true"));
    std::istringstream delays(read("d.csv"));
    std::string line;
    std::getline(delays, line);
    EXPECT_EQ(line, "line,delay_samples,corner_error_m,error_max_m");
    while (std::getline(delays, line)) {
      double number[4] = {0, 0, 0, 1e9};
      std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", number, number + 1, number + 2, number + 3);
      EXPECT_LE(number[2], number[3] * (1.0 + 1e-8)) << kind << ": " << line;
    }
    EXPECT_THAT(read("s.csv"), testing::StartsWith("time_s,x_mm,x_mm_s,"));
    EXPECT_THAT(read("e.ngc"), HasSubstr("G21 G17 G90 G94"));
    EXPECT_THAT(read("f.svg"), HasSubstr("corner error / tolerance, %"));
  }
}

TEST_F(ProgramCommand, RefusesBadInputWithItsPlaceAndWritesNothing) {
  write("bad.ngc", "G1 F600 X10\nG64 P0.01\nX\n");
  Output done = run("program bad.ngc --task task.toml --json r.json --emit e.ngc");
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, testing::StartsWith("bad.ngc:3:1: "));
  EXPECT_EQ(done.out, "");
  EXPECT_FALSE(fs::exists(folder_ / "r.json"));
  EXPECT_FALSE(fs::exists(folder_ / "e.ngc"));
  write("fast.ngc", "G1 F60000 X10\n");
  done = run("program fast.ngc --task task.toml");
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, testing::StartsWith("fast.ngc:1:11: the feed moves axis X at 1000 mm/s"));
  EXPECT_EQ(run("program missing.ngc --task task.toml").code, 2);
  EXPECT_EQ(run("program bad.ngc").code, 2);
  done = run("program bad.ngc --task task.toml --figure f.bmp");
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("f.bmp: unknown extension"));
}

TEST_F(ProgramCommand, FailsWhenALimitBreaksWhateverTheDelays) {
  write("part.ngc", "G1 F18000 X100\nX200 Y50\n");
  const Output done = run("program part.ngc --task task.toml");
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.out, HasSubstr("NOT verified: a limit is broken: jerk"));
}

TEST_F(ProgramCommand, DesignsAFilterWhereTheTaskHasNone) {
  write("open.toml",
        "sample_period_ms = 1.0\n[design]\norder_max = 40\n[[axis]]\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\n"
        "jerk_max_mm_s3 = 500000\n");
  ASSERT_EQ(run("generate zigzag --blocks 100 --feed 6000 --out part.ngc").code, 0);
  const Output designed = run("program part.ngc --task open.toml --json r.json --time-limit 5");
  EXPECT_EQ(designed.code, 0) << designed.out << designed.err;
  const Output given = run("program part.ngc --task task.toml --json g.json");
  EXPECT_EQ(given.code, 0);
  const auto time = [&](const std::string& name) {
    const std::string text = read(name), key = "\"cycle_time_s\": ";
    return std::stod(text.substr(text.find(key) + key.size()));
  };
  EXPECT_LT(time("r.json"), time("g.json"));
}

TEST_F(ProgramCommand, PerLegIsNoLongerAndSaysItsFilters) {
  ASSERT_EQ(run("generate zigzag --blocks 60 --out part.ngc").code, 0);
  ASSERT_EQ(run("program part.ngc --task task.toml --json one.json").code, 0);
  const Output done = run("program part.ngc --task task.toml --per-leg --json legs.json --emit e.ngc");
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  const auto number = [&](const std::string& name, std::string key) {
    const std::string text = read(name);
    key = "\"" + key + "\": ";
    return std::stod(text.substr(text.find(key) + key.size()));
  };
  EXPECT_LT(number("legs.json", "cycle_time_s"), number("one.json", "cycle_time_s"));
  EXPECT_EQ(number("legs.json", "cycle_time_one_filter_s"), number("one.json", "cycle_time_s"));
  EXPECT_THAT(read("legs.json"), HasSubstr("\"leg_filters\": ["));
  EXPECT_THAT(read("e.ngc"), HasSubstr("(filter of "));
}

TEST_F(ProgramCommand, SameInputSameBytes) {
  ASSERT_EQ(run("generate pocket --blocks 300 --out part.ngc").code, 0);
  run("program part.ngc --task task.toml --delays a.csv --samples sa.csv --emit ea.ngc");
  run("program part.ngc --task task.toml --delays b.csv --samples sb.csv --emit eb.ngc");
  EXPECT_EQ(read("a.csv"), read("b.csv"));
  EXPECT_EQ(read("sa.csv"), read("sb.csv"));
  EXPECT_EQ(read("ea.ngc"), read("eb.ngc"));
}

}  // namespace
