#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/study/column_titles.hpp>
#include <accdec/study/study_figure_completion.hpp>

#include "support/command_fixture.hpp"

// Figures of a study either show what they say or are refused, with the line of the study file.

namespace {

TEST(CurveTitles, OfComputationsAreTheirs) {
  EXPECT_THAT(accdec::curve_titles({"optimum", "trapezoid", "s-curve", "delays"}),
              ::testing::ElementsAre("designed", "two averages (trapezoidal acceleration, the industry's S-curve)",
                                     "quintic S-curve (paper)", "delays"));
  EXPECT_THAT(accdec::curve_titles({"hann.cycle_time_ms", "optimum.cycle_time_ms"}),
              ::testing::ElementsAre("Hann", "designed"));
  EXPECT_THAT(accdec::curve_titles({"hann.cycle_time_ms", "hann.error_um"}),
              ::testing::ElementsAre("Hann: cycle_time_ms", "Hann: error_um"));
}

using ::testing::HasSubstr;
using ::testing::Not;

using accdec::testing::content;
using accdec::testing::Outcome;
using accdec::testing::write;

class StudyFigures : public accdec::testing::CommandInFolder {
 protected:
  /// A study of 3 x 30 x 2 points, its figure's first line the 23rd, and what comes of it.
  Outcome figure(const std::string& lines, const std::string& top = "") {
    write(home_ / "task.toml", R"(sample_period_ms = 1.0
[filter]
kind = "hann"
order = 40
[[corner]]
name = "A"
angle_deg = 90
feed_in_mm_min = 6000
error_max_um = 50
)");
    write(home_ / "study.toml", fmt::format(R"(task = "task.toml"
compute = ["delays", "given"]
{}
[[case]]
name = "one"
[[case]]
name = "two"
[case.set]
"corner.A.feed_in_mm_min" = 3000
[[vary]]
name = "angle_deg"
key = "corner.A.angle_deg"
values = [30, 60, 90]
[[vary]]
name = "tolerance_um"
key = "corner.A.error_max_um"
range = {{ from = 0.1, to = 300, count = 30, log = true }}


[[figure]]
name = "f"
{}
)",
                                            top, lines));
    return run("study study.toml --out out");
  }
  void expect_refused(const std::string& lines, const std::string& because, const std::string& top = "") {
    const Outcome r = figure(lines, top);
    EXPECT_NE(r.exit_code, 0) << lines;
    EXPECT_THAT(r.output, HasSubstr(because)) << lines;
    EXPECT_THAT(r.output, ::testing::ContainsRegex("study.toml:2[0-9]:[0-9]+: ")) << lines;
    EXPECT_FALSE(std::filesystem::exists(home_ / "out")) << lines;
  }
};

constexpr const char* curve = "x = \"tolerance_um\"\ny = \"delays.cycle_time_ms\"\n";
constexpr const char* heat = "kind = \"heat\"\nx = \"angle_deg\"\ny = \"tolerance_um\"\nz = \"delays.cycle_time_ms\"\n";
constexpr const char* latin = "sampling = \"latin-hypercube\"\nsamples = 12";

TEST_F(StudyFigures, RefusesAxesNeitherShownNorFixed) {
  expect_refused(curve, "`case` takes 2 values, but is neither on the figure nor fixed");
  expect_refused(fmt::format("{}where = {{ case = \"one\" }}", curve), "`angle_deg` takes 3 values, but is neither");
  expect_refused(heat, "`case` takes 2 values");
  expect_refused(fmt::format("{}kind = \"family\"\nfamily = \"angle_deg\"", curve), "`case` takes 2 values");
}

TEST_F(StudyFigures, RefusesConditionsThatNoPointMeets) {
  expect_refused(fmt::format("{}where = {{ case = \"one\", angle_deg = 45 }}", curve),
                 "`angle_deg` never is 45.0; it takes 30, 60, 90");
  expect_refused(fmt::format("{}where = {{ case = \"three\", angle_deg = 30 }}", curve),
                 "`case` never is three; it takes \"one\", \"two\"");
}

