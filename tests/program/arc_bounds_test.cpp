#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program_command.hpp"

// Programs of arcs: no plan is faster than a bound that is printed with it, and its result is accepted.

namespace {

using accdec::test::ProgramCommand;
using testing::StartsWith;

class ArcBounds : public ProgramCommand {
 protected:
  /// Plans part.ngc with task.toml.
  void expect_true(const std::string& options) {
    ASSERT_EQ(run("program part.ngc --task task.toml --json r.json " + options).code, 0) << read("err");
    const nlohmann::json result = nlohmann::json::parse(read("r.json"));
    const double time = result["cycle_time_s"];
    const auto& bounds = result["bounds"];
    ASSERT_EQ(bounds.size(), 3U);
    for (const auto& bound : bounds) {
      // A free motion is no sum of legs.
      if (bound["name"] == "monotone legs" && result["plan"] == "free") continue;
      EXPECT_LE(bound["time_s"].get<double>(), time * (1.0 + 1e-12)) << bound["name"] << ", " << options;
    }
    EXPECT_THAT(run("verify r.json").out, StartsWith("accepted: ")) << options;
  }
};

std::string task_text(double period_ms, double velocity, double acceleration, double jerk) {
  return fmt::format(
             "sample_period_ms = {}\n[[axis]]\nvelocity_max_mm_s = {}\n"
             "acceleration_max_mm_s2 = {}\n",
             period_ms, velocity, acceleration) +
         (jerk > 0.0 ? fmt::format("jerk_max_mm_s3 = {}\n", jerk) : "");
}

// The plan runs along longer chords than the arcs were first read in.
TEST_F(ArcBounds, AreThoseOfTheChordsThatThePlanRunsAlong) {
  write("task.toml", task_text(1.0, 500.0, 6000.0, 500000.0));
  write("part.ngc", "G64 P0.05 F1000\nG3 I10 P20\n");
  expect_true("");
  write("task.toml", task_text(0.125, 500.0, 6000.0, 500000.0));
  write("part.ngc", "G61 F15\nG3 X0.05 Y0.05 J0.05\n");
  for (const char* plan : {"fixed", "profiles", "free --time-limit 1"}) expect_true(fmt::format("--plan {}", plan));
}

// Widened arcs are planned beside those that are not, once each.
TEST_F(ArcBounds, WidenedArcsPlanNoFeedsThatAreKept) {
  write("task.toml", task_text(0.5, 500.0, 1000.0, 50000.0));
  write("part.ngc", "G64 P0.02 F6000\nG1 X5\nG3 X5 Y20 J10\nG1 X0\n");  // widened arcs are faster
  expect_true("--compensate-arcs");
  EXPECT_THAT(read("r.json"), testing::Not(testing::HasSubstr("cycle_time_kept_feeds_s")));
}

// Its corners and starts are of blocks that are longer than the filter, which chords are not.
TEST_F(ArcBounds, OfFiltersCountNoChords) {
  write("task.toml", task_text(1.0, 200.0, 500.0, 0.0));
  write("part.ngc", "G91 G64 P0.05 F6000\nG2 X-0.76588 Y-0.4455 I-1.60309 J1.8749\nG3 I0.05 P2\n");
  expect_true("--filter-bound");
  EXPECT_LE(number_of("r.json", "filter_bound_s"), number_of("r.json", "cycle_time_s"));
}

class RandomArcs {
 public:
  explicit RandomArcs(unsigned seed) : random_(seed) {}

  std::string task() {
    const double acceleration = one_of<double>({500, 1000, 3000, 6000});
    const double jerk = one_of<double>({0, 20, 100}) * acceleration;
    return task_text(one_of<double>({0.5, 1, 2}), one_of<double>({100, 500}), acceleration, jerk);
  }
  std::string program() {
    std::string text = "G91 " + control() + fmt::format(" F{}\n", one_of<int>({1000, 3000, 6000, 20000}));
    const int moves = one_of<int>({1, 2, 3});
    for (int i = 0; i < moves; ++i) text += move();
    return text;
  }

 private:
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return *(values.begin() + std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random_));
  }
  double between(double low, double high) { return low + (high - low) * std::generate_canonical<double, 32>(random_); }

  std::string control() {
    return between(0.0, 1.0) < 0.35 ? "G61" : fmt::format("G64 P{}", one_of<double>({0.002, 0.01, 0.05, 0.5}));
  }
  std::string move() {
    const double radius = one_of<double>({0.05, 0.3, 1, 3}) * between(0.7, 1.4);
    const double heading = between(0.0, 1.0) < 0.4 ? 0.5 * std::numbers::pi * one_of<int>({0, 1, 2, 3})
                                                   : between(0.0, 2.0 * std::numbers::pi);
    const double i = radius * std::cos(heading), j = radius * std::sin(heading), kind = between(0.0, 1.0);
    std::string text = between(0.0, 1.0) < 0.2 ? control() + "\n" : "";
    const std::string rise = between(0.0, 1.0) < 0.3 ? fmt::format(" Z{:.3f}", between(-3.0, 3.0)) : "";
    if (kind < 0.2) return text + fmt::format("G1 X{:.4f} Y{:.4f}\n", 3.0 * j, 3.0 * i);
    const bool left = between(0.0, 1.0) < 0.5;
    text += left ? "G3" : "G2";
    if (kind < 0.5) return text + fmt::format(" I{:.4f} J{:.4f} P{}", i, j, one_of<int>({1, 2, 4})) + rise + "\n";
    const double turn = (left ? 1.0 : -1.0) * between(0.1, 6.0), c = std::cos(turn), s = std::sin(turn);
    return text + fmt::format(" X{:.5f} Y{:.5f} I{:.5f} J{:.5f}", i - i * c + j * s, j - i * s - j * c, i, j) + rise +
           "\n";
  }

  std::mt19937 random_;
};

TEST_F(ArcBounds, HoldForRandomArcs) {
  constexpr std::array plans{"fixed", "profiles", "fixed --compensate-arcs", "free", "profiles --compensate-arcs"};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomArcs random(seed);
    write("task.toml", random.task());
    write("part.ngc", random.program());
    SCOPED_TRACE(fmt::format("seed {}\n{}{}", seed, read("task.toml"), read("part.ngc")));
    expect_true(fmt::format("--time-limit 2 --plan {}", plans[seed % plans.size()]));
  }
}

}  // namespace
