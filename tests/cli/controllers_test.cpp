#include <filesystem>

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
