#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/plan/verify/used_limits.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate/direct.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// A servo behind the filter of a program: errors and loads are those of its motion, all else is the command's.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;

constexpr const char* servo_part =
    "G21 G90 G64 P0.05 F3000\nG0 X5 Y5\nG1 X30\nY30\nG3 X20 Y40 I-10\nG1 X0 Y10\nX-0.4\nY9.6\nG61.1\nG1 X3 Y3\n"
    "G64 P0.02\nX20\nM2\n";

Task servo_task(double gain, double feedforward) {
  Task task;
  task.sample_period = 1e-3;
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = 2.0;
    axis.jerk_max = 200.0;
    axis.mass = 20.0;
    axis.damping = 60.0;
    axis.force_max = 38.0;
    axis.servo_gain = gain;
    axis.velocity_feedforward = feedforward;
    task.machine.axes.push_back(axis);
  }
  return task;
}

/// The loop as it is, x' = Kv (s - x) + g s', in steps of T/100 by the midpoint rule; s moves evenly within a sample.
std::vector<std::vector<double>> looped(const std::vector<std::vector<double>>& command, const Task& task) {
  constexpr int steps = 100;
  const double h = task.sample_period / steps;
  std::vector<std::vector<double>> motion = command;
  for (std::size_t a = 0; a < command.front().size(); ++a) {
    const Axis& axis = task.machine.axes[a];
    double x = command.front()[a];
    for (std::size_t k = 1; k < command.size(); ++k) {
      const double from = command[k - 1][a], v = (command[k][a] - from) / task.sample_period;
      for (int i = 0; i < steps; ++i) {
        const double s = from + i * h * v;
        const auto speed = [&](double at, double after) {
          return axis.servo_gain * (s + after * v - at) + axis.velocity_feedforward * v;
        };
        x += h * speed(x + 0.5 * h * speed(x, 0.0), 0.5 * h);
      }
      motion[k][a] = x;
    }
  }
  return motion;
}

/// A loop that overshoots: the velocity follows Kv (s - x) with a lag of 1/Kv.
std::vector<double> overshooting(const std::vector<double>& command, double gain, double period) {
  constexpr int steps = 100;
  const double h = period / steps;
  double x = command.front(), v = 0.0;
  std::vector<double> motion{x};
  for (std::size_t k = 1; k < command.size(); ++k) {
    for (int i = 0; i < steps; ++i) {
      const double half = command[k - 1] + (i + 0.5) / steps * (command[k] - command[k - 1]);
      const double middle = x + 0.5 * h * v, v_middle = v + 0.5 * h * gain * (gain * (half - 0.5 * h * v - x) - v);
      v += h * gain * (gain * (half - middle) - v_middle);
      x += h * v_middle;
    }
    motion.push_back(x);
  }
  return motion;
}

/// Its response to a velocity of one sample: the first `count` taps, the rest on the last one.
std::vector<double> measured(double gain, double period, int count) {
  std::vector<double> command(static_cast<std::size_t>(count) + 1, period);
  command.front() = 0.0;
  const std::vector<double> motion = overshooting(command, gain, period);
  std::vector<double> taps;
  for (std::size_t k = 1; k < motion.size(); ++k) taps.push_back((motion[k] - motion[k - 1]) / period);
  taps.back() += 1.0 - motion.back() / period;
  return taps;
}

std::vector<std::vector<double>> samples_of(const Plan& plan, double period, bool servo) {
  std::vector<std::vector<double>> rows;
  Motion motion(plan, period, servo);
  for (Sample sample; motion.next(sample);)
    rows.push_back({sample.position.begin(), sample.position.begin() + static_cast<long>(plan.path.dimensions())});
  return rows;
}

/// Least distance of any sample from the end of block b; joints are far enough apart for that.
double nearest(const std::vector<std::vector<double>>& rows, const double* point) {
  double least = unlimited;
  for (const auto& row : rows) least = std::min(least, std::hypot(row[0] - point[0], row[1] - point[1]));
  return least;
}

double largest_force(const std::vector<std::vector<double>>& rows, std::size_t a, const Task& task) {
  double most = 0.0, before = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double v = (rows[k][a] - rows[k - 1][a]) / task.sample_period;
    const Axis& axis = task.machine.axes[a];
    most = std::max(most, std::abs(axis.mass * (v - before) / task.sample_period + axis.damping * v));
    before = v;
  }
  return most;
}

