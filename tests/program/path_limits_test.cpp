#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Contours, modes of axes and axes with different servos in programs. Oscillators and loops are integrated in small
// steps, distances are those of dense points.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;

Task path_task() {
  Task task;
  task.machine = test::machine_of(3.0, 400.0, 0.5, 2);
  return task;
}

Toolpath read_path(const std::string& text, const Task& task) {
  LineSource source("part.ngc", text);
  ToolpathOptions reading;
  reading.contour_max = task.program_contour_max.value_or(unlimited);
  return read_toolpath(source, task.machine, reading);
}

std::vector<std::vector<double>> positions(const Plan& plan, double period, bool servo) {
  std::vector<std::vector<double>> at;
  Motion motion(plan, period, servo);
  for (Sample sample; motion.next(sample);) at.push_back({sample.position[0], sample.position[1]});
  return at;
}

const LimitUse* use_of_kind(const ProgramResult& result, LimitKind kind) {
  for (const LimitUse& use : result.check.limits) {
    if (use.kind == kind) return &use;
  }
  return nullptr;
}

/// Largest distance of points on the steps of a motion from the blocks of the program.
double farthest(const std::vector<std::vector<double>>& at, const Toolpath& path) {
  double most = 0.0;
  constexpr int parts = 16;
  for (std::size_t k = 1; k < at.size(); ++k) {
    for (int i = 1; i <= parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      const double x = at[k - 1][0] + t * (at[k][0] - at[k - 1][0]), y = at[k - 1][1] + t * (at[k][1] - at[k - 1][1]);
      most = std::max(most, test::from_blocks(path, x, y));
    }
  }
  return most;
}

/// Amplitude of a mass on a spring that rides on an axis, after the last of its velocities: fourth order, step T/50.
double left_swinging(const std::vector<double>& velocity, double period, double frequency, double damping) {
  const double w = 2.0 * std::numbers::pi * frequency, h = period / 50.0;
  double x = 0.0, u = 0.0, before = velocity.front();
  const auto push = [&](double s, double v) { return -w * w * s - 2.0 * damping * w * v; };
  for (std::size_t k = 1; k < velocity.size(); ++k) {
    u += velocity[k] - before;
    before = velocity[k];
    for (int i = 0; i < 50 && k + 1 < velocity.size(); ++i) {
      const double k1 = push(x, u), u2 = u + 0.5 * h * k1, k2 = push(x + 0.5 * h * u, u2), u3 = u + 0.5 * h * k2;
      const double k3 = push(x + 0.5 * h * u2, u3), u4 = u + h * k3, k4 = push(x + h * u3, u4);
      x += h / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4);
      u += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
  }
  const double damped = w * std::sqrt(1.0 - damping * damping);
  return std::hypot(x, (u + damping * w * x) / damped);
}

constexpr const char* turns = "G64 P0.05 F6000\nG1 X30\nG1 X60 Y10\nG1 X35 Y35\nG1 X70 Y45\nG1 X20\nM2\n";

/// The part of an axis' velocities around one corner, from even motion to even motion.
std::vector<double> around_corner(const std::vector<std::vector<double>>& at, const double* corner, std::size_t axis,
                                  double period, int reach) {
  std::size_t nearest = 0;
  const auto off = [&](std::size_t k) { return std::hypot(at[k][0] - corner[0], at[k][1] - corner[1]); };
  for (std::size_t k = 0; k < at.size(); ++k) nearest = off(k) < off(nearest) ? k : nearest;
  std::vector<double> velocity;
  const std::size_t last = std::min(at.size() - 1, nearest + static_cast<std::size_t>(reach));
  for (std::size_t k = nearest > static_cast<std::size_t>(reach) ? nearest - static_cast<std::size_t>(reach) : 1;
       k <= last; ++k)
    velocity.push_back((at[k][axis] - at[k - 1][axis]) / period);
  while (velocity.size() > 1 && std::abs(velocity.back() - velocity[velocity.size() - 2]) < 1e-9) velocity.pop_back();
  return velocity;
}

