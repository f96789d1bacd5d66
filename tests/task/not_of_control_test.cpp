#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/task/not_of_control.hpp>

// Filters that no setting of a control gives, by the rule of each family.

namespace accdec {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double period = 1e-3;

SettableStage stage(double step = 0.0, double most = 0.0) {
  SettableStage made;
  made.length_step = step, made.length_max = most;
  return made;
}

FilterSpec averages_of(std::vector<int> lengths) {
  FilterSpec spec{.kind = Shape::averages};
  for (const int length : lengths) spec.order += length - 1;
  spec.lengths = std::move(lengths);
  return spec;
}

std::string why(const ControllerSettings& control, const FilterSpec& filter) {
  return not_of_control(control, filter, period);
}

TEST(NotOfControl, TwoAveragesAreAnyTwo) {
  ControllerSettings two;
  two.families = {SettingFamily::averages};
  two.stages = {stage(), stage()};
  EXPECT_THAT(why(two, averages_of({9, 3})), IsEmpty());
  EXPECT_THAT(why(two, averages_of({9, 1, 3})), IsEmpty()) << "an average of one sample is none";
  EXPECT_THAT(why(two, {.kind = Shape::boxcar, .order = 20}), IsEmpty());
  EXPECT_THAT(why(two, {.kind = Shape::trapezoid, .order = 40, .ramp = 10}), IsEmpty());
  EXPECT_THAT(why(two, {.kind = Shape::exponential, .order = 9, .ratio = 1.0}), IsEmpty()) << "ten equal taps";
  EXPECT_EQ(why(two, averages_of({9, 9, 3})), "averages of 9 ms, 9 ms and 3 ms, and the control has 2 averages");
  EXPECT_EQ(why(two, {.kind = Shape::exponential, .order = 9, .ratio = 0.5}),
            "an exponential of 10 ms, time constant 1.44269504 ms, and the control has 2 averages");
  EXPECT_THAT(why(two, {.kind = Shape::hann, .order = 9}), HasSubstr("a Hann filter of 10 ms, and the control has"));
  EXPECT_THAT(why(two, {.kind = Shape::boxcar, .order = 9, .pairs = 1, .pair_delay = 5.0}), HasSubstr("2 averages"));
  two.families = {SettingFamily::taps};
  EXPECT_THAT(why(two, averages_of({9, 9, 3})), IsEmpty());
}

TEST(NotOfControl, StepsCapsAndSetsOfEachStageCount) {
  ControllerSettings control;
  control.families = {SettingFamily::averages};
  control.stages = {stage(2e-3, 40e-3), stage()};
  control.stages[1].length_set = {1e-3, 3e-3, 9e-3};
  EXPECT_THAT(why(control, averages_of({40, 9})), IsEmpty());
  EXPECT_THAT(why(control, averages_of({9, 40})), IsEmpty()) << "in any order";
  EXPECT_THAT(why(control, averages_of({42})), HasSubstr("no average of the control can be 42 ms"));
  EXPECT_THAT(why(control, averages_of({8, 5})), HasSubstr("no average of the control can be 5 ms"));
  EXPECT_THAT(why(control, averages_of({20, 10})), HasSubstr("no two averages of the control can have these times"));
}

TEST(NotOfControl, APoleEndsWhereItsStepIsOver) {
  ControllerSettings pole;
  pole.families = {SettingFamily::one_pole};
  pole.stages = {stage(1e-3, 50e-3)};
  // exp(-83/9) = 9.9e-5: the tail of a time constant of 9 samples falls below 1e-4 with 83 taps.
  const double nine = std::exp(-1.0 / 9.0);
  EXPECT_THAT(why(pole, {.kind = Shape::exponential, .order = 82, .ratio = nine}), IsEmpty());
  EXPECT_THAT(why(pole, {.kind = Shape::exponential, .order = 40, .ratio = nine}), HasSubstr("has one pole"));
  EXPECT_THAT(why(pole, {.kind = Shape::exponential, .order = 99, .ratio = std::exp(-1.0 / 9.5)}),
              HasSubstr("no setting of the control has this time"));
  EXPECT_THAT(why(pole, {.kind = Shape::exponential, .order = 999, .ratio = std::exp(-1.0 / 51.0)}),
              HasSubstr("no setting of the control has this time"));
  EXPECT_THAT(why(pole, averages_of({9})), HasSubstr("one average of 9 ms, and the control has one pole"));
  EXPECT_THAT(why(pole, {.kind = Shape::boxcar, .order = 0}), IsEmpty()) << "off";
}

TEST(NotOfControl, NumbersAreMultiplesOfTheirSteps) {
  ControllerSettings control;
  control.families = {SettingFamily::gaussian, SettingFamily::windowed_sinc, SettingFamily::exponential};
  control.stages = {stage(0.0, 60e-3)};
  control.alpha_step = 0.25, control.cutoff_step = 5.0, control.time_constant_step = 2e-3;
  EXPECT_THAT(why(control, {.kind = Shape::gaussian, .order = 40, .alpha = 2.5}), IsEmpty());
  EXPECT_THAT(why(control, {.kind = Shape::gaussian, .order = 40, .alpha = 2.4}), HasSubstr("this number"));
  EXPECT_THAT(why(control, {.kind = Shape::gaussian, .order = 60, .alpha = 2.5}), HasSubstr("this time"));
  // 0.02 of Nyquist's 500 Hz are 10 Hz.
  EXPECT_THAT(why(control, {.kind = Shape::blackman_sinc, .order = 40, .cutoff = 0.02}), IsEmpty());
  EXPECT_THAT(why(control, {.kind = Shape::blackman_sinc, .order = 40, .cutoff = 0.025}), HasSubstr("this number"));
  EXPECT_THAT(why(control, {.kind = Shape::exponential, .order = 40, .ratio = std::exp(-0.25)}), IsEmpty());
  EXPECT_THAT(why(control, {.kind = Shape::exponential, .order = 40, .ratio = std::exp(-0.2)}),
              HasSubstr("this number"));
}

TEST(NotOfControl, AShaperIsTheControlsOwn) {
  ControllerSettings control;
  control.families = {SettingFamily::shaper};
  control.stages = {stage()};
  control.shaper = find_shaper("zv");
  FilterSpec shaped = averages_of({9});
  EXPECT_THAT(why(control, shaped), IsEmpty()) << "off";
  shaped.pairs = 1, shaped.pair_delay = 12.0;
  EXPECT_THAT(why(control, shaped), IsEmpty());
  shaped.pair_delay = 12.5;
  EXPECT_THAT(why(control, shaped), HasSubstr("and the control has 1 average with ZV"));
  // Impulses half a period apart: 40 Hz are 12.5 samples.
  control.shaper_frequency_step = 0.5;
  EXPECT_THAT(why(control, shaped), IsEmpty());
  shaped.pairs = 2;
  EXPECT_THAT(why(control, shaped), HasSubstr("and the control has 1 average with ZV"));
}

}  // namespace
}  // namespace accdec
