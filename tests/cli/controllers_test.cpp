#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/run.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string folder_of_controllers = test_support::source_folder() + "/problems/controllers/";

TEST(CliControllers, AreListedAndShown) {
  const Outcome list = run({"controllers"});
  EXPECT_EQ(list.code, 0);
  for (const auto& entry : std::filesystem::directory_iterator(folder_of_controllers))
    EXPECT_THAT(list.out, HasSubstr(entry.path().stem().string() + " "));
  const Outcome shown = run({"controllers", "sinumerik-840d"});
  EXPECT_EQ(shown.code, 0);
  EXPECT_THAT(shown.out, HasSubstr("MD32410 $MA_AX_JERK_TIME, in s: step and cap not known"));
  EXPECT_THAT(shown.out, HasSubstr("A5E47437747B AA, page 377"));
  EXPECT_THAT(run({"controllers", "kollmorgen-akd"}).out, HasSubstr("one of 0.5, 1, 2, 4"));
  EXPECT_THAT(run({"controllers", "kollmorgen-akd"}).out, HasSubstr("delays      not known"));
  EXPECT_THAT(run({"controllers", "beckhoff-tf5200"}).out, HasSubstr("up to 200 cycles"));
}

TEST(CliControllers, AFileOfOnesOwnIsShown) {
  const Outcome own = run({"controllers", folder_of_controllers + "omron-g5.toml"});
  EXPECT_EQ(own.code, 0);
  EXPECT_EQ(own.out, run({"controllers", "omron-g5"}).out);
}

/// Times of two stages that differ in kind: a set, or no step, beside a step with a cap. The result has them all, and
/// is verified.
TEST(CliControllers, StagesOfDifferentKindsSurviveAResult) {
  const TemporaryFolder folder;
  const std::string task = folder.write(
      "task.toml",
      "sample_period_ms = 1.0\n[controller]\nfile = \"own.toml\"\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
      "jerk_max_mm_s3 = 500000\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n");
  const std::string result = folder.path("result.json");
  for (const char* first :
       {"", "length_set_ms = [1, 2, 4, 8, 16, 32]\n", "length_max_ms = 16\n", "length_step_ms = 2\n"}) {
    folder.write("own.toml", std::string("title = \"own\"\nfamily = \"averages\"\ndelays = [\"continuous\", "
                                         "\"exact-stop\"]\n[[stage]]\nparameter = \"P1\"\n") +
                                 first +
                                 "[[stage]]\nparameter = \"P2\"\nlength_step_ms = 3\nlength_max_ms = 30\n[[source]]\n"
                                 "fact = \"none\"\nwhere = \"nowhere\"\n");
    EXPECT_EQ(run({"design", task, "--json", result, "--no-baselines"}).code, 0) << first;
    const Outcome verified = run({"verify", result});
    EXPECT_EQ(verified.code, 0) << first << verified.out << verified.err;
  }
}

/// Every pair of times by hand: the longer average holds the acceleration, the product of both the jerk.
/// @param lengths  keys of [design]  @param first, second  lengths that they allow, samples
void expect_best_pair(const std::string& lengths, const std::vector<int>& first, const std::vector<int>& second) {
  const TemporaryFolder folder;
  const std::string task =
      folder.write("task.toml", "sample_period_ms = 1.0\n[design]\nfamily = \"averages\"\n" + lengths +
                                    "[controller]\ndelays = \"exact-stop\"\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
                                    "jerk_max_mm_s3 = 500000\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n"
                                    "error_max_um = 50\n");
  const std::string result = folder.path("result.json");
  int least = 1000;
  for (const int a : first) {
    for (const int b : second) {
      if (0.1 / (std::max(a, b) * 1e-3) <= 6.0 && 0.1 / (a * b * 1e-6) <= 500.0 * (1.0 + 1e-9))
        least = std::min(least, a + b - 1);
    }
  }
  const Outcome designed = run({"design", task, "--json", result, "--no-baselines"});
  EXPECT_EQ(designed.code, 0) << designed.err;
  // An exact stop is N samples later.
  EXPECT_THAT(designed.out, HasSubstr(std::to_string(2 * least - 1) + " ms a corner, proved best"));
  EXPECT_EQ(run({"verify", result}).code, 0);
}

TEST(CliControllers, SetsOfATaskMayDifferByStage) {
  expect_best_pair("length_set_ms = [1, 2, 4, 8, 16, 32]\nlength_set_2_ms = [3, 6, 9, 12, 15, 18, 21, 24]\n",
                   {1, 2, 4, 8, 16, 32}, {1, 3, 6, 9, 12, 15, 18, 21, 24});
}

/// The first stage keeps its step, the second has times of its own.
TEST(CliControllers, AStageAloneMayHaveASet) {
  std::vector<int> to_18(18);
  std::iota(to_18.begin(), to_18.end(), 1);
  expect_best_pair("length_max_ms = 18\nlength_set_2_ms = [5, 10, 20]\n", to_18, {1, 5, 10, 20});
}

