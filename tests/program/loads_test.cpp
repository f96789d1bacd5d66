#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>

#include "program_command.hpp"
#include "reference.hpp"

// Dry friction, force-speed curves, the shared supply and ratings of drives over whole programs: against closed forms,
// and against differences of all positions.

namespace accdec {
namespace {

using test::ProgramCommand;
using testing::HasSubstr;
using testing::Not;

/// Mass, viscous and dry friction on both axes.
Task loaded_task() {
  Task task;
  task.machine = test::machine_of(3.0, 400.0, 0.5, 2);
  for (Axis& axis : task.machine.axes) axis.mass = 34.0, axis.damping = 120.0, axis.coulomb = 40.0;
  return task;
}

Toolpath path_of(const std::string& text, const Task& task) {
  LineSource source("part.ngc", text);
  return read_toolpath(source, task.machine, {});
}

/// The motion of every axis at every sample, by differences of its positions.
struct Moved {
  std::vector<std::vector<double>> velocity, force;  // [axis][sample]

  Moved(const ProgramResult& result, const Task& task) {
    const std::size_t axes = result.plan.path.dimensions();
    std::vector<std::vector<long double>> at(axes);
    visit_samples(result, [&](std::int64_t, const double* x, const double*) {
      for (std::size_t a = 0; a < axes; ++a) at[a].push_back(x[a]);
    });
    const long double T = result.sample_period;
    for (std::size_t a = 0; a < axes; ++a) {
      const Axis& axis = task.machine.axes[a];
      velocity.emplace_back(), force.emplace_back();
      long double before = 0.0L;
      for (std::size_t k = 1; k < at[a].size(); ++k) {
        const long double v = (at[a][k] - at[a][k - 1]) / T, moving = axis.mass * (v - before) / T + axis.damping * v;
        before = v;
        // Positions of a metre are rounded to 1e-16 m, which are 1e-13 m/s.
        const bool stands = std::abs(v) < 1e-9L;
        const long double dry = stands ? std::clamp<long double>(-moving, -axis.coulomb, axis.coulomb)
                                       : std::copysign<long double>(axis.coulomb, v);
        velocity[a].push_back(static_cast<double>(v));
        force[a].push_back(static_cast<double>(moving + dry));
      }
    }
  }
  template <class Value>
  double largest(const Value& value) const {
    double most = 0.0;
    for (std::size_t k = 0; k < velocity.front().size(); ++k) most = std::max(most, value(k));
    return most;
  }
  double power(std::size_t k) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < velocity.size(); ++a) sum += force[a][k] * velocity[a][k];
    return sum;
  }
};

const LimitUse* use_of(const ProgramResult& result, LimitKind kind, const std::string& axis) {
  for (const LimitUse& use : result.check.limits) {
    if (use.kind == kind && use.axis == axis) return &use;
  }
  return nullptr;
}

/// Straight along x at feed v through a boxcar of n taps: n samples at v/(n T) up and n down, friction with or against.
TEST(ProgramLoads, OfOneMoveAreThoseOfTheClosedForm) {
  Task task = loaded_task();
  Axis& x = task.machine.axes[0];
  x.damping = 0.0, x.jerk_max = unlimited, x.force_max = x.power_max = x.regeneration_max = 1e4;
  task.machine.power_total_max = task.machine.regeneration_total_max = 1e4;
  constexpr int n = 50;
  const ProgramResult result =
      run_program({"part.ngc", path_of("G1 X30 F6000\nM2\n", task), task}, Filter(std::vector<double>(n, 1.0 / n)));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  const std::string name = result.plan.path.axis_name(0);
  const double v = 0.1, a = v / (n * 1e-3), up = x.mass * a + x.coulomb, down = x.mass * a - x.coulomb;
  ASSERT_GT(down, 0.0);
  EXPECT_NEAR(use_of(result, LimitKind::force, name)->value, up, 1e-6);
  EXPECT_NEAR(use_of(result, LimitKind::power, name)->value, up * v, 1e-6);
  EXPECT_NEAR(use_of(result, LimitKind::regeneration, name)->value, down * v * (n - 1) / n, 1e-6);
  EXPECT_NEAR(use_of(result, LimitKind::power_total, "")->value, up * v, 1e-6);
  EXPECT_NEAR(use_of(result, LimitKind::regeneration_total, "")->value, down * v * (n - 1) / n, 1e-6);
  const double cruise = 300.0 - n;  // samples
  EXPECT_NEAR(result.loads[0].peak, up, 1e-6);
  EXPECT_NEAR(result.loads[0].rms,
              std::sqrt((n * up * up + n * down * down + cruise * x.coulomb * x.coulomb) / (300.0 + n)), 1e-6);
}

