#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/plan/along/path_speed.hpp>
#include <accdec/plan/run/along_plan.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

constexpr double T = 1e-3, acceleration = 1.0, feed = 0.1;
constexpr double pi = std::numbers::pi;

Task arc_task(double jerk) {
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(acceleration, jerk, 0.5, 3);
  // Given, so that no search ends by the clock.
  FilterSpec filter;
  filter.kind = Shape::boxcar;
  filter.order = 5;
  task.filter = filter;
  return task;
}

ProgramResult arc_plan(const std::string& program, const Task& task, bool free, bool compensate) {
  const TemporaryFolder folder;
  const std::string name = folder.write("part.ngc", program);
  ProgramFileOptions options;
  options.fixed.compensate_arcs = compensate;
  ProgramFile file = read_program_file(name, task, options, {});
  options.plan = free ? PlanKind::free : PlanKind::profiles;
  options.free.sweeps = 1;
  return run_program_file(file, task, options, {});
}

void expect_verified(const ProgramResult& result, const Task& task) {
  EXPECT_TRUE(result.verification.feasible) << result.message;
  EXPECT_THAT(verify_program_result(result, task).reasons, testing::IsEmpty());
}

/// From rest to rest along a length: jerk j, acceleration at most a, speed at most v.
class SCurve {
 public:
  SCurve(double length, double v, double a, double j) : length_(length), a_(a), j_(j) {
    double low = 0.0, high = v;
    for (int i = 0; i < 60; ++i) {
      v_ = i == 0 ? v : 0.5 * (low + high);
      (v_ * ramp() <= length ? low : high) = v_;
      if (i == 0 && low == v) break;
    }
    v_ = low;
    if (v_ < a_ * a_ / j_) a_ = std::sqrt(v_ * j_);
  }
  double time() const { return ramp() + length_ / v_; }
  double at(double t) const {
    t = std::clamp(t, 0.0, time());
    if (t > 0.5 * time()) return length_ - at(time() - t);
    const double whole = ramp();
    if (t > whole) return 0.5 * v_ * whole + v_ * (t - whole);
    if (t > 0.5 * whole) return 0.5 * v_ * whole - v_ * (whole - t) + early(whole - t);
    return early(t);
  }

 private:
  double ramp() const { return v_ >= a_ * a_ / j_ ? v_ / a_ + a_ / j_ : 2.0 * std::sqrt(v_ / j_); }
  double early(double t) const {
    const double rise = a_ / j_;
    if (t <= rise) return j_ * t * t * t / 6.0;
    const double since = t - rise;
    return j_ * rise * rise * rise / 6.0 + 0.5 * a_ * rise * since + 0.5 * a_ * since * since;
  }
  double length_, a_, j_, v_ = 0.0;
};

/// A helix of a radius and a pitch; a circle at pitch 0.
struct Helix {
  double radius, pitch, turns;
  double length() const { return turns * std::hypot(2.0 * pi * radius, pitch); }
  /// Whether samples along it by an S-curve hold every axis' limits.
  bool holds(const SCurve& curve, double jerk) const {
    double before[3] = {radius, 0.0, 0.0}, velocity[3] = {}, change[3] = {};
    const double count = std::ceil(curve.time() / T) + 3.0;
    for (double k = 1.0; k <= count; ++k) {
      const double share = curve.at(k * T) / length(), angle = 2.0 * pi * turns * share;
      const double now[3] = {radius * std::cos(angle), radius * std::sin(angle), pitch * turns * share};
      for (int a = 0; a < 3; ++a) {
        const double v = (now[a] - before[a]) / T, b = (v - velocity[a]) / T;
        if (std::abs(b) > acceleration || std::abs(b - change[a]) / T > jerk) return false;
        before[a] = now[a];
        velocity[a] = v;
        change[a] = b;
      }
    }
    return true;
  }
  /// The fastest S-curve with constant bounds along the path, by trying parts of feed, acceleration and jerk.
  double fastest_s_curve(double jerk) const {
    double best = unlimited;
    const double top = std::min(feed, std::sqrt(acceleration * radius));
    for (const double v : {1.0, 0.93, 0.8, 0.65, 0.5}) {
      for (const double a : {1.0, 0.7, 0.4, 0.2}) {
        for (const double j : {0.99, 0.6, 0.3}) {
          const SCurve curve(length(), v * top, a * acceleration, j * jerk);
          if (curve.time() < best && holds(curve, jerk)) best = curve.time();
        }
      }
    }
    return best;
  }
  std::string program() const {
    return fmt::format("G21 G90 G61 F{:.0f}\nG3 X0 Y0 I{:.6f} Z{:.6f} P{:.0f}\nM2\n", 6e4 * feed, -1e3 * radius,
                       1e3 * pitch * turns, turns);
  }
};