/// Every corner leaves the axis with no more than its bound, by integration; delays are longer for it, and no longer
/// than they must be.
TEST(ProgramPath, ModesOfAxesAreHeldBehindEveryCorner) {
  Task task = path_task();
  const Filter filter = trapezoid(60, 20);
  Mode mode{40.0, 40.0, 1.0};
  mode.damping_low = mode.damping_high = 0.02, mode.axis = 0;
  const auto plan = [&](double bound) {
    mode.displacement_max = bound;
    task.machine.modes = {mode};
    return run_program({"part", read_path(turns, task), task}, filter);
  };
  const ProgramResult loose = plan(1.0);
  const double found = use_of_kind(loose, LimitKind::residual)->value;
  for (const double part : {1.0, 0.8, 0.5}) {
    SCOPED_TRACE(part);
    const ProgramResult result = plan(part * found);
    ASSERT_TRUE(result.verification.feasible) << result.message;
    const auto at = positions(result.plan, task.sample_period, false);
    double most = 0.0;
    const Toolpath& path = result.plan.path;
    for (std::size_t b = 0; b < path.blocks(); ++b)
      most = std::max(most, left_swinging(around_corner(at, path.point(b + 1), 0, task.sample_period, 160),
                                          task.sample_period, 40.0, 0.02));
    EXPECT_NEAR(use_of_kind(result, LimitKind::residual)->value, most, 2e-3 * most);
    EXPECT_LE(most, part * found * (1.0 + 2e-3));
    EXPECT_GE(result.cycle_time, loose.cycle_time);
  }
}

/// Two corners 40 samples apart, in which a mode swings once: what the second leaves cancels what the first did. The
/// leg between counts all the same. It has no even motion, as the filter is longer, so the sums of both corners are
/// judged.
TEST(ProgramPath, ModesAreHeldOnLegsBetweenOverlappingCorners) {
  constexpr const char* zigzag =
      "G64 P5 F3000\nG91 G1 X29.6984848 Y29.6984848\nX-1.41421356 Y1.41421356\nX29.6984848 Y29.6984848\nM2\n";
  Task task = path_task();
  const Filter filter = trapezoid(60, 20);
  Mode mode{25.0, 25.0, 1.0};
  mode.axis = 0;
  const auto plan = [&](double bound) {
    mode.displacement_max = bound;
    task.machine.modes = {mode};
    return run_program({"part", read_path(zigzag, task), task}, filter);
  };
  const ProgramResult loose = plan(1.0);
  ASSERT_THAT(loose.plan.command()->delays, testing::Each(0));
  const double turned = 2.0 * 0.05 * std::sqrt(0.5);  // m/s
  const double expected = residual_amplitude(filter, 0.0, turned, 0, 25.0, task.sample_period);
  EXPECT_NEAR(use_of_kind(loose, LimitKind::residual)->value, expected, 1e-6 * expected);
  EXPECT_EQ(use_of_kind(loose, LimitKind::residual)->line, loose.plan.path.line[1]);
  const ProgramResult held = plan(0.7 * expected);
  ASSERT_TRUE(held.verification.feasible) << held.message;
  EXPECT_LE(use_of_kind(held, LimitKind::residual)->value, 0.7 * expected * (1.0 + 1e-9));
}

/// In the time of zero taps behind the filter, a damped vibration dies away. Feeds take whole samples here.
TEST(ProgramPath, ZeroTapsBehindTheFilterAreTimeToDieAway) {
  Task task = path_task();
  Mode mode{40.0, 40.0, 1.0};
  mode.damping_low = mode.damping_high = 0.1, mode.axis = 0, mode.displacement_max = 1.0;
  task.machine.modes = {mode};
  const Filter filter = trapezoid(60, 20);
  std::vector<double> longer(filter.taps().begin(), filter.taps().end());
  longer.resize(longer.size() + 14, 0.0);
  const ProgramResult result = run_program({"part", read_path("F6000\nG1 X40\nM2\n", task), task}, Filter(longer));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  const double dies = std::exp(-0.1 * 2.0 * std::numbers::pi * 40.0 * 14 * task.sample_period);
  const double left = dies * residual_amplitude(filter, 0.0, 0.1, 0, 40.0, task.sample_period, 0.1);
  EXPECT_NEAR(use_of_kind(result, LimitKind::residual)->value, left, 1e-9 * left);
}

