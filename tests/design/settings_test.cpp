#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "settings_brute_force.hpp"
#include "support/paths.hpp"
#include "support/tasks.hpp"

// Settings of controllers against brute force.

namespace accdec {
namespace {

using accdec::testing::as_brute_force;
using accdec::testing::brute_force;
using accdec::testing::random_task;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void expect_as_brute_force(const Task& task, const std::string& what) {
  const DesignResult result = as_brute_force(task, Status::optimal, Status::infeasible, what);
  if (result.status == Status::optimal) {
    EXPECT_EQ(result.family_bound, result.objective()) << what;
    EXPECT_LE(result.lower_bound.value_or(0.0), result.objective()) << what;
  }
  EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << what;
}

Task settable(std::mt19937& rng, SettingFamily family, std::vector<DelayKind> delays, int corners, int order_max) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task = random_task(rng, corners);
  task.design.order_max = order_max;
  task.design.runs = 0.5 + u(rng);
  ControllerSettings settings;
  settings.families = {family};
  settings.stages.resize(family == SettingFamily::one_pole ? 1 : 2);
  for (SettableStage& stage : settings.stages) {
    stage.length_step = u(rng) < 0.5 ? 0.0 : 3e-3;
    stage.length_max = u(rng) < 0.7 ? 0.0 : 12e-3;
  }
  settings.stages.back() = settings.stages.front();
  if (family == SettingFamily::shaper) settings.shaper = &shaper_list()[rng() % 4];
  settings.time_constant_step = task.sample_period * (1.0 + 3.0 * u(rng));
  settings.alpha_step = 0.3 + u(rng);
  settings.cutoff_step = 3.0 + 4.0 * u(rng);
  settings.delays = std::move(delays);
  task.settings = settings;
  return task;
}

TEST(Settings, AreTheBestOfAllByBruteForce) {
  const std::vector<std::vector<DelayKind>> kinds{{},
                                                  {DelayKind::continuous},
                                                  {DelayKind::exact_stop},
                                                  {DelayKind::in_position},
                                                  {DelayKind::continuous, DelayKind::exact_stop},
                                                  {DelayKind::in_position, DelayKind::exact_stop},
                                                  {DelayKind::dwell, DelayKind::in_position}};
  std::mt19937 rng(26);
  for (int i = 0; i < 28; ++i) {
    const auto& delays = kinds[static_cast<std::size_t>(i) % kinds.size()];
    Task task = settable(rng, SettingFamily::averages, delays, 1 + i % 3, 30);
    task.settings->in_position_by_axis = i % 2 == 1;
    expect_as_brute_force(task, "averages, task " + std::to_string(i));
  }
}

/// A servo lengthens every corner, a smoothing softens the command, and friction takes a part of the force.
TEST(Settings, ForAxesAsTheyAreAreTheBestOfAllByBruteForce) {
  const std::vector<std::vector<DelayKind>> kinds{
      {}, {DelayKind::exact_stop}, {DelayKind::in_position}, {DelayKind::in_position, DelayKind::exact_stop}};
  std::mt19937 rng(28);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int feasible = 0;
  for (int i = 0; i < 16; ++i) {
    const SettingFamily family = i % 6 == 3 ? SettingFamily::gaussian : SettingFamily::averages;
    Task task = settable(rng, family, kinds[static_cast<std::size_t>(i / 4)], 1 + i % 2, 20);
    for (TaskCorner& corner : task.corners) corner.error_max = 4.0 * *corner.error_max, corner.speed_min *= 0.2;
    const double gain = (0.1 + 0.5 * u(rng)) / task.sample_period, feedforward = u(rng);
    for (Axis& axis : task.machine.axes) {
      axis.power_max *= 2.0, axis.regeneration_max *= 2.0, axis.acceleration_max *= 2.0, axis.jerk_max *= 2.0;
      if (i % 3 != 1) axis.servo_gain = gain, axis.velocity_feedforward = feedforward;
      if (i % 3 != 0 && axis.force_max < unlimited) axis.coulomb = 0.1 * axis.force_max;
    }
    if (i % 2 == 0) task.machine.prefilter_taps = {0.25, 0.5, 0.25};
    task.settings->in_position_actual = i % 2 == 0;
    if (i % 3 == 2) task.settings->in_position_latency = 2.0 * task.sample_period;
    if (i % 4 == 0) task.machine.power_total_max = 100.0 + 200.0 * u(rng);
    expect_as_brute_force(task, "axes as they are, task " + std::to_string(i));
    feasible += std::isfinite(brute_force(task)) ? 1 : 0;
  }
  EXPECT_GE(feasible, 6);
}

/// A damped vibration dies away: where one filter leaves too much of it, others with a zero there may leave less.
TEST(Settings, UnderADampedModeAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(29);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int feasible = 0;
  for (int i = 0; i < 60; ++i) {
    Task task = settable(rng, SettingFamily::averages, {}, 1, 24);
    task.settings->stages.front() = task.settings->stages.back() = {};
    // Nothing but the vibration and the tolerance matters.
    for (Axis& axis : task.machine.axes) axis = {.name = axis.name, .acceleration_max = 1000.0};
    task.corners.front().speed_min = 0.0, task.corners.front().error_max = 80e-6;
    Mode mode;
    mode.frequency_low = mode.frequency_high = 30.0 + 50.0 * u(rng);
    mode.damping_low = mode.damping_high = i % 4 == 0 ? 0.0 : 0.02 + 0.2 * u(rng);
    mode.residual_max = 0.05 + 0.25 * u(rng);
    task.machine.modes.push_back(mode);
    expect_as_brute_force(task, "damped mode, task " + std::to_string(i));
    feasible += std::isfinite(brute_force(task)) ? 1 : 0;
  }
  EXPECT_GE(feasible, 15);
}

TEST(Settings, OfPolesAndShapersAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(27);
  for (int i = 0; i < 6; ++i) {
    const std::vector<DelayKind> delays = i % 2 == 0 ? std::vector<DelayKind>{} : std::vector{DelayKind::in_position};
    expect_as_brute_force(settable(rng, SettingFamily::one_pole, delays, 2, 120), "pole " + std::to_string(i));
    Task two = settable(rng, SettingFamily::one_pole, delays, 2, 120);
    two.settings->stages.resize(2, two.settings->stages.front());
    expect_as_brute_force(two, "two poles " + std::to_string(i));
    for (int j = 0; j < 2; ++j)
      expect_as_brute_force(settable(rng, SettingFamily::shaper, delays, 1, 18), "shaper " + std::to_string(i));
  }
}

/// A control that interpolates has impulses between samples, a mode asks for them.
TEST(Settings, OfShapersBetweenSamplesAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(30);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int feasible = 0, between = 0;
  for (int i = 0; i < 24; ++i) {
    const std::vector<DelayKind> delays = i % 2 == 0 ? std::vector<DelayKind>{} : std::vector{DelayKind::in_position};
    Task task = settable(rng, SettingFamily::shaper, delays, 1, 18);
    task.settings->shaper = &shaper_list()[static_cast<std::size_t>(i) % 4];
    task.settings->shaper_frequency_step = 2.0 + 20.0 * u(rng);
    for (Axis& axis : task.machine.axes) axis = {.name = axis.name, .acceleration_max = 20.0 + 1000.0 * u(rng)};
    task.corners.front().speed_min = 0.0;
    const double f = (0.05 + 0.25 * u(rng)) / task.sample_period, z = i % 3 == 0 ? 0.05 : 0.0;
    Mode mode;
    mode.frequency_low = mode.frequency_high = f, mode.damping_low = mode.damping_high = z;
    mode.residual_max = 0.02 + 0.2 * u(rng);
    if (i % 4 != 1) task.machine.modes.push_back(mode);
    expect_as_brute_force(task, "shaper between samples, task " + std::to_string(i));
    if (!std::isfinite(brute_force(task))) continue;
    ++feasible;
    between += design_task(task).settings->filter.whole_pairs() ? 0 : 1;
  }
  EXPECT_GE(feasible, 12);
  EXPECT_GE(between, 6);
}

TEST(Settings, OfLengthsAndNumbersAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(28);
  int found = 0;
  for (int i = 0; i < 27; ++i) {
    constexpr SettingFamily families[] = {SettingFamily::exponential, SettingFamily::gaussian,
                                          SettingFamily::windowed_sinc};
    const std::vector<DelayKind> delays = i % 2 == 0 ? std::vector<DelayKind>{} : std::vector{DelayKind::in_position};
    Task task = settable(rng, families[i % 3], delays, 1 + i % 2, 40);
    for (SettableStage& stage : task.settings->stages) stage.length_max = 0.0;
    // Few of these families hold a jerk limit within so many taps, and no exponential.
    if (i % 3 == 0 || i % 4 != 3) {
      for (Axis& axis : task.machine.axes) axis.jerk_max = unlimited;
    }
    expect_as_brute_force(task, "family " + std::to_string(i % 3) + ", task " + std::to_string(i));
    found += std::isfinite(brute_force(task)) ? 1 : 0;
  }
  EXPECT_GE(found, 6);
}

Task corner_task(const std::string& more) {
  return parse_task(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
      "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n" +
          more,
      "task");
}

// From rest at full force, m dv/dt + c v = F reaches v after tau ln(1 / (1 - c v / F)) with tau = m / c: an
// exponential. On the samples the recursion counts the taps, and tau in whole milliseconds is near enough.
TEST(Settings, OfAForceLimitedStartAreTheClosedForm) {
  const DesignResult result = design_task(parse_task(
      "sample_period_ms = 1\n[design]\nfamily = \"exponential\"\n[[axis]]\nmass_kg = 34\ndamping_N_s_m = 840\n"
      "force_max_N = 465\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 30000\nerror_max_um = 0\n",
      "task"));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const double inertia = 34.0 / 1e-3, speed = 0.5;
  double gone = 0.0;
  int taps = 0;
  while (gone < 1.0 - 1e-12) gone = (465.0 + inertia * speed * gone) / ((inertia + 840.0) * speed), ++taps;
  EXPECT_EQ(result.filter->order() + 1, taps);
  EXPECT_THAT(settings_in_words(*result.settings),
              HasSubstr("an exponential of " + std::to_string(taps) + " ms, time "));
  EXPECT_NEAR(result.settings->values.back().value, 1e3 * 34.0 / 840.0, 2.0);
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
}

TEST(Settings, OfNumbersAreNotForged) {
  const DesignResult result = design_task(
      corner_task("[design]\nfamily = [\"gaussian\", \"windowed-sinc\"]\nalpha_step = 0.25\ncutoff_step_Hz = 2\n"));
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(result_to_json(parse_result(result_to_json(result), "result")), result_to_json(result));
  EXPECT_TRUE(verify_result(result).accepted);
  DesignResult forged = result;
  forged.settings->values.back().value *= 1.01;
  EXPECT_FALSE(verify_result(forged).accepted);
  forged = result;
  forged.task.settings->alpha_step = 0.37, forged.task.settings->cutoff_step = 3.1;
  EXPECT_FALSE(verify_result(forged).accepted);
}

// At 0.1 m/s, 6 m/s^2 and 500 m/s^3, 17 and 12 ms hold the limits of a start: L M >= 200. At 95 degrees x goes on at
// 0.087 of its speed. The last step of one leg and the first of the other add up to 1.087/(L M), behind N samples and N
// + 1. So L M >= 217.4, which no lengths of sum 29 have. 17 is the least that holds the acceleration.
TEST(Settings, OfExactStopsAreTheClosedForm) {
  const DesignResult result =
      design_task(corner_task("[design]\nfamily = \"averages\"\n[controller]\ndelays = [\"exact-stop\"]\n"));
  ASSERT_EQ(result.status, Status::optimal);
  EXPECT_EQ(settings_in_words(*result.settings), "averages of 17 ms and 13 ms");
  EXPECT_NEAR(result.cycle_time, 57e-3, 1e-12);  // N = 28, d = 28
}

TEST(Settings, AnswerFirst) {
  const DesignResult result = design_task(corner_task(
      "[design]\nfamily = \"averages\"\n[controller]\ndelays = \"in-position\"\n[filter]\nkind = \"averages\"\n"
      "lengths = [20, 20]\n"));
  const std::string answer = settings_answer(result);
  EXPECT_THAT(answer, ::testing::StartsWith("Set these: averages of "));
  EXPECT_THAT(answer, HasSubstr("in-position width "));
  EXPECT_THAT(answer, HasSubstr("proved best for this family. Free taps with delays of any number of samples "
                                "would take 42 ms"));
  EXPECT_THAT(answer, HasSubstr("retuning saves "));
  ASSERT_TRUE(result.savings);
  EXPECT_GT(result.savings->total, 0.0);
  ASSERT_TRUE(result.settings->width);
  EXPECT_LT(result.settings->width->low, result.settings->width->high);
}

TEST(Settings, SavingsAreFoundAgain) {
  DesignResult result = design_task(corner_task(
      "[design]\nfamily = \"averages\"\n[controller]\ndelays = \"exact-stop\"\n[filter]\nkind = \"averages\"\n"
      "lengths = [20, 20]\n"));
  ASSERT_TRUE(result.savings);
  EXPECT_NEAR(result.savings->today, 77e-3, 1e-12);  // N = 38, d = 38
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  const Savings saved = *result.savings;
  result.savings->today += 1e-3, result.savings->total += 1e-3;
  EXPECT_THAT(verify_result(result).reasons, ::testing::Contains(HasSubstr("savings.today_s is recorded as 0.078")));
  result.savings.reset();
  EXPECT_THAT(verify_result(result).reasons, ::testing::Contains(HasSubstr("today's filter the task takes 0.077 s")));
  result.savings = saved;
  result.savings->today -= 1e-3, result.savings->total -= 1e-3;
  EXPECT_THAT(verify_result(result).reasons, ::testing::Contains(HasSubstr("savings.today_s is recorded as 0.076")));
  result.savings = saved, result.savings->by_retuning = saved.total;
  EXPECT_FALSE(verify_result(result).accepted);
}

TEST(Settings, SurviveFiles) {
  const Task task = corner_task(
      "[design]\nfamily = [\"averages\", \"shaper\"]\nstages = 2\nshaper = \"zvd\"\nlength_step_ms = [1, 2]\n"
      "length_max_ms = 30\n[controller]\ndelays = [\"in-position\", \"exact-stop\"]\n");
  EXPECT_EQ(task_to_toml(parse_task(task_to_toml(task), "again")), task_to_toml(task));
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const std::string text = result_to_json(result);
  const DesignResult again = parse_result(text, "result");
  EXPECT_EQ(result_to_json(again), text);
  EXPECT_THAT(verify_result(again).reasons, IsEmpty());
  // The sentence for people is in the file, and is that of its numbers.
  const auto json = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(json["settings"]["answer"].get<std::string>() + "\n", settings_answer(result));
  auto forged = json;
  forged["settings"]["answer"] = "Set these: averages of 1 ms.";
  EXPECT_THROW(parse_result(forged.dump(), "result"), InputError);
  forged["settings"].erase("answer");
  EXPECT_THROW(parse_result(forged.dump(), "result"), InputError);
  // The proof about free taps inside names what it is, as the one around it does.
  for (const std::string name : {"\"branch and bound\"", "\"accdec.certificate/1\""}) {
    std::string bad = text;
    const std::size_t at = bad.rfind(name);
    ASSERT_NE(at, std::string::npos);
    bad.replace(at, name.size(), "\"\"");
    EXPECT_THROW(parse_result(bad, "result"), InputError) << name;
  }
}

/// 17 ms are 2.8333 10^-4 minutes. Nine decimals would be wrong by a part of 10^-6.
TEST(Settings, OfLargeUnitsKeepTheirDigits) {
  const DesignResult result = design_task(parse_task(
      "sample_period_ms = 1\n[design]\nfamily = \"averages\"\nstages = 1\n[controller]\nparameters = [\"P\"]\n"
      "parameter_units = [\"min\"]\nparameter_unit_ms = [60000]\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
      "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n",
      "task"));
  ASSERT_TRUE(result.settings) << result.message;
  EXPECT_NEAR(result.settings->values[0].value * 60.0 / 17e-3, 1.0, 2e-9);
  EXPECT_THAT(settings_answer(result), HasSubstr("P = 0.000283333333 min"));
  EXPECT_THAT(verify_result(parse_result(result_to_json(result), "result")).reasons, IsEmpty());
}

TEST(Settings, SayWhichWidthNoControlHolds) {
  EXPECT_EQ(width_in_words({1e-5, 3e-5}), "in-position width 0.02 mm (0.01 to 0.03)");
  // A width that is printed may be entered: no end is rounded outwards.
  EXPECT_EQ(width_in_words({1.29412e-4, 1.37257e-4}), "in-position width 0.1333 mm (0.1295 to 0.1372)");
  EXPECT_THAT(width_in_words({1.234561e-4, 1.234589e-4}), HasSubstr("(0.123457 to 0.123458)"));
  EXPECT_THAT(width_in_words({0.0, 3.2e-11}), HasSubstr("no control holds so small a width"));
  EXPECT_THAT(width_in_words({2e-8, 3e-8}), HasSubstr("few controls hold a width below 0.001 mm"));
  EXPECT_EQ(width_in_words({1e-6, 2e-6}).find("few controls"), std::string::npos);
}

TEST(Settings, AreNotForged) {
  const DesignResult result =
      design_task(corner_task("[design]\nfamily = \"averages\"\n[controller]\ndelays = \"in-position\"\n"));
  ASSERT_EQ(result.status, Status::optimal);
  const auto refused = [&](const auto& forge) {
    DesignResult forged = result;
    forge(forged);
    return !verify_result(forged).accepted;
  };
  EXPECT_FALSE(refused([](DesignResult&) {}));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->values[0].value += 1.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->values[0].value += 0.4; })) << "rounded, it is the same";
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width->high *= 2.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width->low *= 1.01; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width->high *= 0.99; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->delays[0] = DelayKind::continuous; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.family_bound.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { *r.free_taps *= 0.5; }));
  EXPECT_TRUE(refused([](DesignResult& r) { *r.lower_bound *= 1.02, r.gap = 1.0 - *r.lower_bound / r.objective(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.free_taps = r.objective() - 0.3 * r.task.sample_period; }));
  for (const double more : {1.2, 1e300}) {
    EXPECT_TRUE(refused([&](DesignResult& r) {
      Certificate larger = *r.certificate;
      *std::get<proof::FamilyEnumeration>(larger.proof).bound_samples *= more;
      r.certificate = std::make_shared<Certificate>(std::move(larger));
    })) << "the members were refuted up to the bound, and no further";
  }
  EXPECT_TRUE(refused([](DesignResult& r) {
    Certificate none = *r.certificate;
    std::get<proof::FamilyEnumeration>(none.proof).bound_samples.reset();
    r.certificate = std::make_shared<Certificate>(std::move(none));
  })) << "that no member holds";
  EXPECT_TRUE(refused([](DesignResult& r) { r.task.settings->families.push_back(SettingFamily::taps); }))
      << "free taps are shorter";
  // A controller of longer steps does not have this filter.
  EXPECT_TRUE(refused([](DesignResult& r) { r.task.settings->stages[0].length_step = 5e-3; }));
  // Two stages that differ have a length each.
  DesignResult capped =
      design_task(corner_task("[design]\nfamily = \"averages\"\nstages = 2\nlength_max_ms = [60, 9]\n"));
  ASSERT_EQ(capped.status, Status::optimal);
  ASSERT_GT(capped.settings->values[0].value, 9.0);
  EXPECT_TRUE(verify_result(capped).accepted);
  std::swap(capped.settings->values[0].value, capped.settings->values[1].value);
  EXPECT_FALSE(verify_result(capped).accepted);
  // A slower member, honestly recorded, is not the best.
  EXPECT_TRUE(refused([](DesignResult& r) {
    Task slower = r.task;
    slower.settings->stages[0].length_step = slower.settings->stages[1].length_step = 8e-3;
    const Task asked = r.task;
    r = design_task(slower);
    r.task = asked;
  }));
}

}  // namespace
}  // namespace accdec
