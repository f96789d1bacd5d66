#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files/text_file.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/task.hpp>
#include <accdec/task/contradictions.hpp>

#include "support/malformed_loads.hpp"
#include "support/malformed_tasks.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Malformed : public ::testing::TestWithParam<malformed::Case> {};

TEST_P(Malformed, SaysWhereAndWhat) {
  const auto& [name, text, position, words] = GetParam();
  try {
    parse_task(text, "task.toml");
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), StartsWith("task.toml:" + position + ": "));
    for (const std::string& word : words) EXPECT_THAT(error.what(), HasSubstr(word));
  }
}
INSTANTIATE_TEST_SUITE_P(Tasks, Malformed, ::testing::ValuesIn(malformed::cases()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });
INSTANTIATE_TEST_SUITE_P(Loads, Malformed, ::testing::ValuesIn(malformed::load_cases()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST(TaskReader, TheMalformedTasksAreFaultyInOnePlaceOnly) {
  EXPECT_NO_THROW(parse_task(malformed::Parts{}.str(), "t"));
}

TEST(TaskReader, ConvertsToSi) {
  const Task task = parse_task(malformed::Parts{}.str(), "t");
  EXPECT_EQ(task.sample_period, 1e-3);
  ASSERT_TRUE(task.filter);
  EXPECT_EQ(task.filter->kind, Shape::trapezoid);
  EXPECT_EQ(task.filter->order, 20);
  EXPECT_EQ(task.filter->ramp, 5);
  ASSERT_EQ(task.machine.axes.size(), 2U);
  for (const Axis& axis : task.machine.axes) {
    EXPECT_EQ(axis.velocity_max, 0.5);
    EXPECT_EQ(axis.acceleration_max, 9.0);
    EXPECT_EQ(axis.jerk_max, unlimited);
    EXPECT_EQ(axis.mass, 50.0);
    EXPECT_EQ(axis.damping, 10.0);
    EXPECT_EQ(axis.force_max, 600.0);
  }
  EXPECT_EQ(task.machine.axes[0].name, "x");
  EXPECT_EQ(task.machine.axes[1].name, "y");
  ASSERT_EQ(task.corners.size(), 1U);
  const TaskCorner& corner = task.corners.front();
  const auto& legs = std::get<PlanarLegs>(corner.legs());
  EXPECT_DOUBLE_EQ(legs.angle, 95.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(corner.geometry().feed_in, 0.1);
  EXPECT_EQ(corner.geometry().feed_out, 0.1);
  EXPECT_EQ(corner.error_max, 4e-4);
  EXPECT_EQ(corner.delay, 3);
  EXPECT_EQ(corner.weight, 1.0);
  EXPECT_EQ(corner.speed_min, 0.0);
  EXPECT_EQ(legs.turn, Turn::left);
  EXPECT_NEAR(corner.geometry().cos_interior(), std::cos(legs.angle), 1e-15);
}

TEST(TaskReader, DefaultsWithoutTables) {
  const Task task = parse_task(
      "sample_period_ms = 2\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 600\n[[corner]]\nangle_deg = "
      "80\nfeed_in_mm_min = 600\n",
      "t");
  EXPECT_EQ(task.title, "");
  EXPECT_FALSE(task.filter);
  EXPECT_EQ(task.design.order_min, 1);
  EXPECT_EQ(task.design.order_max, 400);
  EXPECT_FALSE(task.design.symmetric);
  ASSERT_EQ(task.machine.axes.size(), 2U);
  EXPECT_EQ(task.machine.axes[1].acceleration_max, unlimited);
  EXPECT_EQ(task.corners[0].name, "A");
  EXPECT_EQ(task.corners[1].name, "B");
  EXPECT_FALSE(task.corners[0].error_max);
  EXPECT_FALSE(task.corners[0].delay);
}

TEST(TaskReader, OneAxisTableStandsForAsManyAxesAsTheDirectionsHave) {
  const auto text = [](const char* directions) {
    return std::string("sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 5\n[[corner]]\nfeed_in_mm_min = 6\n") +
           directions;
  };
  const Task three = parse_task(text("direction_in = [1, 2, 2]\ndirection_out = [0, 0, -1]\n"), "t");
  ASSERT_EQ(three.machine.axes.size(), 3U);
  EXPECT_EQ(three.machine.axes[2].name, "z");
  EXPECT_EQ(three.machine.axes[2].acceleration_max, 5e-3);
  EXPECT_DOUBLE_EQ(three.corners[0].geometry().direction_in[1], 2.0 / 3.0);
  const Task one = parse_task(text("direction_in = [1]\ndirection_out = [-1]\n"), "t");
  EXPECT_EQ(one.machine.axes.size(), 1U);
}

std::string text_of_errors(const std::string& text) {
  try {
    parse_task(text, "t");
  } catch (const InputError& error) {
    return error.what();
  }
  return "was read";
}

/// Everything that is wrong by itself is said at once, in the order of the file.
TEST(TaskReader, SaysSeveralErrorsAtOnce) {
  EXPECT_EQ(text_of_errors("sample_period_ms = 0\n[design]\norder_min = 9\norder_max = 3\n[[corner]]\nangle_deg = 200\n"
                           "eror_max_um = 5\n[[corner]]\nangle_deg = 90\nturn = \"up\"\n"),
            "t:1:20: `sample_period_ms` = 0 is out of range; allowed is 0.0001 <= sample_period_ms <= 1000\n"
            "t:3:13: `order_min` = 9 is above `order_max` = 3; allowed is order_min <= order_max\n"
            "t:6:13: `angle_deg` = 200 is out of range; allowed is 0 < angle_deg <= 180; or `direction_in` and "
            "`direction_out`\n"
            "t:7:1: unknown key `eror_max_um` in [[corner]] 1; did you mean `error_max_um`?\n"
            "t:8:1: [[corner]] 2 needs `feed_in_mm_min`; allowed is 0 < feed_in_mm_min <= 10000000\n"
            "t:10:8: `turn` = \"up\" is unknown; allowed are left, right");
  // Relations between tables are looked at when each is right in itself: here every corner is too fast.
  EXPECT_EQ(
      text_of_errors("sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 10\n[[corner]]\nangle_deg = 90\n"
                     "feed_in_mm_min = 1200\n[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\n"),
      "t:6:18: corner A: feed_in_mm_min asks axis x for 20 mm/s; allowed is velocity_max_mm_s = 10 (a feed up to "
      "600 mm/min in this direction)\n"
      "t:9:18: corner B: feed_in_mm_min asks axis x for 100 mm/s; allowed is velocity_max_mm_s = 10 (a feed up to "
      "600 mm/min in this direction)");
}

TEST(TaskReader, CountsWhatIsTooMuchToShow) {
  std::string text = "sample_period_ms = 1\n";
  for (int i = 0; i < 5000; ++i) text += "[[corner]]\nangle_deg = 0\nfeed_in_mm_min = -1\n";
  const std::string message = text_of_errors(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 10);
  // The check ends at a hundred.
  EXPECT_THAT(message, ::testing::EndsWith("\nt: and at least 90 more"));
  // For a list with many bad elements, the first one is reported.
  std::string taps = "[filter]\nkind = \"taps\"\ntaps = [";
  for (int i = 0; i < 100000; ++i) taps += "-1,";
  EXPECT_THAT(text_of_errors("sample_period_ms = 0\n" + taps + "1]\n[[corner]]\nangle_deg = 9\nfeed_in_mm_min = 1\n"),
              ::testing::EndsWith("\nt:4:9: `taps`: element 0 = -1 is out of range; allowed is 0 <= taps <= 1e+300"));
}

TEST(TaskReader, ProgramsNeedNoCorner) {
  const Task task = parse_task("sample_period_ms = 1\n[[axis]]\nmass_kg = 3\n[program]\nerror_max_um = 20\n", "t",
                               {.require_corners = false, .axes = 3});
  EXPECT_TRUE(task.corners.empty());
  EXPECT_EQ(task.machine.axes.size(), 3U);
  EXPECT_EQ(task.program_error_max, 2e-5);
}

TEST(TaskReader, ChoicesCanBeRequired) {
  const TaskOptions options{.require_choices = true};
  EXPECT_NO_THROW(parse_task(malformed::Parts{}.str(), "t", options));
  EXPECT_THROW(parse_task(malformed::with_filter(""), "t", options), InputError);
  EXPECT_THROW(parse_task(malformed::with_corner("[[corner]]\nangle_deg = 9\nfeed_in_mm_min = 3\n"), "t", options),
               InputError);
}

TEST(TaskReader, ByteOrderMarkAndWindowsLineEndsDoNotMatter) {
  TemporaryFolder folder;
  std::string text = malformed::Parts{}.str(), windows = "\xEF\xBB\xBF";
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const Task a = read_task(folder.write("a.toml", text)), b = read_task(folder.write("b.toml", windows));
  EXPECT_EQ(task_to_toml(a), task_to_toml(b));
}

TEST(TaskReader, FilesThatCannotBeRead) {
  TemporaryFolder folder;
  const auto message = [](const std::string& path) -> std::string {
    try {
      read_task(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "was read";
  };
  EXPECT_THAT(message(folder.path("none.toml")), HasSubstr("none.toml: no such file"));
  EXPECT_THAT(message(folder.path("")), HasSubstr("is a directory"));
  EXPECT_THAT(message(""), HasSubstr("name is empty"));
  EXPECT_THAT(message(folder.write("zero.toml", std::string("a\0b", 3))),
              HasSubstr("not a text file (zero byte at offset 1)"));
  EXPECT_THAT(message(folder.write("wide.toml", std::string("\xFF\xFE"
                                                            "a",
                                                            3))),
              HasSubstr("UTF-16"));
  const std::string large = folder.write("large.toml", "#");
  std::filesystem::resize_file(large, (std::uintmax_t{64} << 20) + 1);  // sparse
  EXPECT_THAT(message(large), HasSubstr("larger than the 64 MB"));
}

/// Compares tasks by their canonical text, and the numbers bit by bit.
void expect_same(const Task& a, const Task& b) {
  EXPECT_EQ(task_to_toml(a), task_to_toml(b));
  EXPECT_EQ(a.sample_period, b.sample_period);
  ASSERT_EQ(a.corners.size(), b.corners.size());
  for (std::size_t j = 0; j < a.corners.size(); ++j) {
    EXPECT_EQ(a.corners[j].geometry().direction_in, b.corners[j].geometry().direction_in);
    EXPECT_EQ(a.corners[j].geometry().direction_out, b.corners[j].geometry().direction_out);
    const auto* planar = std::get_if<PlanarLegs>(&a.corners[j].legs());
    const auto* again = std::get_if<PlanarLegs>(&b.corners[j].legs());
    ASSERT_EQ(planar == nullptr, again == nullptr);
    if (planar) {
      EXPECT_EQ(planar->angle, again->angle);
      EXPECT_EQ(planar->heading, again->heading);
    }
    EXPECT_EQ(a.corners[j].geometry().feed_in, b.corners[j].geometry().feed_in);
    EXPECT_EQ(a.corners[j].geometry().feed_out, b.corners[j].geometry().feed_out);
    EXPECT_EQ(a.corners[j].error_max, b.corners[j].error_max);
    EXPECT_EQ(a.corners[j].speed_min, b.corners[j].speed_min);
  }
  ASSERT_EQ(a.machine.axes.size(), b.machine.axes.size());
  for (std::size_t i = 0; i < a.machine.axes.size(); ++i) {
    EXPECT_EQ(a.machine.axes[i].velocity_max, b.machine.axes[i].velocity_max);
    EXPECT_EQ(a.machine.axes[i].acceleration_max, b.machine.axes[i].acceleration_max);
    EXPECT_EQ(a.machine.axes[i].jerk_max, b.machine.axes[i].jerk_max);
    EXPECT_EQ(a.machine.axes[i].force_max, b.machine.axes[i].force_max);
  }
}

/// Dry friction of 100 N takes 10 W at 100 mm/s, whatever else the axis has. A curve may fall below it.
TEST(TaskReader, DryFrictionAloneTakesPowerAndForce) {
  const auto broken = [](const std::string& limit) {
    return contradictions(
        parse_task(fmt::format("sample_period_ms = 1\n[[axis]]\ncoulomb_N = 100\n{}\n[[corner]]\n"
                               "direction_in = [1]\ndirection_out = [-1]\nfeed_in_mm_min = 6000\ndelay_samples = 3\n",
                               limit),
                   "t", {.response = Considered::all}));
  };
  EXPECT_THAT(broken("power_max_W = 10.1"), ::testing::IsEmpty());
  EXPECT_THAT(broken("power_max_W = 9.9"), ::testing::SizeIs(1));
  EXPECT_THAT(broken("force_speed_N = [[0, 200], [200, 1]]"), ::testing::IsEmpty());  // 100.5 N at 100 mm/s
  EXPECT_THAT(broken("force_speed_N = [[0, 198], [200, 1]]"), ::testing::SizeIs(1));  // 99.5 N
}

/// An axis that no corner moves needs no force, whatever its friction.
TEST(TaskReader, FrictionOfAnAxisThatStandsMayBeAboveItsForce) {
  const auto text = [](double along_y) {
    return fmt::format(
        "sample_period_ms = 1\n[[axis]]\nname = \"x\"\nmass_kg = 5\nforce_max_N = 50\n[[axis]]\nname = \"y\"\n"
        "mass_kg = 5\nforce_max_N = 50\ncoulomb_N = 60\n[[corner]]\ndirection_in = [1, 0]\n"
        "direction_out = [-1, {}]\nfeed_in_mm_min = 6000\n",
        along_y);
  };
  const TaskOptions options{.response = Considered::all};
  EXPECT_NO_THROW(parse_task(text(0.0), "t", options));
  EXPECT_THROW(parse_task(text(0.1), "t", options), InputError);
}

TEST(TaskReader, EveryShippedTaskIsReadAndSurvivesTheRoundTrip) {
  int count = 0;
  const std::filesystem::path problems = accdec::test_support::source_folder() + "/problems";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(problems)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string folder = entry.path().parent_path().filename();
    if (folder == "suites" || folder == "studies" || folder == "controllers") continue;  // not tasks but lists of them
    if ((folder == "study" || folder == "suite") &&
        read_text_file(entry.path(), 1 << 20).find("[[corner]]") == std::string::npos)
      continue;
    SCOPED_TRACE(entry.path());
    // Programs bring their own corners.
    const bool program = *std::filesystem::relative(entry.path(), problems).begin() == "program";
    const Task task = read_task(entry.path(), {.require_corners = !program, .response = Considered::all});
    expect_same(task, parse_task(task_to_toml(task), "again", {.require_corners = false, .response = Considered::all}));
    ++count;
  }
  EXPECT_GE(count, 15);
}

TEST(TaskReader, AwkwardNumbersSurviveTheRoundTripToTheLastBit) {
  unsigned state = 1;
  for (int i = 0; i < 300; ++i) {
    const auto next = [&] { return 1e-3 + (state = state * 1664525U + 1013904223U) / 4294967296.0; };
    std::string text = "sample_period_ms = " + std::to_string(next()) +
                       "\n[[axis]]\njerk_max_mm_s3 = " + std::to_string(1e6 * next()) + "\n[[corner]]\n";
    char line[200];
    std::snprintf(line, sizeof line,
                  "angle_deg = %.17g\nheading_deg = %.17g\nfeed_in_mm_min = %.17g\nerror_max_um = "
                  "%.17g\nspeed_min_mm_s = %.17g\n",
                  179.0 * next(), -300.0 * next(), 60000.0 * next(), 500.0 * next(), next());
    const Task task = parse_task(text + line, "t");
    expect_same(task, parse_task(task_to_toml(task), "again"));
  }
}

}  // namespace
}  // namespace accdec