constexpr const char* legs =
    "G64 P0.02 F12000\nG1 X30\nG1 Y60\nG4 P0.3\nG1 X0\nG1 Y20 X-10\nG1 X40 F3000\nG3 X20 Y40 I-20 J0 F9000\nG1 X39 "
    "Y22\nM2\n";

/// Each limit alone, and all together: the plan holds it by differences of its positions, and uses it.
TEST(ProgramLoads, PlansHoldEveryLimit) {
  const std::map<std::string, void (*)(Task&)> limits{
      {"friction",
       [](Task& t) {
         for (Axis& x : t.machine.axes) x.force_max = 130.0;
       }},
      {"power",
       [](Task& t) {
         for (Axis& x : t.machine.axes) x.power_max = 18.0;
       }},
      {"regeneration",
       [](Task& t) {
         for (Axis& x : t.machine.axes) x.regeneration_max = 6.0;
       }},
      {"curve",
       [](Task& t) {
         for (Axis& x : t.machine.axes)
           x.force_speed = {{0.02, 180.0}, {0.1, 120.0}, {0.15, 70.0}}, x.force_speed_max = 180.0;
       }},
      {"motoring", [](Task& t) { t.machine.power_total_max = 20.0; }},
      {"braking", [](Task& t) { t.machine.regeneration_total_max = 7.0; }}};
  for (const auto& [name, add] : limits) {
    for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
      SCOPED_TRACE(name + (feeds == Feeds::keep ? ", programmed feeds" : ", chosen feeds"));
      Task task = loaded_task();
      add(task);
      const ProgramResult result = run_program({"part.ngc", path_of(legs, task), task, feeds}, trapezoid(70, 20));
      ASSERT_TRUE(result.verification.feasible) << result.message;
      const Moved moved(result, task);
      constexpr double rounding = 1.0 + 1e-7;
      double used = 0.0;
      for (std::size_t a = 0; a < 2; ++a) {
        const Axis& x = task.machine.axes[a];
        const auto& v = moved.velocity[a];
        const auto& f = moved.force[a];
        const double force = moved.largest([&](std::size_t k) { return std::abs(f[k]); });
        const double power = moved.largest([&](std::size_t k) { return f[k] * v[k]; });
        const double braking = moved.largest([&](std::size_t k) { return -f[k] * v[k]; });
        // Part of the curve's force, along its lines.
        const double curve = x.force_speed.empty() ? 0.0 : moved.largest([&](std::size_t k) {
          const double s = std::abs(v[k]);
          const double allowed = s <= 0.02 ? 180.0 : s <= 0.1 ? 180.0 - 750.0 * (s - 0.02) : 120.0 - 1000.0 * (s - 0.1);
          return s > 0.15 * rounding ? 2.0 : std::abs(f[k]) / allowed;
        });
        used = std::max({used, force / x.force_max, power / x.power_max, braking / x.regeneration_max, curve});
        EXPECT_NEAR(result.loads[a].peak, force, 1e-5);
      }
      const double motoring = moved.largest([&](std::size_t k) { return moved.power(k); });
      const double braking = moved.largest([&](std::size_t k) { return -moved.power(k); });
      used = std::max({used, motoring / task.machine.power_total_max, braking / task.machine.regeneration_total_max});
      EXPECT_LE(used, rounding);
      EXPECT_GT(used, 0.6);
      if (task.machine.power_total_max < unlimited) {
        EXPECT_NEAR(use_of(result, LimitKind::power_total, "")->value, motoring, 1e-5);
      }
      if (task.machine.regeneration_total_max < unlimited) {
        EXPECT_NEAR(use_of(result, LimitKind::regeneration_total, "")->value, braking, 1e-5);
      }
    }
  }
}

