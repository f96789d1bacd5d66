#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_writer.hpp>

namespace accdec {
namespace {

using testing::HasSubstr;

std::string complaint(const std::string& json) {
  try {
    parse_task_json(json, "task");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TaskJson, NamesInSiAndKeysOfFilesMakeTheSameTask) {
  const Task si = parse_task_json(
      R"({"sample_period": 0.0007, "axis": [{"acceleration_max": 6, "mass": 34, "damping": 0.3, "force_max": 465}],
          "corner": [{"angle_deg": 80, "heading": 0.5, "feed_in": 0.1, "error_max": 33e-6, "contour_max": 2e-5, "speed_min": 0.001,
                      "delay": 3}],
          "mode": [{"frequency": [30, 34], "residual_max": 0.1}], "program": {"error_max": 1e-5, "contour_max": 2e-5}})",
      "task");
  const Task file = parse_task(
      "sample_period_ms = 0.7\n[[axis]]\nacceleration_max_mm_s2 = 6000\nmass_kg = 34\ndamping_N_s_m = 0.3\n"
      "force_max_N = 465\n[[corner]]\nangle_deg = 80\nheading_deg = 28.64788975654116\nfeed_in_mm_min = 6000\n"
      "error_max_um = 33\ncontour_max_um = 20\nspeed_min_mm_s = 1\ndelay_samples = 3\n[[mode]]\nfrequency_Hz = [30, "
      "34]\n"
      "residual_max = 0.1\n[program]\nerror_max_um = 10\ncontour_max_um = 20\n",
      "task");
  EXPECT_EQ(task_to_toml(si), task_to_toml(file));
}

/// Inside, a degree is a millimetre, so that 1 m is 1000 degrees: torque times angle is force times way.
TEST(TaskJson, RotaryAxesHaveKeysOfTheirOwn) {
  const std::string head = "sample_period_ms = 1\n[[axis]]\nname = \"x\"\n[[axis]]\nname = \"a\"\n";
  const TaskOptions program{.require_corners = false, .axes = 9};
  const Task task = parse_task(
      head +
          "velocity_max_deg_s = 120\nacceleration_max_deg_s2 = 3000\n"
          "jerk_max_deg_s3 = 90000\ninertia_kg_m2 = 0.8\ntorque_max_N_m = 60\n"
          "torque_rms_N_m = 40\ndamping_N_m_s = 0.3\ncoulomb_N_m = 2\n[controller]\nposition_unit_um = 0.1\n",
      "task", program);
  const Axis& a = task.machine.axes[1];
  EXPECT_EQ(a.velocity_max, 0.12);
  EXPECT_EQ(a.acceleration_max, 3.0);
  EXPECT_EQ(a.jerk_max, 90.0);
  const double radians = 1000.0 * std::acos(-1.0) / 180.0;                                     // in 1 m
  EXPECT_NEAR(a.mass * 3.0 * 0.12, 0.8 * (3.0 * radians) * (0.12 * radians), 1e-12 * a.mass);  // W
  EXPECT_NEAR(a.force_max * 0.12, 60.0 * (0.12 * radians), 1e-9);
  EXPECT_NEAR(a.force_rms_max * 0.12, 40.0 * (0.12 * radians), 1e-9);
  EXPECT_NEAR(a.damping * 0.12 * 0.12, 0.3 * (0.12 * radians) * (0.12 * radians), 1e-9);
  EXPECT_NEAR(a.coulomb * 0.12, 2.0 * (0.12 * radians), 1e-9);
  EXPECT_DOUBLE_EQ(task.machine.position_unit, 1e-7);
  EXPECT_TRUE(task.notes.empty());
  const std::string text = task_to_toml(task);
  for (const char* line :
       {"velocity_max_deg_s = 120.0\n", "inertia_kg_m2 = 0.8\n", "torque_max_N_m = 60.0\n", "torque_rms_N_m = 40.0\n",
        "damping_N_m_s = 0.3\n", "coulomb_N_m = 2.0\n", "position_unit_um = 0.1\n"})
    EXPECT_THAT(text, HasSubstr(line));
  EXPECT_EQ(task_to_toml(parse_task(text, "again", program)), text);
  const Task before = parse_task(head + "velocity_max_mm_s = 120\n", "task", program);
  EXPECT_EQ(before.machine.axes[1].velocity_max, 0.12);
  ASSERT_EQ(before.notes.size(), 1U);
  EXPECT_THAT(before.notes.front(), HasSubstr("`velocity_max_deg_s`"));
}

TEST(TaskJson, SaysWhatIsWrong) {
  const std::string corner = R"("corner": [{"angle_deg": 80, "feed_in": 0.1}])";
  EXPECT_EQ(complaint("{\"sample_period\": 0.001, " + corner + "}"), "");
  EXPECT_EQ(complaint("{\"sample_period\": 0.001, \"axis\": [], " + corner + "}"), "");
  EXPECT_THAT(complaint("[]"), HasSubstr("object"));
  EXPECT_THAT(complaint("{"), HasSubstr("not valid JSON"));
  EXPECT_THAT(complaint("{\"sample_period\": 0.001, \"sample_period_ms\": 1, " + corner + "}"),
              HasSubstr("both given"));
  EXPECT_THAT(complaint("{\"sample_period\": null, " + corner + "}"), HasSubstr("null"));
  EXPECT_THAT(complaint("{\"sample_period\": \"short\", " + corner + "}"),
              HasSubstr("`sample_period` must be a number, got \"short\""));
  EXPECT_THAT(complaint("{\"sample_period\": 0.001, \"filter\": {\"a\": {\"b\": {\"c\": {\"d\": {\"e\": 1}}}}}, " +
                        corner + "}"),
              HasSubstr("nested too deeply"));
  EXPECT_THAT(complaint("{\"sample_period\": 0.001,\n \"sample_period\": 1, " + corner + "}"),
              HasSubstr("2:2: this key stands twice"));
}

// Whoever writes names in SI is told the name in SI; whoever writes a unit, the key with its unit.
TEST(TaskJson, SuggestsNamesAsTheyWereGiven) {
  const auto after = [](const std::string& axis, const std::string& corner) {
    return complaint(R"({"sample_period": 0.001, "axis": [{)" + axis + R"(}], "corner": [{"angle": 1, "feed_in": 0.1)" +
                     corner + "}]}");
  };
  EXPECT_THAT(after(R"("jerk": 1)", ""), HasSubstr("unknown key `jerk` in [[axis]] 1; did you mean `jerk_max`?"));
  EXPECT_THAT(after(R"("jerk_max_mm_s2": 1)", ""), HasSubstr("did you mean `jerk_max_mm_s3`?"));
  EXPECT_THAT(after("", R"(, "error": 1)"), HasSubstr("in [[corner]] 1; did you mean `error_max`?"));
  EXPECT_THAT(after("", R"(, "error_max_mm": 1)"), HasSubstr("did you mean `error_max_um`?"));
  EXPECT_THAT(after(R"("travel": 1)", ""), HasSubstr("known here: name, velocity_max, acceleration_max, jerk_max"));
  EXPECT_THAT(complaint(R"({"sample_perod": 0.001})"), HasSubstr("did you mean `sample_period`?"));
  EXPECT_THAT(complaint(R"({"machine": {"power": 1}})"), HasSubstr("in [machine]; did you mean `power_total_max`?"));
}

TEST(TaskJson, OneNumberIsChanged) {
  const Task task = parse_task_json(
      R"({"sample_period": 0.001, "corner": [{"angle_deg": 80, "feed_in": 0.1}, {"angle_deg": 90, "feed_in": 0.1}]})",
      "task");
  const Task one = with_setting(task, "corner.B.error_max", 5e-5),
             same = with_setting(task, "corner.1.error_max_um", 50);
  EXPECT_EQ(task_to_toml(one), task_to_toml(same));
  EXPECT_FALSE(one.corners[0].error_max);
  EXPECT_DOUBLE_EQ(one.corners[1].error_max.value(), 5e-5);
  EXPECT_DOUBLE_EQ(with_setting(task, "sample_period", 5e-4).sample_period, 5e-4);
  EXPECT_THROW(with_setting(task, "corner.C.error_max", 5e-5), std::invalid_argument);
  EXPECT_THROW(with_setting(task, "corner.A.errors_max", 5e-5), std::invalid_argument);
  EXPECT_THROW(with_setting(task, "corner.A.angle_deg", 200), InputError);
}

}  // namespace
}  // namespace accdec