/// A bound that no start from rest holds at the programmed feed lowers feeds; one of almost nothing is not met
/// silently.
TEST(ProgramPath, ModesOfAxesLowerFeeds) {
  Task task = path_task();
  Mode mode{40.0, 44.0, 1.0};
  mode.axis = 1;
  mode.displacement_max = 0.3 * residual_amplitude(trapezoid(60, 20), 0.0, 0.1, 0, 40.0, task.sample_period);
  task.machine.modes = {mode};
  const ProgramResult result =
      run_program({"part", read_path("G64 P0.05 F6000\nG1 Y40\nG1 X20\nM2\n", task), task}, trapezoid(60, 20));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  EXPECT_LE(use_of_kind(result, LimitKind::residual)->utilisation, 1.0 + 1e-9);
  EXPECT_GT(result.cycle_time, 0.7);
}

/// The largest distance from the path is that of dense points, and bounds hold at corners and on arcs.
TEST(ProgramPath, ContourIsHeldByEveryPlan) {
  constexpr const char* part = "G64 P0.1 F9000\nG1 X30\nG4 P0.3\nG1 Y25\nG3 X20 Y35 I-10\nG1 X0 Y20\nG1 X-8 Y28\nM2\n";
  const Filter filter = trapezoid(60, 20);
  for (const double gain : {unlimited, 250.0}) {
    for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
      double before = 0.0;
      for (const double bound : {1e-3, 4e-5, 1e-5}) {
        SCOPED_TRACE(testing::Message() << gain << ", " << static_cast<int>(feeds) << ", " << bound);
        Task task = path_task();
        for (Axis& axis : task.machine.axes) axis.servo_gain = gain;
        task.program_contour_max = bound;
        const ProgramResult result = run_program({"part", read_path(part, task), task, feeds}, filter);
        ASSERT_TRUE(result.verification.feasible) << result.message;
        const double most = farthest(positions(result.plan, task.sample_period, true), result.plan.path);
        const double said = use_of_kind(result, LimitKind::contour)->value;
        EXPECT_NEAR(said, most, 2e-3 * most + 1e-9);
        EXPECT_LE(most, bound * (1.0 + 1e-9) + 1e-12);
        EXPECT_GE(result.cycle_time, before);
        before = result.cycle_time;
      }
    }
  }
}

/// x' = Kv (s - x) for each axis by itself, the command even within a sample: midpoint rule, T/100.
std::vector<std::vector<double>> followed(const std::vector<std::vector<double>>& command, const Task& task) {
  std::vector<std::vector<double>> motion = command;
  const double h = task.sample_period / 100.0;
  for (std::size_t a = 0; a < 2; ++a) {
    const double gain = task.machine.axes[a].servo_gain;
    double x = command.front()[a];
    for (std::size_t k = 1; k < command.size(); ++k) {
      const double from = command[k - 1][a], v = (command[k][a] - from) / task.sample_period;
      for (int i = 0; i < 100; ++i) {
        const double s = from + i * h * v, half = x + 0.5 * h * gain * (s - x);
        x += h * gain * (s + 0.5 * h * v - half);
      }
      motion[k][a] = x;
    }
  }
  return motion;
}

/// Axes that follow with different gains: errors, bent straight legs and arcs' radius are those of the two loops.
TEST(ProgramPath, AxesThatDifferFollowTheirOwnLoops) {
  constexpr const char* part = "G64 P0.1 F3000\nG1 X20 Y10\nG1 X0 Y25\nG1 X-15\nG3 X-15 Y45 J10\nG1 X10 Y60\nM2\n";
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    for (const double bound : {unlimited, 6e-5}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(feeds) << ", " << bound);
      Task task = path_task();
      task.machine.axes[0].servo_gain = 300.0, task.machine.axes[1].servo_gain = 200.0;
      if (bound < unlimited) task.program_contour_max = bound;
      const ProgramResult result = run_program({"part", read_path(part, task), task, feeds}, trapezoid(60, 20));
      ASSERT_TRUE(result.verification.feasible) << result.message;
      const auto motion = followed(positions(result.plan, task.sample_period, false), task);
      const auto said = positions(result.plan, task.sample_period, true);
      double off = 0.0;
      for (std::size_t k = 0; k < motion.size(); ++k)
        off = std::max(off, std::hypot(motion[k][0] - said[k][0], motion[k][1] - said[k][1]));
      EXPECT_LT(off, 2e-8);
      const Toolpath& path = result.plan.path;
      for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
        if (path.joint[b] != Joint::corner) continue;
        double least = unlimited;
        for (const auto& at : motion)
          least = std::min(least, std::hypot(at[0] - path.point(b + 1)[0], at[1] - path.point(b + 1)[1]));
        EXPECT_NEAR(result.errors[b], least, 2e-8);
        EXPECT_LE(least, 1e-4 + 2e-8);
      }
      if (bound < unlimited) {
        EXPECT_LE(farthest(motion, path), bound + 2e-8);
      }
    }
  }
}