/// A machine that needs little force loses nothing by limits that do not bind.
TEST(ProgramLoads, LimitsThatDoNotBindCostNothing) {
  Task free = loaded_task(), limited = free;
  limited.machine.power_total_max = limited.machine.regeneration_total_max = 1e4;
  for (Axis& axis : limited.machine.axes) axis.force_speed = {{0.0, 900.0}, {0.5, 800.0}}, axis.force_speed_max = 900.0;
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    const auto time = [&](const Task& task) {
      return run_program({"part.ngc", path_of(legs, task), task, feeds}, trapezoid(70, 20)).cycle_time;
    };
    EXPECT_EQ(time(free), time(limited));
  }
}

/// A rating below what the plan needs lowers the feeds, no more than it must; one below the friction cannot be held.
TEST(ProgramLoads, RatingsLowerFeeds) {
  Task task = loaded_task();
  const auto plan = [&](double rating, Feeds feeds) {
    for (Axis& axis : task.machine.axes) axis.force_rms_max = rating;
    return run_program({"part.ngc", path_of(legs, task), task, feeds}, trapezoid(70, 20));
  };
  for (const Feeds feeds : {Feeds::keep, Feeds::choose}) {
    const ProgramResult hot = plan(unlimited, feeds);
    const double most = std::max(hot.loads[0].rms, hot.loads[1].rms), rating = 0.8 * most;
    const ProgramResult cool = plan(rating, feeds);
    ASSERT_TRUE(cool.verification.feasible) << cool.message;
    EXPECT_GT(cool.cycle_time, hot.cycle_time);
    const Moved moved(cool, task);
    double warmest = 0.0;
    for (std::size_t a = 0; a < 2; ++a) {
      long double squares = 0.0L;
      for (const double f : moved.force[a]) squares += static_cast<long double>(f) * f;
      const auto rms = static_cast<double>(std::sqrt(squares / static_cast<long double>(cool.check.samples)));
      EXPECT_NEAR(cool.loads[a].rms, rms, 1e-5);
      warmest = std::max(warmest, rms);
    }
    EXPECT_LE(warmest, rating * (1.0 + 1e-9));
    EXPECT_GT(warmest, 0.99 * rating);
    const ProgramResult never = plan(1.0, feeds);
    EXPECT_EQ(never.status, Status::failed);
    EXPECT_THAT(never.message, HasSubstr("root mean square of the force"));
  }
}

class LoadsCommand : public ProgramCommand {
 protected:
  void task(const std::string& axis, const std::string& end = "") {
    write("load.toml",
          "sample_period_ms = 1\n[filter]\nkind = \"trapezoid\"\norder = 40\nramp = 10\n[[axis]]\n"
          "velocity_max_mm_s = 300\nacceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 400000\nmass_kg = 34\n" +
              axis + end);
    write("part.ngc", legs);
  }
};

