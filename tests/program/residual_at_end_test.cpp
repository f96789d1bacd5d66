#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_command.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ResidualAtTheEnd : public test::ProgramCommand {};

/// Between two corners the motion goes on evenly: each corner alone holds its bound, both together ring more.
/// An oscillator is integrated along the written samples, as a second method.
TEST_F(ResidualAtTheEnd, ResultsSayWhatAllMovesTogetherLeave) {
  const double f = 13.028612884450773, damping = 0.003;
  write("path.toml",
        "sample_period_ms = 1\n[program]\nerror_max_um = 50\n[filter]\nkind = \"averages\"\nlengths = [24, 8]\n"
        "[[axis]]\nname = \"x\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
        "[[axis]]\nname = \"y\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
        "[[mode]]\naxis = \"x\"\nfrequency_Hz = 13.028612884450773\ndamping_ratio = 0.003\nresidual_max_um = 58\n");
  write("part.ngc",
        "G21 G90 G64 P0.05\nF6000\nG1 X-0.565 Y-1.055\nG1 X3.887 Y-5.558\nG1 X13.839 Y5.258\nG1 X31.971 Y-1.277\n"
        "G1 X31.440 Y-1.525\nG1 X39.053 Y18.608\nM2\n");
  ASSERT_EQ(run("program part.ngc --task path.toml --json r.json --samples s.csv").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("above the bound, which judges starts, corners and stops alone"));
  EXPECT_THAT(read("out"), Not(HasSubstr("all bounds hold\n")));
  const auto result = nlohmann::json::parse(read("r.json"));
  const auto at = std::ranges::find_if(result["limits"], [](const auto& limit) { return limit["kind"] == "residual"; });
  ASSERT_NE(at, result["limits"].end());
  EXPECT_LT((*at)["value"].get<double>(), 58e-6);
  // y'' = -2 z w y' - w^2 y behind every change of velocity, in 200 steps a sample by the midpoint rule.
  std::istringstream rows(read("s.csv"));
  std::string row;
  std::getline(rows, row);
  const double w = 2.0 * M_PI * f, h = 1e-3 / 200;
  double y = 0.0, u = 0.0, before = 0.0, x = 0.0, last = 0.0;
  for (bool first = true; std::getline(rows, row); first = false) {
    std::sscanf(row.c_str(), "%*f,%lf", &x);
    const double velocity = first ? 0.0 : (x - last) / 1.0;  // mm/ms is m/s
    for (int i = 0; i < 200; ++i) {
      const double ym = y + 0.5 * h * u, um = u - 0.5 * h * (2.0 * damping * w * u + w * w * y);
      y += h * um, u -= h * (2.0 * damping * w * um + w * w * ym);
    }
    u += velocity - before, before = velocity, last = x;
  }
  const double damped = w * std::sqrt(1.0 - damping * damping);
  const double left = std::hypot(y, (u + damping * w * y) / damped);
  EXPECT_GT(left, 70e-6);
  EXPECT_NEAR((*at)["left_at_end"].get<double>(), left, 1e-4 * left);
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  EXPECT_THAT(read("out"), HasSubstr("residual of x after the program's end, all moves together"));
}

}  // namespace
}  // namespace accdec