TEST(ProgramServo, ErrorsAndLoadsAreThoseOfTheLoop) {
  const Filter filter = trapezoid(40, 10);
  for (const auto& [gain, feedforward] : std::map<double, double>{{200.0, 0.0}, {100.0, 0.7}, {400.0, 0.0}}) {
    for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
      const Task task = servo_task(gain, feedforward);
      const ProgramResult result = run_program({"part", test::path_of(servo_part, task.machine), task, feeds}, filter);
      ASSERT_TRUE(result.verification.feasible) << result.message;
      ASSERT_TRUE(result.servo);
      const auto command = samples_of(result.plan, task.sample_period, false);
      ASSERT_EQ(command.size(), static_cast<std::size_t>(result.check.samples) + 1);
      // The command rests at its end while the loop follows.
      auto longer = command;
      longer.insert(longer.end(), 3000, command.back());
      const auto motion = looped(longer, task);
      const Toolpath& path = result.plan.path;
      for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
        if (path.joint[b] != Joint::corner && path.joint[b] != Joint::stop) continue;
        EXPECT_NEAR(result.errors[b], nearest(motion, path.point(b + 1)), 1e-8) << gain << " block " << b;
      }
      for (std::size_t a = 0; a < 2; ++a)
        EXPECT_NEAR(result.loads[a].peak, largest_force(motion, a, task), 2e-3 * result.loads[a].peak) << gain;
      std::size_t settled = command.size() - 1;
      const double* end = path.point(path.blocks());
      for (std::size_t k = settled; k < motion.size(); ++k) {
        if (std::hypot(motion[k][0] - end[0], motion[k][1] - end[1]) > 50e-6) settled = k + 1;
      }
      EXPECT_EQ(result.servo->within, 50e-6);
      EXPECT_NEAR(result.servo->settling, static_cast<double>(settled + 1 - command.size()) * 1e-3, 1.001e-3);
    }
  }
}

TEST(ProgramServo, OvershootsAreThoseOfTheLoop) {
  const Filter filter = trapezoid(40, 10);
  Task task = servo_task(unlimited, 0.0);
  const std::vector<double> gains{150.0, 220.0};
  for (std::size_t a = 0; a < 2; ++a) {
    task.machine.axes[a].response_taps = measured(gains[a], task.sample_period, 200);
    ASSERT_LT(*std::ranges::min_element(task.machine.axes[a].response_taps), -0.001);
  }
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    const ProgramResult result = run_program({"part", test::path_of(servo_part, task.machine), task, feeds}, filter);
    ASSERT_TRUE(result.verification.feasible) << result.message;
    auto rows = samples_of(result.plan, task.sample_period, false);
    rows.insert(rows.end(), 300, rows.back());
    for (std::size_t a = 0; a < 2; ++a) {
      std::vector<double> column;
      for (const auto& row : rows) column.push_back(row[a]);
      const std::vector<double> moved = overshooting(column, gains[a], task.sample_period);
      for (std::size_t k = 0; k < rows.size(); ++k) rows[k][a] = moved[k];
    }
    const Toolpath& path = result.plan.path;
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (path.joint[b] != Joint::corner && path.joint[b] != Joint::stop) continue;
      const double error = nearest(rows, path.point(b + 1));
      EXPECT_NEAR(result.errors[b], error, 1e-8) << "block " << b;
      EXPECT_LE(error, path.tolerance[b] + 1e-8);
    }
    for (std::size_t a = 0; a < 2; ++a) {
      const double force = largest_force(rows, a, task);
      EXPECT_NEAR(result.loads[a].peak, force, 2e-3 * force);
      EXPECT_LE(force, task.machine.axes[a].force_max * (1.0 + 1e-6));
    }
  }
}

/// A slower loop needs longer delays or lower feeds; a fast one nearly none.
TEST(ProgramServo, CostsTime) {
  const Filter filter = trapezoid(40, 10);
  const auto time = [&](double gain) {
    const Task task = servo_task(gain, 0.0);
    const ProgramResult result =
        run_program({"part", test::path_of(servo_part, task.machine), task, Feeds::choose}, filter);
    EXPECT_TRUE(result.verification.feasible) << gain << result.message;
    return result.cycle_time;
  };
  const double ideal = time(unlimited);
  EXPECT_GT(time(100.0), time(300.0));
  EXPECT_GE(time(300.0), ideal);
  EXPECT_NEAR(time(9000.0), ideal, 0.01 * ideal);
}