TEST_F(LoadsCommand, AreVerifiedWithFormulasOfTheirOwn) {
  task("coulomb_N = 40\nforce_speed_N = [[20, 180], [150, 120]]\nforce_rms_N = 60\n",
       "[machine]\npower_total_max_W = 20\nregeneration_total_max_W = 9\n");
  ASSERT_EQ(run("program part.ngc --task load.toml --json r.json --emit e.ngc").code, 0) << read("err") << read("out");
  EXPECT_THAT(read("out"), HasSubstr("power_total"));
  EXPECT_THAT(read("out"), HasSubstr("of its rating"));
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  ASSERT_EQ(run("program e.ngc --task load.toml --dwells-before-filter --json again.json").code, 0) << read("err");
  EXPECT_NEAR(number_of("again.json", "cycle_time_s"), number_of("r.json", "cycle_time_s"), 1.0001e-3);
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  const auto refused = [&](const char* what, const auto& forge) {
    auto forged = result;
    forge(forged);
    write("forged.json", forged.dump());
    EXPECT_EQ(run("verify forged.json").code, 1) << what << read("out") << read("err");
  };
  const std::size_t last = result["limits"].size() - 1;
  ASSERT_EQ(result["limits"][last]["kind"], "regeneration_total");
  refused("a value", [&](auto& json) {
    json["limits"][last]["value"] = 0.5 * json["limits"][last]["value"].template get<double>();
  });
  refused("a limit", [&](auto& json) { json["limits"].erase(last); });
  refused("a rating", [](auto& json) { json["axis_loads"][0]["force_rms_N"] = 1.0; });
  // The same motion at limits that it breaks.
  for (const auto& [from, to] : std::map<std::string, std::string>{{"power_total_max_W = 20", "power_total_max_W = 19"},
                                                                   {"coulomb_N = 40", "coulomb_N = 60"},
                                                                   {"force_rms_N = 60", "force_rms_N = 50"}}) {
    refused(from.c_str(), [&, from = from, to = to](auto& json) {
      auto text = json["inputs"]["task_text"].template get<std::string>();
      json["inputs"]["task_text"] = text.replace(text.find(from), from.size(), to);
    });
  }
}

TEST_F(LoadsCommand, OtherPlansRefuseThemByName) {
  for (const auto& [key, axis, end] :
       {std::tuple("coulomb_N", "force_max_N = 200\ncoulomb_N = 40\n", ""),
        std::tuple("force_speed_N", "force_speed_N = [[20, 180], [150, 120]]\n", ""),
        std::tuple("power_total_max_W", "", "[machine]\npower_total_max_W = 20\n"),
        std::tuple("regeneration_total_max_W", "", "[machine]\nregeneration_total_max_W = 20\n")}) {
    task(axis, end);
    for (const char* plan : {"profiles", "free"}) {
      EXPECT_EQ(run(std::string("program part.ngc --task load.toml --plan ") + plan).code, 2) << key;
      const std::string line = std::string(key) == "force_speed_N" ? "11" : "12";
      EXPECT_THAT(read("err"), HasSubstr("load.toml:" + line + ":1: plan " + plan + " does not consider `" + key +
                                         "`; leave it out, or use --plan fixed"));
    }
  }
}

/// Profiles are held against a rating, too: too warm ones are slowed until they hold it.
TEST_F(LoadsCommand, ProfilesAreHeldAgainstRatings) {
  task("force_max_N = 200\n");
  ASSERT_EQ(run("program part.ngc --task load.toml --plan profiles --json hot.json").code, 0) << read("err");
  const double rms = number_of("hot.json", "force_rms_N");
  task("force_max_N = 200\nforce_rms_N = " + std::to_string(0.7 * rms) + "\n");
  ASSERT_EQ(run("program part.ngc --task load.toml --plan profiles --json cool.json").code, 0) << read("err");
  EXPECT_LE(number_of("cool.json", "force_rms_N"), 0.7 * rms + 1e-6);  // the key has six decimals
  const auto seconds = [&](const char* file) {
    return nlohmann::ordered_json::parse(read(file))["cycle_time_s"].get<double>();
  };
  EXPECT_GT(seconds("cool.json"), seconds("hot.json"));
  ASSERT_EQ(run("verify cool.json").code, 0) << read("err") << read("out");
}