class RoundRuns : public ::testing::TestWithParam<Helix> {};

// Speed and acceleration along the path change with its direction, so no S-curve of constant bounds is as fast.
TEST_P(RoundRuns, AreFasterThanSCurvesAlongThePath) {
  const Helix& helix = GetParam();
  for (const double jerk : {50.0, 20.0, 200.0}) {
    if (helix.length() > 0.1 && jerk != 50.0) continue;
    const Task task = arc_task(jerk);
    const ProgramResult result = arc_plan(helix.program(), task, false, false);
    expect_verified(result, task);
    const double reference = helix.fastest_s_curve(jerk);
    ASSERT_LT(reference, unlimited);
    // The barrier ends 2e-4 of the time above the optimum.
    EXPECT_LE(result.cycle_time, (1.0 + 2e-4) * reference + 2.0 * T) << helix.program() << jerk;
    EXPECT_GE(result.cycle_time, 0.999 * helix.length() / feed);
  }
}

INSTANTIATE_TEST_SUITE_P(All, RoundRuns,
                         ::testing::Values(Helix{0.5e-3, 0.0, 1.0}, Helix{1e-3, 0.0, 3.0}, Helix{2e-3, 0.0, 1.0},
                                           Helix{5e-3, 0.0, 1.0}, Helix{10e-3, 0.0, 2.0}, Helix{20e-3, 0.0, 1.0},
                                           Helix{50e-3, 0.0, 1.0}, Helix{500e-3, 0.0, 1.0}, Helix{10e-3, 2e-3, 3.0},
                                           Helix{3e-3, 5e-3, 2.0}));

// 1.355 s is the optimum on the circle without a jerk limit.
void expect_two_short_turns(bool free) {
  const Helix two{10e-3, 0.0, 2.0};
  const Task task = arc_task(50.0);
  for (const bool compensate : {false, true}) {
    const ProgramResult result = arc_plan(two.program(), task, free, compensate);
    expect_verified(result, task);
    EXPECT_LE(result.cycle_time, 1.5);
    EXPECT_GE(result.cycle_time, 1.355);
    EXPECT_EQ(result.compensation.empty(), !(free && compensate));
    double farthest = 0.0;
    Motion motion(result.plan, T);
    for (Sample sample; motion.next(sample);)
      farthest = std::max(farthest, std::abs(std::hypot(sample.position[0] + 10e-3, sample.position[1]) - 10e-3));
    EXPECT_LE(farthest, 2e-6);
  }
}

TEST(AlongArcs, TwoTurnsTakeLittleLongerThanWithoutAJerkLimit) {
  expect_two_short_turns(false);
}
TEST(FreeAlongArcs, TwoTurnsTakeLittleLongerThanWithoutAJerkLimit) {
  expect_two_short_turns(true);
}

// Without stops every piece would begin and end at rest.
const std::array meeting_lines = {
    "G21 G90 G64 P0.02 F6000\nG1 X30\nG61.1\nG3 X30 Y20 J10\nG4 P0.05\nG1 X0\nG3 X0 Y0 J-10\nG64 P0.02\nG2 X5 Y5 "
    "R5\nM2\n",
    "G21 G90 G61 F6000\nG1 X30\nG3 X30 Y20 J10\nG1 X0\nG3 X0 Y0 J-10\nM2\n"};