/// At constant feed a loop lags by (1 - g)/Kv, so that a leg at 45 degrees is off its line by half the difference times
/// the feed. Feeds above that of the bound fall to it, and take as long as if they were programmed so.
TEST(ProgramPath, FeedsFallToThoseThatKeepTheContour) {
  Task task = path_task();
  for (Axis& axis : task.machine.axes)
    axis.velocity_feedforward = 0.9, axis.acceleration_max = 20.0, axis.jerk_max = 4e3;
  task.machine.axes[0].servo_gain = 100.0, task.machine.axes[1].servo_gain = 80.0;
  task.program_contour_max = 3e-5;
  const double allowed = 3e-5 / (0.5 * (0.1 / 80.0 - 0.1 / 100.0));
  const auto part = [](double feed) {
    return fmt::format("G64 P0.15 F{:.3f}\nG1 X100 Y100\nG1 X0 Y200\nG1 X100 Y300\nM2\n", 6e4 * feed);
  };
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    SCOPED_TRACE(static_cast<int>(feeds));
    const Filter filter = trapezoid(60, 20);
    const ProgramResult fast = run_program({"part", read_path(part(1.4 * allowed), task), task, feeds}, filter);
    const ProgramResult slow = run_program({"part", read_path(part(allowed), task), task, feeds}, filter);
    ASSERT_TRUE(fast.verification.feasible) << fast.message;
    EXPECT_LE(farthest(positions(fast.plan, task.sample_period, true), fast.plan.path), 3e-5 * (1.0 + 1e-9) + 1e-12);
    const Toolpath& path = fast.plan.path;
    double top = 0.0;
    for (std::size_t b = 0; b < path.blocks(); ++b) top = std::max(top, path.length(b) / path.duration[b]);
    // Moves last whole samples, of which a leg has 589 or more.
    EXPECT_LE(top, allowed * (1.0 + 1e-9));
    EXPECT_GE(top, allowed * (1.0 - 1.0 / 589.0));
    EXPECT_NEAR(fast.cycle_time, slow.cycle_time, 3.0 * task.sample_period);
    if (feeds == Feeds::choose) continue;
    ASSERT_EQ(fast.too_fast.size(), 1U);
    EXPECT_EQ(fast.too_fast.front().limit, "contour");
    EXPECT_EQ(fast.too_fast.front().blocks, 3U);
    EXPECT_NEAR(fast.too_fast.front().factor, 1.0 / 1.4, 1e-9);
    EXPECT_TRUE(slow.too_fast.empty());
  }
}

class PathCommand : public ProgramCommand {
 protected:
  void task(const std::string& axes, const std::string& end) {
    write("path.toml", "sample_period_ms = 1\n[filter]\nkind = \"trapezoid\"\norder = 54\nramp = 18\n" + axes +
                           "[program]\nerror_max_um = 50\n" + end);
    write("part.ngc", "G64 F6000\nG1 X30\nG1 Y25\nG3 X20 Y35 I-10\nG1 X0 Y20\nG4 P0.4\nG61.1\nG1 X8 Y28\nM2\n");
  }
  static std::string axis(const std::string& name, const std::string& more) {
    return "[[axis]]\nname = \"" + name +
           "\"\nvelocity_max_mm_s = 300\nacceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 300000\n" + more;
  }
};