/// The time ends long before all members are looked at. The message still has the limit and the nearest member.
TEST(CliControllers, TimeThatEndsLeavesAReason) {
  const TemporaryFolder folder;
  const std::string task = folder.write(
      "task.toml",
      "sample_period_ms = 1.0\n[design]\nfamily = \"exponential\"\norder_max = 20000\ntime_constant_step_ms = 0.2\n"
      "[[axis]]\nacceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n"
      "error_max_um = 0.001\n[[mode]]\nfrequency_Hz = 40\nresidual_max = 0\n");
  const Outcome designed = run({"design", task, "--no-baselines", "--time-limit", "4"});
  EXPECT_NE(designed.code, 0);
  const std::string all = designed.out + designed.err;
  EXPECT_THAT(all, HasSubstr("no setting of finite exponentials that holds all limits was found in the time given"));
  EXPECT_THAT(all, HasSubstr("the closest found in the time given, an exponential of "));
  EXPECT_THAT(all, HasSubstr("breaks "));
}

/// Filters of 10 ms accelerate an axis at 100 mm/s by 10000 mm/s^2 or more, and 6000 are allowed.
TEST(CliControllers, FamiliesWithoutAMemberThatHoldsAreRefusedAtTheirPlace) {
  const TemporaryFolder folder;
  const std::string machine =
      "[[axis]]\nacceleration_max_mm_s2 = 6000\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n";
  for (const char* family : {"averages", "exponential", "gaussian", "windowed-sinc"}) {
    const std::string task =
        folder.write("t.toml", std::string("sample_period_ms = 1\n[design]\nfamily = \"") + family +
                                   "\"\nstages = 1\nlength_max_ms = 10\norder_max = 100\n" + machine);
    const Outcome refused = run({"design", task, "--json", folder.path("r.json")});
    EXPECT_EQ(refused.code, 1) << family;
    EXPECT_THAT(refused.err, HasSubstr("t.toml:3:10: no setting of")) << family;
    EXPECT_THAT(refused.err, HasSubstr("breaks acceleration")) << family;
    EXPECT_THAT(refused.err, HasSubstr("the nearest that do")) << family;
    EXPECT_THAT(refused.out, IsEmpty());
    EXPECT_FALSE(std::filesystem::exists(folder.path("r.json"))) << family;
  }
  // A controller's file; a pole.
  folder.write("own.toml",
               "title = \"own\"\nfamily = \"one-pole\"\n[[stage]]\nparameter = \"TAU\"\nlength_max_ms = 10\n"
               "[[source]]\nfact = \"none\"\nwhere = \"nowhere\"\n");
  const std::string task =
      folder.write("t.toml", "sample_period_ms = 1\n[controller]\nfile = \"own.toml\"\n" + machine);
  const Outcome refused = run({"design", task});
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("t.toml:3:8: no setting of"));
  // A pole's first tap is 1 - exp(-T/tau): 0.1 m/s of it in 1 ms are 9.516 m/s^2, 158.6 % of 6.
  EXPECT_THAT(refused.err, HasSubstr("the closest, TAU = 10 ms, breaks acceleration x: 158.6 %"));
}

TEST(CliControllers, FreeTapsBesideAFamilyAreRefusedForAProgram) {
  const TemporaryFolder folder;
  const std::string program = test_support::source_folder() + "/problems/program/star.ngc";
  const std::string head = "sample_period_ms = 1\n[controller]\ndelays = \"";
  const Outcome family = run({"program", program, "--task",
                              folder.write("f.toml", head + "dwell\"\n[design]\nfamily = [\"taps\", \"averages\"]\n")});
  EXPECT_EQ(family.code, 2);
  EXPECT_THAT(family.err, HasSubstr("f.toml:5:10: [design] family names \"taps\" beside others"));
}

TEST(CliControllers, AGivenFilterHasNoTapsToDesign) {
  const TemporaryFolder folder;
  const Outcome refused =
      run({"design", folder.write("g.toml",
                                  "sample_period_ms = 1\n[controller]\ndelays = \"in-position\"\n[filter]\nkind = "
                                  "\"boxcar\"\norder = 19\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n")});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("g.toml:3:10: [controller] delays names kinds of delays for free taps"));
}

TEST(CliControllers, UnknownOnesAndBrokenFilesAreRefused) {
  const TemporaryFolder folder;
  const Outcome unknown = run({"controllers", "kolmorgen-akd"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean \"kollmorgen-akd\"?"));
  const Outcome missing = run({"controllers", folder.path("none.toml")});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.toml: no such file"));
  const Outcome broken = run({"controllers", folder.write("b.toml", "title = \"b\"\nfamily = \"taps\"\nstages = 2\n")});
  EXPECT_EQ(broken.code, 2);
  EXPECT_THAT(broken.err, HasSubstr("b.toml:3:1"));
  EXPECT_THAT(broken.out, IsEmpty());
  const Outcome task = run({"controllers", test_support::source_folder() + "/problems/corner/power.toml"});
  EXPECT_EQ(task.code, 2);
}

}  // namespace
}  // namespace accdec
