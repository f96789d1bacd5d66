#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "support/command_fixture.hpp"

// `accdec modes` with the files that printers' firmware writes, with encoders' logs, and with broken ones.

namespace accdec {
namespace {

using ::testing::HasSubstr;

class ModesCommand : public testing::CommandInFolder {
 protected:
  /// exp(-z w t) cos(w_d t) after a jolt every second.
  static double ringing(double t, double frequency, double damping) {
    const double w = 2.0 * std::numbers::pi * frequency, since = t - std::floor(t);
    return std::exp(-damping * w * since) * std::cos(w * std::sqrt(1.0 - damping * damping) * since);
  }
  void write_log(const std::string& header, double scale) const {
    std::ofstream file(home_ / "log.csv");
    file << header << "\n";
    for (int k = 0; k < 16'000; ++k) {
      const double t = k / 1600.0;
      file << fmt::format("{:.6f},{:.6f},{:.6f}\n", 20.0 + t, scale * ringing(t, 41.0, 0.05),
                          scale * ringing(t, 63.0, 0.03));
    }
  }
  testing::Outcome refused(const std::string& log) {
    testing::write(home_ / "bad.csv", log);
    return run("modes bad.csv");
  }
};

TEST_F(ModesCommand, TablesOfAPrintersLogArePartOfATask) {
  write_log("#time,accel_x,accel_y", 9000.0);
  ASSERT_EQ(run("modes log.csv --out modes.toml --figure modes.svg").exit_code, 0);
  const std::string found = testing::content(home_ / "modes.toml");
  EXPECT_THAT(found, HasSubstr("# axis x: 41 Hz, damping 0.05"));
  EXPECT_THAT(found, HasSubstr("# axis y: 63 Hz, damping 0.03"));
  EXPECT_THAT(found, HasSubstr("jolts; the stretches between them were fitted"));
  EXPECT_THAT(testing::content(home_ / "modes.svg"), HasSubstr("vibration of axis x"));
  const std::string task =
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 8000\n[[corner]]\nangle_deg = 90\n"
      "feed_in_mm_min = 6000\nerror_max_um = 100\n";
  testing::write(home_ / "plain.toml", task);
  testing::write(home_ / "task.toml", task + found);
  EXPECT_EQ(run("design task.toml --no-baselines --quiet").exit_code, 0);
  const testing::Outcome costs = run("modes log.csv --task plain.toml --quiet");
  EXPECT_EQ(costs.exit_code, 0) << costs.output;
  for (const char* bound : {"0.2", "0.1", "0.05", "0.02"})
    EXPECT_THAT(costs.output, HasSubstr(fmt::format("# residual_max = {} costs ", bound)));
}

// A task for programs has no corner whose time could be compared.
TEST_F(ModesCommand, ATaskOfProgramsIsTakenWithoutCosts) {
  write_log("#time,accel_x,accel_y", 9000.0);
  testing::write(home_ / "program.toml",
                 "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 8000\n[program]\nerror_max_um = 100\n");
  const testing::Outcome found = run("modes log.csv --task program.toml --quiet");
  EXPECT_EQ(found.exit_code, 0) << found.output;
  EXPECT_THAT(found.output, HasSubstr("# axis x: 41 Hz"));
  EXPECT_THAT(found.output, HasSubstr("# program.toml has no [[corner]]"));
}

// Positions of an encoder, in um and ms.
TEST_F(ModesCommand, PositionsAreDifferencedTwice) {
  std::ofstream file(home_ / "log.csv");
  file << "t_ms x_um\n";
  for (int k = 0; k < 10'000; ++k) file << k << " " << 1000.0 + 50.0 * ringing(1e-3 * k, 41.0, 0.05) << "\n";
  file.close();
  const testing::Outcome outcome = run("modes log.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("# axis x: 41"));
}

TEST_F(ModesCommand, BrokenLogsAreRefusedWithTheirPlace) {
  EXPECT_THAT(refused("").output, HasSubstr("bad.csv:1:1: has no header; allowed are one time"));
  EXPECT_THAT(refused("# t\n").output, HasSubstr("bad.csv:1:1: has no header"));
  EXPECT_THAT(refused("t,ax\n").output, HasSubstr("bad.csv:1:1: has fewer than three samples"));
  EXPECT_THAT(refused("t,speed\n0,1\n").output, HasSubstr("bad.csv:1:3: column `speed`"));
  EXPECT_THAT(refused("t,ax,ax\n").output, HasSubstr("bad.csv:1:6: column `ax` stands twice"));
  EXPECT_THAT(refused("ax,ay\n0,1\n").output, HasSubstr("bad.csv:1:1: the header has no time"));
  EXPECT_THAT(refused("t,ax\n0,1\n0.1,x\n").output, HasSubstr("bad.csv:3:5: `x` is no number"));
  EXPECT_THAT(refused("t,ax\n0,1\n0.1\n").output, HasSubstr("bad.csv:3:1: the row has 1 values"));
  EXPECT_THAT(refused("t,ax\n0,1\n0,1\n").output, HasSubstr("bad.csv:3:1: the time 0 s is not after"));
  EXPECT_THAT(refused("t,ax\n0,1\n1,1\n9,1\n").output, HasSubstr("bad.csv:4:1: this sample comes 8000 ms after"));
  EXPECT_THAT(refused("t_ms,ax\n0,1\n1,2\n2,1\n").output, HasSubstr("the log lasts 0.003 s up to line 4"));
}

}  // namespace
}  // namespace accdec