TEST_F(PathCommand, ResultsAreVerifiedByOtherFormulas) {
  task(
      axis("x", "servo_gain_1_s = 250\n") + axis("y", "servo_gain_1_s = 180\n"),
      "contour_max_um = 30\n[[mode]]\nfrequency_Hz = 45\nfrequency_spread = 0.05\ndamping_ratio = [0.01, 0.03]\naxis = "
      "\"y\"\nresidual_max_um = 8\n");
  ASSERT_EQ(run("program part.ngc --task path.toml --json r.json --time-limit 10").code, 0)
      << read("err") << read("out");
  EXPECT_THAT(read("out"), HasSubstr("axes lag differently: the motion leaves straight legs by up to"));
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  EXPECT_TRUE(result["servo"]["axes_differ"]);
  const std::string joints = result["commands"]["joint"];
  const auto turns = std::count(joints.begin(), joints.end(), 's');
  EXPECT_GT(turns, 0);
  const std::string inside = fmt::format(
      "residual of y: judged at the ends of arcs and other smooth turns, not inside them ({} points)\n", turns);
  const std::string earlier = "residual of y: earlier corners are not added where the motion has gone on evenly since";
  EXPECT_THAT(read("out"), AllOf(HasSubstr(inside), HasSubstr(earlier)));
  for (const auto& limit : result["limits"]) {
    EXPECT_EQ(limit.contains("smooth_turns_judged_at_ends"), limit["kind"] == "residual");
    EXPECT_EQ(limit.value("smooth_turns_judged_at_ends", turns), turns);
  }
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  EXPECT_THAT(read("out"), AllOf(HasSubstr(inside), HasSubstr(earlier)));
  const auto refused = [&](const std::string& kind, double factor) {
    auto forged = result;
    for (auto& limit : forged["limits"]) {
      if (limit["kind"] == kind) limit["value"] = factor * limit["value"].get<double>();
    }
    write("forged.json", forged.dump());
    EXPECT_EQ(run("verify forged.json").code, 1) << kind << read("out") << read("err");
  };
  refused("contour", 0.99);
  refused("residual", 1.001);
  auto slack = result;
  std::string text = slack["inputs"]["task_text"];
  text.replace(text.find("contour_max_um = 30"), 19, "contour_max_um = 25");
  slack["inputs"]["task_text"] = text;
  write("forged.json", slack.dump());
  EXPECT_EQ(run("verify forged.json").code, 1) << read("out") << read("err");
}

TEST_F(PathCommand, OverlappingCornersAreVerifiedByOtherFormulas) {
  task(axis("x", "") + axis("y", ""),
       "[[mode]]\nfrequency_Hz = 25\nfrequency_spread = 0.1\ndamping_ratio = [0.01, 0.05]\naxis = \"x\"\n"
       "residual_max_um = 100\n");
  write("part.ngc", "G64 P2 F6000\nG1 X30 Y30\nG91 X-3 Y3\nX2.5 Y3\nX-2 Y1\nX3\nX30 Y20\nM2\n");
  ASSERT_EQ(run("program part.ngc --task path.toml --json r.json --time-limit 10").code, 0) << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  auto forged = nlohmann::ordered_json::parse(read("r.json"));
  for (auto& limit : forged["limits"]) {
    if (limit["kind"] == "residual") limit["value"] = 1.001 * limit["value"].get<double>();
  }
  write("forged.json", forged.dump());
  EXPECT_EQ(run("verify forged.json").code, 1) << read("out") << read("err");
  EXPECT_FALSE(forged["limits"].back().contains("smooth_turns_judged_at_ends"));
}

TEST_F(PathCommand, PlansThatDoNotConsiderTheKeysRefuseThem) {
  const auto refused = [&](const std::string& plan, const std::string& named) {
    EXPECT_NE(run("program part.ngc --task path.toml --plan " + plan).code, 0);
    EXPECT_THAT(read("err"), HasSubstr(named));
  };
  task(axis("x", "") + axis("y", ""), "[[mode]]\nfrequency_Hz = 45\naxis = \"y\"\nresidual_max_um = 8\n");
  refused("free", "residual_max_um");
  task(axis("x", "servo_gain_1_s = 250\n") + axis("y", "servo_gain_1_s = 180\n"), "");
  refused("profiles", "servo_gain_1_s");
}

}  // namespace
}  // namespace accdec