/// A rotary axis alone: the torque is inertia times angular acceleration, in rad/s^2.
TEST_F(LoadsCommand, OfARotaryAxisAreTorques) {
  write(
      "turn.toml",
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 49\n[[axis]]\nname = \"x\"\n[[axis]]\nname = \"a\"\n"
      "velocity_max_deg_s = 120\nacceleration_max_deg_s2 = 3000\njerk_max_deg_s3 = 3000000\ninertia_kg_m2 = 0.8\n"
      "torque_max_N_m = 60\n");
  write("turn.ngc", "G1 A90 F6000\nM2\n");  // 100 deg/s, 2000 deg/s^2
  ASSERT_EQ(run("program turn.ngc --task turn.toml --json r.json --samples s.csv").code, 0) << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  EXPECT_THAT(read("s.csv"), HasSubstr("a_deg,a_deg_s"));
  const auto result = nlohmann::ordered_json::parse(read("r.json"));
  const double rad = std::acos(-1.0) / 180.0;
  for (const auto& [kind, value, bound] :
       {std::tuple("velocity", 100.0 * rad, 120.0 * rad), std::tuple("acceleration", 2000.0 * rad, 3000.0 * rad),
        std::tuple("force", 0.8 * 2000.0 * rad, 60.0)}) {
    const auto use = std::ranges::find_if(
        result["limits"], [&, kind = kind](const auto& u) { return u["kind"] == kind && u["axis"] == "a"; });
    ASSERT_NE(use, result["limits"].end()) << kind;
    EXPECT_NEAR((*use)["value"].template get<double>(), value, 1e-8 * value) << kind;
    EXPECT_NEAR((*use)["bound"].template get<double>(), bound, 1e-12 * bound) << kind;
  }
  EXPECT_NEAR(result["axis_loads"][0]["torque_peak_N_m"].get<double>(), 0.8 * 2000.0 * rad, 1e-6);
  run("program turn.ngc --task turn.toml");
  // 0.8 kg m^2 at 2000 deg/s^2
  EXPECT_THAT(read("out"), HasSubstr("27.9253          60 N m"));
  EXPECT_THAT(read("out"), HasSubstr("100         120 deg/s"));
  // The same limits in millimetres are read, with a note.
  const double as_force = 60.0 * 3.14159265358979 / 180.0 * 1e3, as_mass = 0.8 * std::pow(3.14159265358979 / 0.18, 2);
  write(
      "turn.toml",
      "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 49\n[[axis]]\nname = \"x\"\n[[axis]]\nname = \"a\"\n"
      "velocity_max_mm_s = 120\nacceleration_max_mm_s2 = 3000\njerk_max_mm_s3 = 3000000\nmass_kg = " +
          std::to_string(as_mass) + "\nforce_max_N = " + std::to_string(as_force) + "\n");
  run("program turn.ngc --task turn.toml");
  EXPECT_THAT(read("out"), HasSubstr("27.9253          60 N m"));
  EXPECT_THAT(read("err"), HasSubstr("`velocity_max_mm_s` of axis a counts a degree as a millimetre; "
                                     "`velocity_max_deg_s` says so"));
}

