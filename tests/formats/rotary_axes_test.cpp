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

}  // namespace
}  // namespace accdec