TEST(AlongArcs, MeetingLinesAndStopsHold) {
  const Task task = arc_task(50.0);
  for (const char* const program : meeting_lines) expect_verified(arc_plan(program, task, false, false), task);
}

TEST(FreeAlongArcs, MeetingLinesAndStopsHold) {
  const Task task = arc_task(50.0);
  for (const char* const program : meeting_lines) {
    const ProgramResult fastest = arc_plan(program, task, false, false), free = arc_plan(program, task, true, false);
    expect_verified(free, task);
    EXPECT_LE(free.cycle_time, fastest.cycle_time + 1e-9) << program;
  }
}

// A motion that stops exactly at a corner is one for every tolerance of it. The closed form is the S-curve of the
// lines, and along the circle one with seven tenths of both limits: the turn takes the rest.
TEST(AlongArcs, SharpCornersOfLinesAndArcsTakeNoLongerThanExactStops) {
  const Task task = arc_task(50.0);
  const std::string moves = "G21 G90 G0 X0 Y0\nG1 X10 F6000\nG3 X10 Y0 I-10 J0\nG1 X0\nM2\n";
  const double line = SCurve(0.01, feed, acceleration, 50.0).time();
  for (const bool free : {false, true}) {
    const ProgramResult exact = arc_plan("G61\n" + moves, task, free, false);
    const ProgramResult looser = arc_plan("G64 P0.002\n" + moves, task, free, false);
    for (const ProgramResult* result : {&exact, &looser}) expect_verified(*result, task);
    // At each corner two samples of rest lie between motions of two kinds.
    EXPECT_LE(looser.cycle_time, exact.cycle_time + 4.0 * T) << free;
    EXPECT_LE(looser.cycle_time, 2.0 * line + 1.05 * SCurve(0.02 * pi, feed, 0.7 * acceleration, 35.0).time()) << free;
  }
}

// The jerk limit sees both circles where they meet. Two samples of rest between them are always enough.
// The sample at rest that ends a program is counted once.
TEST(MeetingCircles, TakeTheTimesOfBothAndTwoSamples) {
  for (const double jerk : {unlimited, 50.0}) {
    const Task task = arc_task(jerk);
    const auto time = [&](const std::string& moves) {
      const Toolpath path = test::path_of("G21 G90 G61.1 F6000\n" + moves + "M2\n", task.machine);
      const auto along = plan_along(plan_profiles_of({"circles", path, task, Feeds::choose, {}}), task, {});
      return along ? along->result.cycle_time : unlimited;  // the check of all samples refused it
    };
    const double one = time("G2 X0 Y0 I10\n"), two = time("G2 X0 Y0 I10\nG2 X0 Y0 I10\n");
    EXPECT_LE(two, 2.0 * one + 2.0 * T + 1e-9) << jerk;
    EXPECT_GE(two, 2.0 * one - T - 1e-9) << jerk;
  }
}

// The time ends where plan fixed begins: nothing that other plans have found is left out.
TEST(FreeWithoutTime, KeepsMotionsAlongArcs) {
  const Task task = arc_task(50.0);
  ProgramFile file;
  file.path = test::path_of("G21 G90 G64 P0.01 F6000\nG1 X20\nG2 X40 Y0 I10\nG1 X60\nM2\n", task.machine);
  const ProgramResult profiles = plan_profiles_of({file.name, file.path, task, Feeds::choose, {}});
  const auto along = plan_along(profiles, task, {});
  ASSERT_TRUE(along);
  ASSERT_LT(along->result.cycle_time, profiles.cycle_time - 2.0 * T);
  std::atomic<bool> over = false;
  ProgramFileOptions options;
  options.deadline.end_when(over);
  options.free.progress = [&over](const FreeProgress& progress) { over = over || progress.stage == "plan fixed"; };
  const ProgramResult free = run_free_plan(file, task, options, {});
  ASSERT_TRUE(over);
  expect_verified(free, task);
  EXPECT_LE(free.cycle_time, along->result.cycle_time + 1e-9);
}