/// Friction of a rotary axis is a torque; a program's only axis that turns is no linear one.
TEST_F(LoadsCommand, FrictionOfARotaryAxisIsATorque) {
  write("turn.toml",
        "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 49\n[[axis]]\nname = \"a\"\n"
        "velocity_max_deg_s = 120\ninertia_kg_m2 = 0.8\ndamping_N_m_s = 0.5\ncoulomb_N_m = 3\n"
        "torque_max_N_m = 60\ntorque_rms_N_m = 20\n");
  write("turn.ngc", "G1 A90 F6000\nM2\n");  // 100 deg/s within 50 ms
  ASSERT_EQ(run("program turn.ngc --task turn.toml --feeds keep --json r.json").code, 0) << read("err");
  ASSERT_EQ(run("verify r.json").code, 0) << read("err") << read("out");
  write("unit.toml", read("turn.toml") + "[controller]\nposition_unit_um = 0.1\n");
  run("program turn.ngc --task unit.toml --feeds keep");
  EXPECT_THAT(read("out"), HasSubstr("whole numbers of 0.1 mdeg; differences of them read up to 4e+05 deg/s^3 more"));
  EXPECT_THAT(read("out"), HasSubstr("rounding moves a position by up to 0.05 mdeg: corner errors do not count it\n"));
  run("program turn.ngc --task turn.toml --feeds keep");
  const double rad = std::acos(-1.0) / 180.0, torque = 0.8 * 2000.0 * rad + 0.5 * 100.0 * rad + 3.0;
  char text[40];
  std::snprintf(text, sizeof text, "%.6g          60 N m", torque);
  EXPECT_THAT(read("out"), HasSubstr(text));
  EXPECT_THAT(read("out"), HasSubstr("% of its rating"));
  EXPECT_THAT(read("out"), Not(HasSubstr("thermal rating of the drive")));
  EXPECT_EQ(run("program turn.ngc --task turn.toml --plan profiles").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("turn.toml:10:1: plan profiles does not consider `coulomb_N_m`; leave it out"));
  write("line.ngc", "G1 X90 F6000\nM2\n");
  EXPECT_EQ(run("program line.ngc --task turn.toml").code, 2);
  EXPECT_THAT(read("err"), HasSubstr("line.ngc:1:4: axis X is not among the axes of the task"));
}

/// Whole numbers of the unit, each that of its own position; their jerk is off by four units over T^3 at most.
TEST_F(LoadsCommand, PositionsAreWholeNumbersOfTheUnit) {
  task("force_max_N = 200\n");
  ASSERT_EQ(run("program part.ngc --task load.toml --samples fine.csv").code, 0) << read("err");
  task("force_max_N = 200\n", "[controller]\nposition_unit_um = 0.1\n");
  ASSERT_EQ(run("program part.ngc --task load.toml --samples whole.csv --json r.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("whole numbers of 0.1 um; differences of them read up to 4e+05 mm/s^3 more jerk"));
  ASSERT_EQ(run("verify r.json").code, 0) << read("err");
  std::istringstream fine(read("fine.csv")), whole(read("whole.csv"));
  std::string a, b;
  std::getline(fine, a), std::getline(whole, b);
  EXPECT_EQ(b, "time_s,x_units,y_units");
  std::vector<double> x;
  while (std::getline(fine, a) && std::getline(whole, b)) {
    double t = 0.0, x_mm = 0.0, v = 0.0, y_mm = 0.0, u = 0.0;
    long long x_units = 0, y_units = 0;
    ASSERT_EQ(std::sscanf(a.c_str(), "%lf,%lf,%lf,%lf", &t, &x_mm, &v, &y_mm), 4);
    ASSERT_EQ(std::sscanf(b.c_str(), "%lf,%lld,%lld", &u, &x_units, &y_units), 3);
    EXPECT_EQ(t, u);
    EXPECT_NEAR(static_cast<double>(x_units), 1e4 * x_mm, 0.5 + 1e-5);
    EXPECT_NEAR(static_cast<double>(y_units), 1e4 * y_mm, 0.5 + 1e-5);
    x.push_back(1e-4 * static_cast<double>(x_units));
  }
  ASSERT_GT(x.size(), 1000U);
  double jerk = 0.0;
  for (std::size_t k = 3; k < x.size(); ++k)
    jerk = std::max(jerk, std::abs(x[k] - 3.0 * x[k - 1] + 3.0 * x[k - 2] - x[k - 3]) * 1e9);
  EXPECT_LE(jerk, 400000.0 + 400000.0 + 1.0);
  EXPECT_GT(jerk, 400000.0);
}

}  // namespace
}  // namespace accdec
