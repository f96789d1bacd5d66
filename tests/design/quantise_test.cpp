#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/design/quantise.hpp>
#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;

/// One axis, 100 mm/s through a right angle along the axes, without an error bound: delays are 0.
Task straight_task(int bits, double acceleration, double jerk) {
  Task task;
  task.sample_period = 1e-3;
  task.design.coefficient_bits = bits;
  task.machine.axes = {Axis{.name = "x", .acceleration_max = acceleration, .jerk_max = jerk},
                       Axis{.name = "y", .acceleration_max = acceleration, .jerk_max = jerk}};
  task.corners.emplace_back("A", PlanarLegs{0.5 * M_PI, 0.0, Turn::left}, 0.1, 0.1);
  return task;
}

void expect_whole(const DesignResult& result, int bits) {
  ASSERT_TRUE(result.has_design()) << result.message;
  ASSERT_TRUE(result.quantisation);
  const auto& c = result.quantisation->coefficients;
  EXPECT_EQ(std::accumulate(c.begin(), c.end(), std::int64_t{0}), std::int64_t{1} << bits);
  ASSERT_EQ(c.size(), result.filter->taps().size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_GE(c[i], 0);
    EXPECT_EQ(result.filter->taps()[i], std::ldexp(static_cast<double>(c[i]), -bits));
  }
  const ResultCheck check = verify_result(result);
  EXPECT_TRUE(check.accepted) << ::testing::PrintToString(check.reasons);
}

// A tap must not exceed a T/v = 0.05, which is 12.8 units of 8 bits, and so 12. 256 units need 22 such taps; free taps
// need 20.
TEST(Quantise, AccelerationAsCounted) {
  const DesignResult result = design_task(straight_task(8, 5.0, unlimited));
  expect_whole(result, 8);
  EXPECT_EQ(result.filter->order() + 1, 22);
  EXPECT_NEAR(result.quantisation->unquantised, 0.020, 1e-12);
  EXPECT_EQ(
      settings_answer(result),
      "Set these: the 22 taps in whole numbers over 2^8 that `accdec export` writes; delay at corner A (0 ms). "
      "22 ms a corner, the fastest whole numbers found, not proved best. Free taps would take 20 ms (9.1 % less).\n");
}

// A step between two taps must not exceed j T^2/v = 0.005, which is 1.28 units of 8 bits, and so 1. Ramps up and down
// by one unit over M taps have floor((M + 1)^2/4) units: 256 with 31 taps, where 1, 2 .. 16 .. 2, 1 is the only filter.
// Free taps need (M + 1)^2/4 >= 200: 28.
TEST(Quantise, JerkAsCounted) {
  const DesignResult result = design_task(straight_task(8, unlimited, 500.0));
  expect_whole(result, 8);
  ASSERT_EQ(result.filter->order() + 1, 31);
  for (int i = 0; i <= 30; ++i)
    EXPECT_EQ(result.quantisation->coefficients[static_cast<std::size_t>(i)], std::min(i + 1, 31 - i));
  EXPECT_NEAR(result.quantisation->unquantised, 0.028, 1e-12);
  EXPECT_EQ(result.status, Status::feasible) << "free taps are faster, so nothing is proved of whole ones";
}

/// tests/nightly/whole-coefficients has all shipped tasks, those of several weighted corners too.
TEST(Quantise, SixteenBitsLoseAtMostASampleOrAPercent) {
  for (const char* name : {"acceleration-jerk", "exact-stop", "flat-angle", "force-friction", "minimum-speed", "power",
                           "regeneration", "sharp-angle", "six-axes", "unequal-feeds", "vibration-band"}) {
    SCOPED_TRACE(name);
    Task task = read_task(test_support::source_folder() + "/problems/corner/" + name + ".toml");
    task.design.coefficient_bits = 16;
    const DesignResult result = design_task(task);
    expect_whole(result, 16);
    if (!result.has_design()) continue;
    const double lost = result.objective() - result.quantisation->unquantised;
    EXPECT_LE(lost, std::max(1.001 * task.sample_period, 0.01 * result.quantisation->unquantised));
  }
}