/// One move at constant speed behind r_0 = 1 - c, r_k = c (1 - a) a^(k-1), with viscous friction alone. After k samples
/// of the move, 1 - c a^(k-1) of its speed is reached. Behind its end, c (1 - a^n) a^k of it is left. Both count, over
/// the samples of the move and one at rest.
TEST(ProgramServo, TheMeanForceIsOverTheProgramsTime) {
  constexpr double gain = 40.0, v = 0.1, n = 300.0;
  Task task = servo_task(gain, 0.0);
  for (Axis& axis : task.machine.axes)
    axis.acceleration_max = axis.jerk_max = axis.force_max = unlimited, axis.mass = 0;
  const ProgramResult result =
      run_program({"part", test::path_of("G1 X30 F6000\nM2\n", task.machine), task}, Filter({1.0}));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  ASSERT_EQ(result.check.samples, n + 1);
  const double a = std::exp(-gain * 1e-3), c = (1.0 - a) / (gain * 1e-3), left = std::pow(a, n);
  const double squares = n - 2.0 * c * (1.0 - left) / (1.0 - a) + c * c * (1.0 - left * left) / (1.0 - a * a) +
                         c * c * (1.0 - left) * (1.0 - left) / (1.0 - a * a);
  EXPECT_NEAR(result.loads[0].rms, 60.0 * v * std::sqrt(squares / (n + 1)), 1e-9);
}

/// A motion that begins after the program's last sample heats a drive as much as one without this dead time: n samples
/// at v/(n T) up, and n down. The plan is slowed until the drive keeps its rating, by the verifier's formula, too.
TEST(ProgramServo, DeadTimeDoesNotCoolADrive) {
  constexpr int n = 20;
  constexpr double v = 0.1, peak = 20.0 * v / (n * 1e-3);
  Task task = servo_task(unlimited, 0.0);
  for (Axis& axis : task.machine.axes) {
    axis.acceleration_max = axis.jerk_max = axis.force_max = unlimited, axis.damping = 0.0;
    axis.response_taps.assign(200, 0.0), axis.response_taps.back() = 1.0;
  }
  const auto planned = [&] {
    return run_program({"part", test::path_of("G1 X3 F6000\nM2\n", task.machine), task},
                       Filter(std::vector<double>(n, 1.0 / n)));
  };
  const ProgramResult warm = planned();
  ASSERT_EQ(warm.check.samples, 30 + n);
  EXPECT_NEAR(warm.loads[0].peak, peak, 1e-6);
  const double rms = peak * std::sqrt(2.0 * n / (30 + n));
  EXPECT_NEAR(warm.loads[0].rms, rms, 1e-6);
  task.machine.axes[0].force_rms_max = 0.7 * rms;
  const ProgramResult cool = planned();
  const DirectMotion command =
      direct_motion(cool.plan.path, 1e-3, {}, {.filters = {cool.plan.filter()}, .of_block = {}, .behind = 200});
  EXPECT_NEAR(rms_force(behind_servos(command, task.machine, 1e-3), task.machine.axes[0], 0, 1e-3), cool.loads[0].rms,
              1e-9 * rms);
  ASSERT_TRUE(cool.verification.feasible) << cool.message;
  const double move = static_cast<double>(cool.check.samples) - n;  // samples; the feed is 3 mm over them
  EXPECT_NEAR(cool.loads[0].rms, 20.0 * 3e-3 / (move * n * 1e-6) * std::sqrt(2.0 * n / (move + n)), 1e-6);
  EXPECT_LE(cool.loads[0].rms, 0.7 * rms * (1.0 + 1e-9));
}

class ServoCommand : public ProgramCommand {
 protected:
  /// @param more  keys of the only axis
  void task(const std::string& more, const std::string& end = "") {
    write("servo.toml",
          "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 200\nacceleration_max_mm_s2 = 2000\n"
          "jerk_max_mm_s3 = 200000\nmass_kg = 20\nforce_max_N = 100\n" +
              more + end);
    write("part.ngc", servo_part);
  }
};

