#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/machine/response.hpp>

namespace accdec {
namespace {

using ::testing::Each;
using ::testing::Ge;
using ::testing::HasSubstr;

Machine with_servo(double gain, double feedforward) {
  Machine machine;
  machine.axes.resize(2);
  for (Axis& axis : machine.axes) axis.servo_gain = gain, axis.velocity_feedforward = feedforward;
  return machine;
}

/// The following error at constant feed is the response's mean delay times the feed: (1 - g)/Kv.
TEST(Response, MeanDelayIsTheFollowingErrorOfTheGain) {
  for (const double gain : {1.0, 20.0, 200.0, 5000.0}) {
    for (const double feedforward : {0.0, 0.5, 0.99, 1.0}) {
      const Response response(with_servo(gain, feedforward), 1e-3);
      const std::vector<double> taps = response.servo(1);
      EXPECT_THAT(taps, Each(Ge(0.0)));
      EXPECT_NEAR(std::accumulate(taps.begin(), taps.end(), 0.0), 1.0, 1e-13);
      double mean = 0.0;
      for (std::size_t k = 0; k < taps.size(); ++k) mean += static_cast<double>(k) * taps[k];
      // The rest that is cut off is below 1e-12, at most some thousand samples late.
      EXPECT_NEAR(mean * 1e-3, (1.0 - feedforward) / gain, 1e-10 * (1.0 + 1.0 / gain)) << gain << ' ' << feedforward;
    }
  }
}

TEST(Response, FullFeedforwardLeavesTheCommandAsItIs) {
  const Filter filter({0.25, 0.5, 0.25});
  const Machine machine = with_servo(200.0, 1.0);
  const FilterBehind behind(filter, machine, 1e-3);
  EXPECT_EQ(behind.motion().order(), filter.order());
  for (int i = 0; i <= 2; ++i) EXPECT_DOUBLE_EQ(behind.motion().tap(i), filter.tap(i));
}

TEST(Response, SmoothingAndServoAreConvolved) {
  Machine machine;
  machine.axes.resize(1);
  machine.prefilter_taps = {0.5, 0.5};
  machine.axes[0].response_taps = {0.75, 0.25};
  const Filter filter({1.0, 3.0});
  const FilterBehind behind(filter, machine, 1e-3);
  EXPECT_EQ(behind.command().order(), 2);
  EXPECT_EQ(behind.longer(), 2);
  // (1 + 3 z)/4 (1 + z)/2 (3 + z)/4
  const double expected[] = {3.0 / 32, 13.0 / 32, 13.0 / 32, 3.0 / 32};
  for (int i = 0; i <= 3; ++i) EXPECT_NEAR(behind.motion().tap(i), expected[i], 1e-15);
}

TEST(Response, IsOneOfAllAxesOrNot) {
  Machine machine = with_servo(200.0, 0.0);
  EXPECT_TRUE(Response(machine, 1e-3).common());
  machine.axes[1].servo_gain = 100.0;
  EXPECT_FALSE(Response(machine, 1e-3).common());
  machine.axes[1] = machine.axes[0] = Axis{};
  EXPECT_TRUE(Response(machine, 1e-3).ideal());
  for (Axis& axis : machine.axes) axis.response_taps = {1.25, -0.25};
  EXPECT_FALSE(Response(machine, 1e-3).common());
  EXPECT_THROW(Response(machine, 1e-3).motion(Filter({1.0})), std::logic_error);
}

TEST(Response, RefusesWhatIsNone) {
  EXPECT_THROW(Response(with_servo(-1.0, 0.0), 1e-3), std::invalid_argument);
  EXPECT_THROW(Response(with_servo(200.0, 1.5), 1e-3), std::invalid_argument);
  EXPECT_THROW(Response(with_servo(std::nan(""), 0.0), 1e-3), std::invalid_argument);
  EXPECT_THROW(Response(with_servo(1.0, 0.0), 1e-6), std::invalid_argument);  // ten million taps
  Machine machine;
  machine.prefilter_taps = {0.5, 0.4};
  EXPECT_THROW(Response(machine, 1e-3), std::invalid_argument);
  try {
    require_no_response(with_servo(200.0, 0.0), "a figure");
    FAIL() << "a response was ignored";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("a figure does not consider the servo of an axis"));
  }
}

}  // namespace
}  // namespace accdec