/// The shipped corner for a control of free taps that has one kind of delay.
Task task_of_kind(DelayKind kind, int bits) {
  Task task = read_task(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
  ControllerSettings control;
  control.families = {SettingFamily::taps};
  control.delays = {kind};
  task.settings = control;
  task.design.coefficient_bits = bits;
  if (kind == DelayKind::continuous) task.corners[0].error_max.reset();
  return task;
}

TEST(Quantise, WithTheDelaysThatAControlHas) {
  for (const DelayKind kind : {DelayKind::continuous, DelayKind::exact_stop, DelayKind::in_position, DelayKind::dwell,
                               DelayKind::timed_axis}) {
    SCOPED_TRACE(to_string(kind));
    const DesignResult result = design_task(task_of_kind(kind, 16));
    expect_whole(result, 16);
    const double free = design_task(task_of_kind(kind, 0)).objective();
    EXPECT_DOUBLE_EQ(result.quantisation->unquantised, free);
    EXPECT_LE(result.objective(), free + 1.001e-3) << "a sample";
  }
}

TEST(Quantise, OtherFamiliesAndCornerFeedsAreRefused) {
  const auto refusal = [](const std::string& more) -> std::string {
    try {
      parse_task("sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\n[design]\ncoefficient_bits = 16\n" +
                     more + "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n",
                 "task");
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal(""), "");
  EXPECT_EQ(refusal("[controller]\ndelays = \"exact-stop\"\n"), "");
  EXPECT_THAT(refusal("family = [\"taps\", \"averages\"]\n"), HasSubstr("task:5:20"));
  EXPECT_THAT(refusal("family = [\"taps\", \"averages\"]\n"), HasSubstr("leave out other families"));
  EXPECT_THAT(refusal("[controller]\ndelays = [\"dwell\", \"corner-feed\"]\n"), HasSubstr("`corner-feed`"));
}

/// Averages of 32 and 8 taps have the coefficients 1, 2 .. 8 .. 8 .. 2, 1, whose sum is 256: they need no rounding.
/// With 8 bits the jerk of the y axis holds only if few steps of both legs meet, which rounded optima do not manage.
TEST(Quantise, FewBitsAreNoSlowerThanAveragesOfPowersOfTwo) {
  Task task = read_task(test_support::source_folder() + "/problems/corner/six-axes.toml");
  Task given = task;
  given.filter = FilterSpec{.kind = Shape::averages, .order = 38, .lengths = {32, 8}};
  const DesignResult averages = design_task(given);
  ASSERT_TRUE(averages.has_design());
  task.design.coefficient_bits = 8;
  const DesignResult result = design_task(task);
  expect_whole(result, 8);
  EXPECT_LE(result.objective(), averages.objective() * (1.0 + 1e-12));
}

/// Zeros at the ends of taps only take time.
TEST(Quantise, NoCoefficientAtAnEndIsZero) {
  for (const int bits : {8, 10}) {
    Task task = read_task(test_support::source_folder() + "/problems/machine/three-corners.toml");
    task.design.coefficient_bits = bits;
    DesignOptions options;
    options.time_limit = 5.0;
    const DesignResult result = design_task(task, options);
    if (!result.has_design()) continue;
    EXPECT_GT(result.quantisation->coefficients.front(), 0) << bits;
    EXPECT_GT(result.quantisation->coefficients.back(), 0) << bits;
  }
}

TEST(Quantise, SymmetricTapsStaySymmetric) {
  Task task = read_task(test_support::source_folder() + "/problems/corner/acceleration-jerk.toml");
  task.design.symmetric = true;
  task.design.coefficient_bits = 12;
  const DesignResult result = design_task(task);
  expect_whole(result, 12);
  const auto& c = result.quantisation->coefficients;
  EXPECT_TRUE(std::equal(c.begin(), c.end(), c.rbegin()));
}

TEST(Quantise, RoundingKeepsTheSumAndTheLimits) {
  Task task = straight_task(0, 5.0, unlimited);
  const auto rounded = round_under_limits(task, boxcar(21), {0}, 8);  // 256/22 = 11.6 units
  ASSERT_TRUE(rounded);
  EXPECT_EQ(std::accumulate(rounded->begin(), rounded->end(), std::int64_t{0}), 256);
  EXPECT_LE(*std::max_element(rounded->begin(), rounded->end()), 12);
  EXPECT_FALSE(round_under_limits(task, boxcar(20), {0}, 8)) << "21 taps of at most 12 units have no 256";
}

TEST(Quantise, ExactCoefficients) {
  EXPECT_EQ(exact_coefficients(boxcar(15), 8), Coefficients(16, 16));
  EXPECT_FALSE(exact_coefficients(boxcar(9), 31));
}

TEST(Quantise, VerifierRefusesForgedCoefficients) {
  DesignResult result = design_task(straight_task(8, 5.0, unlimited));
  ASSERT_TRUE(result.has_design());
  const auto refused = [](const DesignResult& forged) { return !verify_result(forged).accepted; };
  DesignResult forged = result;
  ++forged.quantisation->coefficients[3], --forged.quantisation->coefficients[4];
  EXPECT_TRUE(refused(forged));
  forged = result;
  forged.quantisation->unquantised = 1.0;
  EXPECT_TRUE(refused(forged));
  forged = result;
  forged.quantisation.reset();
  EXPECT_TRUE(refused(forged));
  // Taps that hold all limits, but are no whole numbers.
  DesignResult free = assess(result.task, boxcar(21), {0}, false);
  free.quantisation = result.quantisation;
  EXPECT_TRUE(refused(free));
}

// The first tap has one unit or more. At 0.1 ms, 8 bits and 100 mm/s this is a jerk of 0.1/256/1e-8 = 39062.5 m/s^3.
// The limit, 500 m/s^3, is 1/20000 of v/T^2, which needs 15 bits.
TEST(Quantise, TooFewBitsAreSaid) {
  Task task = straight_task(8, unlimited, 500.0);
  task.sample_period = 1e-4;
  const DesignResult result = design_task(task);
  EXPECT_FALSE(result.has_design());
  EXPECT_FALSE(result.filter);
  EXPECT_THAT(result.message, HasSubstr("jerk on axis x is 3.90625e+07 mm/s^3"));
  EXPECT_THAT(result.message, HasSubstr("at least 15 bits"));
  task.design.coefficient_bits = 16;
  expect_whole(design_task(task), 16);
}

}  // namespace
}  // namespace accdec
