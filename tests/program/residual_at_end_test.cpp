#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/plan/report/left_at_rest.hpp>

#include "program_command.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double damping = 0.003;

std::string task(double frequency, int bound_um) {
  return "sample_period_ms = 1\n[program]\nerror_max_um = 50\n[filter]\nkind = \"averages\"\nlengths = [24, 8]\n"
         "[[axis]]\nname = \"x\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
         "[[axis]]\nname = \"y\"\nvelocity_max_mm_s = 500\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
         "[[mode]]\naxis = \"x\"\nfrequency_Hz = " +
         std::to_string(frequency) + "\ndamping_ratio = 0.003\nresidual_max_um = " + std::to_string(bound_um) + "\n";
}

struct Left {
  double at_end = 0.0, at_stop = 0.0;  // m
};

/// y'' = -2 z w y' - w^2 y behind every change of velocity, in 200 steps a sample by the midpoint rule.
/// @param stop  mm, a point that the path reaches only to stop there
Left integrated(const std::string& samples, double frequency, std::array<double, 2> stop) {
  const double w = 2.0 * M_PI * frequency, h = 1e-3 / 200, damped = w * std::sqrt(1.0 - damping * damping);
  std::istringstream rows(samples);
  std::string row;
  std::getline(rows, row);
  Left left;
  double y = 0.0, u = 0.0, before = 0.0, last[2] = {0.0, 0.0};
  for (bool first = true; std::getline(rows, row); first = false) {
    double at[2] = {0.0, 0.0};
    std::sscanf(row.c_str(), "%*f,%lf,%*f,%lf", &at[0], &at[1]);
    if (first) std::copy_n(at, 2, last);
    const double velocity = at[0] - last[0];  // mm/ms is m/s
    const bool rests = std::hypot(at[0] - stop[0], at[1] - stop[1]) < 1e-9;
    std::copy_n(at, 2, last);
    for (int i = 0; i < 200; ++i) {
      const double ym = y + 0.5 * h * u, um = u - 0.5 * h * (2.0 * damping * w * u + w * w * y);
      y += h * um, u -= h * (2.0 * damping * w * um + w * w * ym);
    }
    u += velocity - before, before = velocity;
    left.at_end = std::hypot(y, (u + damping * w * y) / damped);
    if (!rests) continue;
    // The velocity of this sample falls away with the next one.
    const std::complex<double> step = std::exp(1e-3 * std::complex<double>(-damping * w, damped));
    left.at_stop = std::abs(std::complex<double>((u + damping * w * y) / damped, y) - velocity / (damped * step));
  }
  return left;
}

class ResidualAtTheEnd : public test::ProgramCommand {
 protected:
  /// The use of the mode's bound in the JSON result of a program.
  nlohmann::json residual(const std::string& program, double frequency, int bound_um) {
    write("path.toml", task(frequency, bound_um));
    write("part.ngc", program);
    EXPECT_EQ(run("program part.ngc --task path.toml --json r.json --samples s.csv").code, 0) << read("err");
    EXPECT_THAT(read("out"), HasSubstr("all bounds hold\n"));
    const auto result = nlohmann::json::parse(read("r.json"));
    for (const auto& limit : result["limits"])
      if (limit["kind"] == "residual") return limit;
    return {};
  }
  /// The same, whose residual at the end is that of an oscillator along the written samples.
  /// @param rounding  of the positions in the file
  std::pair<nlohmann::json, Left> held(const std::string& program, double frequency, int bound_um,
                                       std::array<double, 2> stop, double rounding) {
    const nlohmann::json limit = residual(program, frequency, bound_um);
    const Left left = integrated(read("s.csv"), frequency, stop);
    EXPECT_NEAR(limit["left_at_end"].get<double>(), left.at_end, rounding * left.at_end);
    return {limit, left};
  }
};

/// Between two corners the motion goes on evenly: each corner alone holds its bound, and both together rang with 72 um.
/// An oscillator is integrated along the written samples, as a second method.
TEST_F(ResidualAtTheEnd, AllMovesTogetherKeepTheBound) {
  const auto [limit, left] = held(
      "G21 G90 G64 P0.05\nF6000\nG1 X-0.565 Y-1.055\nG1 X3.887 Y-5.558\nG1 X13.839 Y5.258\nG1 X31.971 Y-1.277\n"
      "G1 X31.440 Y-1.525\nG1 X39.053 Y18.608\nM2\n",
      13.028613, 58, {1e3, 1e3}, 1e-4);
  EXPECT_LT(left.at_end, 58e-6);
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  EXPECT_THAT(read("out"), HasSubstr("all bounds hold"));
  EXPECT_THAT(read("out"), HasSubstr("residual of x after the program's end, all moves together"));
}

/// A corner before an exact stop rings on: that counts at the stop, and at the end.
TEST_F(ResidualAtTheEnd, StopsBeforeTheEndAreJudgedToo) {
  const auto [limit, left] = held(
      "G21 G90 G64 P0.05\nF6000\nG1 X-2.604 Y-3.212\nG1 X-4.023 Y-1.816\nG61.1\nG1 X-4.000 Y-1.459\n"
      "G64 P0.05\nG1 X3 Y1\nG1 X6 Y7\nM2\n",
      36.720977, 19, {-4.0, -1.459}, 1e-3);
  EXPECT_LT(left.at_stop, 19e-6 * (1.0 + 1e-4));
  EXPECT_LT(left.at_end, 19e-6 * (1.0 + 1e-4));
  EXPECT_NEAR(limit["left_at_stop"].get<double>(), left.at_stop, 1e-2 * left.at_stop);
}

TEST(BoundsThatHold, NotAllIfAModeIsLeftWithMore) {
  EXPECT_EQ(bounds_that_hold({{}, {}}), "all bounds hold");
  EXPECT_THAT(bounds_that_hold({{}, {.above_bound = true}}), Not(HasSubstr("all bounds hold")));
}

}  // namespace
}  // namespace accdec
