#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/design.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

// Axes that turn, in files and by their names in SI: rad, kg m^2 and N m. Inside, a degree is a millimetre.

namespace accdec {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::ordered_json;

/// Axes a, b and c are in rad and N m in files, and a degree counts as a millimetre inside.
TEST(RotaryAxes, AreInRadiansInResults) {
  const DesignResult result = evaluate_task(parse_task(
      "sample_period_ms = 1\n[filter]\nkind = \"averages\"\nlengths = [40, 20]\n[[axis]]\nname = \"x\"\n"
      "acceleration_max_mm_s2 = 6000\n[[axis]]\nname = \"a\"\nvelocity_max_deg_s = 180\n"
      "acceleration_max_deg_s2 = 3000\ninertia_kg_m2 = 0.8\ntorque_max_N_m = 60\npower_max_W = 900\n"
      "[[corner]]\ndirection_in = [1, 0]\ndirection_out = [0, 1]\nfeed_in_mm_min = 6000\ndelay_samples = 20\n"
      "[[mode]]\nfrequency_Hz = 30\naxis = \"a\"\nresidual_max_um = 90000\n",
      "t", {.response = Considered::all}));
  const Json json = Json::parse(result_to_json(result));
  const double pi = std::acos(-1.0), rad = pi / 180.0;
  // 100 deg/s within 40 ms
  const std::map<std::string, std::pair<double, double>> wanted{{"velocity", {100.0 * rad, pi}},
                                                                {"acceleration", {2500.0 * rad, 3000.0 * rad}},
                                                                {"force", {0.8 * 2500.0 * rad, 60.0}}};
  std::size_t seen = 0;
  for (const Json& limit : json["limits"]) {
    const auto found = wanted.find(limit["kind"]);
    if (limit["axis"] != "a" || found == wanted.end()) continue;
    ++seen;
    EXPECT_NEAR(limit["value"].get<double>(), found->second.first, 1e-9) << limit;
    EXPECT_NEAR(limit["bound"].get<double>(), found->second.second, 1e-12) << limit;
  }
  EXPECT_EQ(seen, wanted.size());
  EXPECT_EQ(json["limits"].back()["kind"], "residual");
  EXPECT_NEAR(json["limits"].back()["bound"].get<double>(), 90.0 * rad, 1e-12);
  const DesignResult again = parse_result(json.dump(), "r");
  for (std::size_t i = 0; i < result.limits.size(); ++i)
    EXPECT_NEAR(again.limits[i].value, result.limits[i].value, 1e-14 * result.limits[i].value);
  const auto reasons = [](const Json& text) {
    return fmt::format("{}", fmt::join(verify_result(parse_result(text.dump(), "r")).reasons, "; "));
  };
  EXPECT_EQ(reasons(json), "");
  Json before = json;
  for (std::size_t i = 0; i < result.limits.size(); ++i)
    before["limits"][i]["value"] = result.limits[i].value, before["limits"][i]["bound"] = result.limits[i].bound;
  EXPECT_THAT(reasons(before), StartsWith("limits of axis a are in metres and newtons, a degree for a millimetre"));
  EXPECT_THAT(reasons(before), HasSubstr("they must be in rad and N m"));
}

/// The names of SI are in rad, kg m^2 and N m there; a name that only linear axes have is refused.
TEST(RotaryAxes, AreInRadiansByNamesOfSI) {
  const TaskOptions program{.require_corners = false, .axes = 9};
  const auto parsed = [&](const std::string& axes) {
    return parse_task_json(R"({"sample_period": 1e-3, "axis": [)" + axes + "]}", "task", program);
  };
  const auto message = [&](const std::string& axes) -> std::string {
    try {
      parsed(axes);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const double pi = std::acos(-1.0);
  const std::string x = R"({"name": "x", "velocity_max": 0.3}, )";
  const Task task = parsed(x + R"({"name": "a", "velocity_max": 3.141592653589793, "acceleration_max": 10,
      "jerk_max": 100, "inertia": 0.8, "damping": 0.3, "coulomb": 2, "torque_max": 60, "torque_rms": 40})");
  const Axis& a = task.machine.axes[1];
  EXPECT_EQ(task.machine.axes[0].velocity_max, 0.3);
  EXPECT_EQ(a.velocity_max, 0.18);  // 180 deg/s
  EXPECT_NEAR(a.acceleration_max, 10.0 * 0.18 / pi, 1e-15);
  EXPECT_NEAR(a.jerk_max, 100.0 * 0.18 / pi, 1e-14);
  const std::string text = task_to_toml(task);
  for (const char* line : {"velocity_max_deg_s = 180.0\n", "inertia_kg_m2 = 0.8\n", "damping_N_m_s = 0.3\n",
                           "coulomb_N_m = 2.0\n", "torque_max_N_m = 60.0\n", "torque_rms_N_m = 40.0\n"})
    EXPECT_THAT(text, HasSubstr(line));
  // The fourth axis without a name is a.
  EXPECT_EQ(parsed(R"({}, {}, {}, {"velocity_max": 3.141592653589793})").machine.axes[3].velocity_max, 0.18);
  EXPECT_THAT(message(x + R"({"name": "a", "mass": 3})"), HasSubstr("axis a has `inertia`"));
  EXPECT_THAT(message(x + R"({"name": "a", "force_max": 3})"), HasSubstr("axis a has `torque_max`"));
  EXPECT_THAT(message(x + R"({"name": "y", "inertia": 3})"), HasSubstr("`inertia` is for rotary axes"));
  EXPECT_THAT(message(x + R"({"name": "a", "velocity_max_rad_s": 3})"), HasSubstr("did you mean `velocity_max`?"));
  EXPECT_THAT(message(x + R"({"name": "a", "velocity_max": -1})"), HasSubstr("0 < velocity_max <= 17453.29"));
  EXPECT_EQ(with_setting(task, "axis.a.velocity_max", pi / 2).machine.axes[1].velocity_max, 0.09);
  const Task both = with_setting(task, "axis.*.velocity_max", 0.2);
  EXPECT_EQ(both.machine.axes[0].velocity_max, 0.2);
  EXPECT_NEAR(both.machine.axes[1].velocity_max, 0.2 * 0.18 / pi, 1e-16);
  EXPECT_THROW(with_setting(task, "axis.*.mass", 0.2), InputError);
}

/// A degree counts as a millimetre. By the work over a degree, 1 N m is then 1000 pi/180 N. Both curves are read, one
/// is written.
TEST(RotaryAxes, CurvesAreInDegreesAndNewtonMetres) {
  const auto with = [](const std::string& curve, const std::string& name = "b") {
    return parse_task(
        "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 19\n[[axis]]\nname = \"x\"\n[[axis]]\nname = \"" +
            name + "\"\ninertia_kg_m2 = 0.8\ntorque_max_N_m = 50\n" + curve +
            "\n[[corner]]\nname = \"A\"\nfeed_in_mm_min = 6000\ndelay_samples = 0\n"
            "direction_in = [0, 1]\ndirection_out = [0, 1]\n",
        "t", {.response = Considered::all});
  };
  const Task task = with("torque_speed_N_m = [[0, 140], [200, 100]]");
  const Axis& b = task.machine.axes[1];
  const double newtons = 1000.0 * std::acos(-1.0) / 180.0;
  ASSERT_EQ(b.force_speed.size(), 2U);
  EXPECT_NEAR(b.force_speed[1].speed, 0.2, 1e-15);
  EXPECT_NEAR(b.force_speed[1].force, 100.0 * newtons, 1e-10);
  EXPECT_NEAR(b.force_speed_max, 140.0 * newtons, 1e-10);
  EXPECT_THAT(task_to_toml(task), HasSubstr("torque_speed_N_m = [[0.0,140.0],[200.0,100.0]]"));
  const Task before = with(fmt::format("force_speed_N = [[0, {:.15g}], [200, {:.15g}]]", 140 * newtons, 100 * newtons));
  EXPECT_NEAR(before.machine.axes[1].force_speed_max, b.force_speed_max, 1e-10);
  EXPECT_THAT(task_to_toml(before), HasSubstr("torque_speed_N_m = "));
  EXPECT_THAT(fmt::format("{}", fmt::join(before.notes, "; ")), HasSubstr("`torque_speed_N_m` says so"));
  // 100 deg/s within 20 ms are 5000 deg/s^2, at the end at 100 deg/s, where the curve has 120 N m.
  const DesignResult result = evaluate_task(task);
  const double torque = 0.8 * 5000.0 * std::acos(-1.0) / 180.0;
  EXPECT_THAT(result_text(result),
              HasSubstr(fmt::format("64.15  {:.6g}    120  N m   A start, k = 20, at 100 deg/s", torque)));
  EXPECT_THAT(result.verification.worst, StartsWith("torque b: 139.6 %"));
  const auto refusal = [&](const std::string& curve, const std::string& name) -> std::string {
    try {
      with(curve, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("torque_speed_N_m = [[0, 1], [9, 0]]\nforce_speed_N = [[0, 1], [9, 0]]", "b"),
              HasSubstr("`torque_speed_N_m` and `force_speed_N` are both given"));
  EXPECT_THAT(refusal("torque_speed_N_m = [[0, 40], [90, 50]]", "b"),
              HasSubstr("`torque_speed_N_m`: forces must not rise"));
  EXPECT_THAT(refusal("torque_speed_N_m = [[0, 40], [90, 20], [180, 10]]", "b"),
              HasSubstr("behind 90 deg/s than before it"));
}

}  // namespace
}  // namespace accdec
