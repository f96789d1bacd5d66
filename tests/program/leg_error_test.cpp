#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Servos that differ bend straight legs: results say by how much, and in which line.

namespace accdec {
namespace {

using testing::HasSubstr;

constexpr double gains[] = {100.0, 160.0};  // 1/s

Task differing_task() {
  Task task;
  task.machine = test::machine_of(2.0, 200.0, 0.2, 2);
  for (std::size_t a = 0; a < 2; ++a) task.machine.axes[a].servo_gain = gains[a];
  return task;
}

/// By how much axes that follow v/Kv behind leave a line, m. @param v  m/s  @param turn  of the line, sine and cosine
double bend(double v, double sine, double cosine) {
  return v * sine * cosine * std::abs(1.0 / gains[0] - 1.0 / gains[1]);
}

/// Left of the leg before when a leg begins to count, m: a part of 1e-4 of its lag, and up to one sample's more.
const double tail = 1e-4 * std::exp(gains[0] * 1e-3) * 0.05 / gains[0];

ProgramResult planned(const std::string& program, const Task& task) {
  return run_program({"part.ngc", test::path_of(program, task.machine), task}, trapezoid(40, 10));
}

/// Legs of 25 and 50 mm last whole numbers of samples, so that their feeds are those of the program.
TEST(LegError, IsTheDifferenceOfTheLags) {
  const Task task = differing_task();
  const ProgramResult result = planned("G64 P0.5 F3000\nG1 X50\nX80 Y40\nX100 Y25 F1500\nX100 Y75\nM2\n", task);
  ASSERT_TRUE(result.verification.feasible) << result.message;
  ASSERT_TRUE(result.servo && result.servo->legs);
  EXPECT_EQ(result.servo->legs->line, 3U);
  EXPECT_NEAR(result.servo->legs->error, bend(0.05, 0.8, 0.6), tail);
}

/// A leg along one axis stays straight. Behind a corner it begins to count when 1e-4 of the leg before is left of it.
TEST(LegError, IsNoneAlongAnAxis) {
  const ProgramResult result = planned("G64 P0.5 F3000\nG1 X50\nY50\nM2\n", differing_task());
  ASSERT_TRUE(result.servo && result.servo->legs);
  EXPECT_LE(result.servo->legs->error, tail);
}

/// Legs that are shorter than the filter feel each other, and the last one counts once it is alone.
TEST(LegError, ServosThatAreAlikeOrShortLegsHaveNone) {
  Task task = differing_task();
  const std::string program = "G64 P0.5 F3000\nG1 X1 Y1\nX2 Y1\nX3 Y2\nM2\n";
  const ProgramResult differing = planned(program, task);
  ASSERT_TRUE(differing.servo && differing.servo->legs);
  EXPECT_LT(differing.servo->legs->error, bend(0.05, std::sqrt(0.5), std::sqrt(0.5)));
  task.machine.axes[1].servo_gain = gains[0];
  const ProgramResult alike = planned(program, task);
  ASSERT_TRUE(alike.servo);
  EXPECT_FALSE(alike.servo->legs);
}

class LegErrorCommand : public test::ProgramCommand {};

TEST_F(LegErrorCommand, IsInEveryOutput) {
  const std::string axis = "velocity_max_mm_s = 200\nacceleration_max_mm_s2 = 2000\njerk_max_mm_s3 = 200000\n";
  write("servo.toml", "sample_period_ms = 1\n[[axis]]\nname = \"x\"\nservo_gain_1_s = 100\n" + axis +
                          "[[axis]]\nname = \"y\"\nservo_gain_1_s = 160\n" + axis);
  write("part.ngc", "G21 G90 G64 P0.05 F3000\nG1 X0 Y0\nX50\nX80 Y40 (bends)\nX100 Y25 F1500\nY75\nM2\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --time-limit 5 --json r.json --figure p.html").code, 0)
      << read("err");
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  EXPECT_EQ(result["servo"]["leg_line"], 4);
  EXPECT_NEAR(result["servo"]["leg_error_m"].get<double>(), bend(0.05, 0.8, 0.6), tail);
  const std::string said = "the motion leaves straight legs by up to 90 um, in line 4";
  EXPECT_THAT(read("out"), HasSubstr(said));
  EXPECT_THAT(read("p.html"), HasSubstr(said));
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  const auto refused = [&](const char* member, const nlohmann::json& value) {
    auto forged = result;
    forged["servo"][member] = value;
    write("forged.json", forged.dump());
    EXPECT_EQ(run("verify forged.json").code, 1) << member;
    EXPECT_THAT(read("out") + read("err"), HasSubstr(std::string("servo.") + member)) << member;
  };
  refused("leg_error_m", 80e-6);
  refused("leg_line", 3);
}

}  // namespace
}  // namespace accdec