// A cubic of Bezier is within 2.8e-4 of its radius from a quarter of a circle. At both ends it bends 2.2 % less, by
// 2 (1 - k)/(3 k^2 R) with k = 0.5522847.
TEST(SplinesAlong, TakeTheTimeOfTheArcThatTheyAreNear) {
  for (const double jerk : {unlimited, 50.0}) {
    const Task task = arc_task(jerk);
    const auto time = [&](const std::string& move) {
      const Toolpath path = test::path_of("G21 G90 G61.1 F6000\nG1 X20 Y0\n" + move + "G1 X30 Y40\nM2\n", task.machine);
      const ProgramResult profiles = plan_profiles_of({"curve", path, task, Feeds::choose, {}});
      const auto along = plan_along(profiles, task, {});
      EXPECT_TRUE(along) << move;
      if (!along) return profiles.cycle_time;
      expect_verified(along->result, task);
      return along->result.cycle_time;
    };
    const double arc = time("G3 X30 Y10 J10\n");
    EXPECT_NEAR(time("G5 X30 Y10 I5.522847 J0 P0 Q-5.522847\n"), arc, 0.022 * arc) << jerk;
  }
}

// Rest is rest: it is neither planned nor checked sample by sample.
TEST(AlongArcs, ProgramsOfLongRestsAreAnsweredAtOnce) {
  const Task task = arc_task(unlimited);
  const std::string program = "G21 G90 G64 P0.05 F3000\nG1 X20\nG4 P1000000\nG1 X40\nG3 X40 Y0 I5\nM2\n";
  for (const bool free : {false, true}) {
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result = arc_plan(program, task, free, false);
    EXPECT_TRUE(result.verification.feasible) << result.message;
    if (result.plan.trajectory() != nullptr) expect_verified(result, task);
    EXPECT_GE(result.cycle_time, 1e6);
    EXPECT_LE(seconds_since(start), 20.0);
  }
}

// A line along one axis: acceleration and jerk of the closed form.
TEST(PathSpeed, OfALineIsTheSCurve) {
  for (const double length : {0.002, 0.02, 0.1}) {
    PathSpeed speed;
    speed.axes = 1;
    speed.acceleration_max = {acceleration};
    speed.jerk_max = {50.0};
    const SCurve curve(length, feed, acceleration, 50.0);
    const int cells = 400;
    for (int i = 0; i <= cells; ++i) speed.node.push_back(i == cells ? length : curve.at(curve.time() * i / cells));
    speed.cap.assign(speed.node.size(), feed * feed);
    // As little as a constant jerk gives the first and the last cell.
    for (const auto& [node, way] : {std::pair{1, speed.node[1]}, std::pair{cells - 1, length - speed.node[cells - 1]}})
      speed.cap[static_cast<std::size_t>(node)] = 0.25 * std::pow(50.0, 2.0 / 3.0) * std::pow(6.0 * way, 4.0 / 3.0);
    speed.first.assign(static_cast<std::size_t>(cells), 1.0);
    speed.second.assign(static_cast<std::size_t>(cells), 0.0);
    // A tenth of the speed of the S-curve holds.
    std::vector<double> x(speed.node.size(), 0.0);
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
      const double step = curve.time() / cells, t = step * static_cast<double>(i);
      const double v = 0.1 * (curve.at(t + 0.5 * step) - curve.at(t - 0.5 * step)) / step;
      x[i] = v * v;
    }
    ASSERT_TRUE(speed.holds(x));
    const std::vector<double> slow = x;
    EXPECT_TRUE(speed.solve(x, 1.02 * curve.time(), [] { return false; }));
    EXPECT_TRUE(std::all_of(x.begin(), x.end(), [](double v) { return v < feed * feed; }));
    EXPECT_NEAR(speed.time(x), curve.time(), 0.01 * curve.time()) << length;
    // Asked for less than the S-curve takes, it soon ends.
    x = slow;
    EXPECT_FALSE(speed.solve(x, 0.8 * curve.time(), [] { return false; }));
    EXPECT_GT(speed.time(x), 1.01 * curve.time());
  }
}

}  // namespace
}  // namespace accdec