TEST_F(ServoCommand, IsInEveryOutput) {
  task("servo_gain_1_s = 90\nvelocity_feedforward = 0.1\n", "[controller]\nprefilter_taps = [0.5, 0.5]\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --json r.json --emit e.ngc --samples s.csv --time-limit 10").code,
            0)
      << read("err");
  EXPECT_THAT(read("out"), HasSubstr("the motion is within 50 um of its end"));
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  EXPECT_GT(result["servo"]["settling_s"], 0.0);
  EXPECT_GT(result["servo"]["stop_error_m"], 0.0);
  EXPECT_THAT(read("s.csv"),
              HasSubstr("x_mm,x_mm_s,y_mm,y_mm_s,x_motion_mm,x_motion_mm_s,y_motion_mm,y_motion_mm_s\n"));
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  ASSERT_EQ(run("program e.ngc --task servo.toml --dwells-before-filter --json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.0001e-3);
  const auto refused = [&](const char* what, const auto& forge) {
    auto forged = result;
    forge(forged);
    write("forged.json", forged.dump());
    EXPECT_EQ(run("verify forged.json").code, 1) << what << read("out") << read("err");
  };
  refused("settling",
          [](auto& json) { json["servo"]["settling_s"] = 0.5 * json["servo"]["settling_s"].template get<double>(); });
  refused("stops", [](auto& json) { json["servo"]["stop_error_m"] = 0.0; });
  refused("errors", [](auto& json) {
    // Some joints have none: which ones, the plan decides.
    auto& errors = json["commands"]["error_m"];
    const auto largest = std::max_element(errors.begin(), errors.end());
    ASSERT_GT(largest->template get<double>(), 0.0);
    *largest = 0.5 * largest->template get<double>();
  });
}

TEST_F(ServoCommand, BoundsStopsWhereTheTaskDoes) {
  task("servo_gain_1_s = 150\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --json free.json --time-limit 10").code, 0) << read("err");
  EXPECT_GT(number_of("free.json", "stop_error_m"), 5e-6);
  task("servo_gain_1_s = 150\n", "[program]\nerror_max_um = 5\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --json bounded.json --emit e.ngc --time-limit 10").code, 0)
      << read("err");
  EXPECT_LE(number_of("bounded.json", "stop_error_m"), 5e-6 * (1 + 1e-9));
  EXPECT_GT(number_of("bounded.json", "cycle_time_s"), number_of("free.json", "cycle_time_s"));
  ASSERT_EQ(run("verify bounded.json").code, 0) << read("err") << read("out");
  // The wait of the stop for the servo is written as a dwell.
  ASSERT_EQ(run("program e.ngc --task servo.toml --dwells-before-filter --json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("bounded.json", "cycle_time_s"), 1.0001e-3);
  EXPECT_LE(number_of("again.json", "stop_error_m"), 5e-6 * (1 + 1e-9));
}

TEST_F(ServoCommand, OtherPlansAndOtherServosAreRefused) {
  task("servo_gain_1_s = 150\n");
  for (const char* plan : {"profiles", "free"}) {
    EXPECT_EQ(run(fmt::format("program part.ngc --task servo.toml --plan {} --samples s.csv", plan)).code, 2);
    EXPECT_THAT(read("err"), HasSubstr("does not consider the servo of an axis"));
  }
  EXPECT_EQ(run("program part.ngc --task servo.toml --filter-bound").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("--filter-bound is for motions without a servo"));
}

/// Only axes that the program moves count for what is left out.
TEST_F(ServoCommand, OnlyMovedAxesLeaveAnythingOut) {
  const std::string head =
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 49\n[[axis]]\nname = \"x\"\n"
      "servo_gain_1_s = 100\nmass_kg = 10\nforce_rms_N = 100\n[[axis]]\nname = \"y\"\n";
  write("moved.toml", head);
  write("x.ngc", "G21 G90 G64 P0.05\nG1 X0 Y0 F3000\nX90\nM2\n");
  write("xy.ngc", "G21 G90 G64 P0.05\nG1 X0 Y0 F3000\nX90\nY10\nM2\n");
  ASSERT_EQ(run("program x.ngc --task moved.toml --json r.json").code, 0) << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  EXPECT_EQ(nlohmann::ordered_json::parse(read("r.json"))["not_considered"].dump(), "[\"vibration\"]");
  run("program x.ngc --task moved.toml");
  EXPECT_THAT(read("out"), HasSubstr("ignored: vibration of the machine (the task has no [[mode]])\n"));
  run("program xy.ngc --task moved.toml");
  EXPECT_THAT(read("out"),
              HasSubstr("following error and feedforward of the servo of axis y, thermal rating of the drive of axis "
                        "y\n"));
}

TEST_F(ServoCommand, OvershootsAreInEveryOutput) {
  task("response_taps = [0.2, 0.5, 0.5, -0.1, -0.15, 0.05]\n");
  ASSERT_EQ(run("program part.ngc --task servo.toml --json r.json --emit e.ngc --samples s.csv --time-limit 10").code,
            0)
      << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  ASSERT_EQ(run("program e.ngc --task servo.toml --dwells-before-filter --json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.0001e-3);
  auto forged = nlohmann::ordered_json::parse(read("r.json"));
  for (auto& error : forged["commands"]["error_m"]) error = 0.5 * error.get<double>();
  write("forged.json", forged.dump());
  EXPECT_EQ(run("verify forged.json").code, 1);
}

}  // namespace
}  // namespace accdec