TEST_F(StudyFigures, RefusesTextAxesManyCurvesAndLabelsThatDoNotFit) {
  const std::string one = "where = { case = \"one\", angle_deg = 30 }\n";
  expect_refused("x = \"delays.status\"\ny = \"delays.cycle_time_ms\"\n" + one, "`delays.status` is a text");
  expect_refused(
      "kind = \"family\"\nx = \"angle_deg\"\ny = \"delays.cycle_time_ms\"\nfamily = \"tolerance_um\"\nwhere = { case = "
      "\"one\" }",
      "30 curves are too many");
  expect_refused(curve + one + "labels = [\"a\", \"b\"]", "2 labels for 1 curve;");
  expect_refused(
      fmt::format("{}kind = \"family\"\nfamily = \"angle_deg\"\nlabels = [\"a\"]\nwhere = {{ case = \"one\" }}", curve),
      "1 label for 3 curves");
}

TEST_F(StudyFigures, OfALatinHypercubeArePoints) {
  expect_refused(fmt::format("{}where = {{ case = \"one\" }}", heat), "a Latin hypercube has no grid", latin);
  expect_refused(fmt::format("{}where = {{ case = \"one\", tolerance_um = 1 }}", curve),
                 "a Latin hypercube draws it at random", latin);
  const Outcome r = figure(fmt::format("{}where = {{ case = \"one\" }}", curve), latin);
  EXPECT_EQ(r.exit_code, 0) << r.output;
}

TEST_F(StudyFigures, WithoutDataSaySo) {
  const std::string one = "where = { case = \"one\", angle_deg = 30, \"delays.status\" = \"no such thing\" }\n";
  const Outcome r = figure(curve + one);
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_THAT(r.output, HasSubstr("warning: figure `f` has no data"));
  EXPECT_THAT(content(home_ / "out/f.svg"), HasSubstr(">no data<"));
}

TEST_F(StudyFigures, HaveUnitsAndShortLabels) {
  const Outcome r =
      figure(fmt::format("{}kind = \"family\"\nfamily = \"angle_deg\"\nwhere = {{ case = \"one\" }}", curve));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_THAT(r.output, Not(HasSubstr("warning")));
  const std::string svg = content(home_ / "out/f.svg");
  for (const char* text : {">tolerance / µm<", ">delays: cycle time / ms<", ">30 deg<", ">90 deg<"})
    EXPECT_THAT(svg, HasSubstr(text));
}

TEST_F(StudyFigures, TakeAUnitFromTheKeyWhereTheNameHasNone) {
  const Outcome r = figure(
      "x = \"speed\"\ny = [\"delays.cycle_time_ms\", \"given.cycle_time_ms\"]\nwhere = { case = \"one\", angle_deg = "
      "30, tolerance_um = 300 }\n"
      "[[vary]]\nname = \"speed\"\nkey = \"corner.A.feed_out_mm_min\"\nvalues = [1000, 2000]");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::string svg = content(home_ / "out/f.svg");
  EXPECT_THAT(svg, HasSubstr(">speed / mm/min<"));
  EXPECT_THAT(svg, HasSubstr(">cycle time / ms<"));
}

TEST(AxisTitle, PutsTheUnitBehindTheName) {
  const auto title = [](const std::string& column) { return accdec::axis_title(column, accdec::unit_of(column)); };
  EXPECT_EQ(title("feed_in_mm_min"), "feed in / mm/min");
  EXPECT_EQ(title("optimum.cycle_time_ms"), "optimum: cycle time / ms");
  EXPECT_EQ(title("jerk_max_mm_s3"), "jerk max / mm/s³");
  EXPECT_EQ(title("residual_max"), "residual max");
}

}  // namespace
