#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/run.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* task_text = "sample_period_ms = 1\n";

/// Rows of a move of 20 mm at 100 mm/s behind averages of these lengths, in ms and mm.
std::vector<std::string> move_behind(const std::vector<int>& lengths, int samples = 200) {
  std::vector<double> way;
  for (int k = 0; k < samples + 220; ++k) way.push_back(0.1 * std::min(std::max(k - 50, 0), samples));
  for (const int length : lengths) {
    std::vector<double> next;
    for (int k = 0; k < static_cast<int>(way.size()); ++k) {
      double sum = 0.0;
      for (int i = 0; i < length; ++i) sum += way[static_cast<std::size_t>(std::max(k - i, 0))];
      next.push_back(sum / length);
    }
    way = std::move(next);
  }
  std::vector<std::string> rows;
  for (std::size_t k = 0; k < way.size(); ++k) rows.push_back(fmt::format("{},{:.9f}", k, way[k]));
  return rows;
}

std::string table(const std::string& header, const std::vector<std::string>& rows) {
  std::string text = header + "\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

struct Files {
  TemporaryFolder folder;
  std::string task = folder.write("task.toml", task_text);

  Outcome identify(const std::string& log, std::vector<std::string> more = {}) {
    std::vector<std::string> all{"identify", folder.write("log.csv", log), "--task", task};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }
};

TEST(CliIdentify, WritesAFilterThatATaskTakes) {
  Files files;
  const std::string out = files.folder.path("filter.toml");
  const Outcome done = files.identify(table("t_ms,x_mm", move_behind({18, 7})),
                                      {"--out", out, "--figure", files.folder.path("fit.svg")});
  ASSERT_EQ(done.code, 0) << done.err;
  const std::string filter = files.folder.read("filter.toml");
  EXPECT_THAT(filter, HasSubstr("lengths = [18, 7]"));
  EXPECT_THAT(filter, HasSubstr("straight move: 20 mm in 200 samples, 6000 mm/min"));
  EXPECT_THAT(files.folder.read("fit.svg"), HasSubstr("log less fit"));
  const std::string part = files.folder.write("part.ngc", "G21 G90\nG1 X20 F6000\nM2\n");
  const std::string whole =
      files.folder.write("whole.toml", fmt::format("{}{}[[axis]]\nacceleration_max_mm_s2 = 6000\n", task_text, filter));
  EXPECT_EQ(run({"program", part, "--task", whole, "--feeds", "keep"}).code, 0);
}

TEST(CliIdentify, TheSmoothingOfATaskStandsBehindWhatIsFound) {
  Files files;
  files.task = files.folder.write("smooth.toml", fmt::format("{}[controller]\nprefilter_taps = [0.25, 0.25, 0.25, "
                                                             "0.25]\n",
                                                             task_text));
  const std::string log = table("t_ms,x_mm", move_behind({18, 7, 4}));
  EXPECT_THAT(files.identify(log).out, HasSubstr("lengths = [18, 7]"));
  // Asked for the smoothing itself, the task's own does not count.
  EXPECT_THAT(files.identify(table("t_ms,x_mm", move_behind({4})), {"--prefilter"}).out,
              HasSubstr("prefilter_taps = [0.25, 0.25, 0.25, 0.25]"));
}

TEST(CliIdentify, UnitsOfTheColumnsCount) {
  Files files;
  std::vector<std::string> seconds;
  for (const std::string& row : move_behind({22})) {
    const std::size_t comma = row.find(',');
    seconds.push_back(
        fmt::format("{:.6f};{:.6f}", 1e-3 * std::stod(row.substr(0, comma)), 1e3 * std::stod(row.substr(comma + 1))));
  }
  const Outcome done = files.identify("# a remark\n" + table("t_s;x_um", seconds));
  EXPECT_THAT(done.out, HasSubstr("lengths = [22]"));
  EXPECT_THAT(done.out, HasSubstr("6000 mm/min"));
}

TEST(CliIdentify, UnitsMayBeGivenBesideTheLog) {
  Files files;
  const std::string log = table("t,x", move_behind({22}));
  const Outcome none = files.identify(log);
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("log.csv:1:1: column `t` names no known unit; allowed are one time"));
  EXPECT_THAT(none.err, HasSubstr("--units, such as s,mm"));
  const Outcome given = files.identify(log, {"--units", "ms,mm"});
  EXPECT_THAT(given.out, HasSubstr("lengths = [22]"));
  EXPECT_THAT(given.out, HasSubstr("6000 mm/min"));
  // A column's own unit counts.
  EXPECT_THAT(files.identify(table("t_ms,x", move_behind({22})), {"--units", "s,mm"}).out, HasSubstr("6000 mm/min"));
  for (const std::string wrong : {"mm,s", "s", "s,mm,um", ",", "s,feet"}) {
    const Outcome refused = files.identify(log, {"--units", wrong});
    EXPECT_EQ(refused.code, 2) << wrong;
    EXPECT_THAT(refused.err, HasSubstr("`" + wrong + "` is no unit of times and one of positions"));
  }
}

/// Whole um: rounding is noise of 1 um / sqrt(12) = 0.2887 um.
TEST(CliIdentify, WholeMicrometresAreNotExact) {
  Files files;
  std::vector<std::string> rounded;
  for (const std::string& row : move_behind({12, 9})) {
    const std::size_t comma = row.find(',');
    rounded.push_back(fmt::format("{},{:.3f}000", row.substr(0, comma), std::stod(row.substr(comma + 1))));
  }
  const std::string out = files.identify(table("t_ms,x_mm", rounded)).out;
  EXPECT_THAT(out, HasSubstr("lengths = [12, 9]"));
  EXPECT_THAT(out, HasSubstr("the positions are rounded, which is noise of 0.2887 um or more"));
  EXPECT_THAT(files.identify(table("t_ms,x_mm", move_behind({12, 9}))).out, HasSubstr("lengths = [12, 9]"));
}

/// A move of 15 ms behind an average of 40 ms is one of 40 ms behind an average of 15 ms.
TEST(CliIdentify, TheFeedTellsAMoveFromAnAverage) {
  Files files;
  const std::string log = table("t_ms,x_mm", move_behind({40, 10}, 15));
  const std::string any = files.identify(log).out;
  EXPECT_THAT(any, HasSubstr("found in " + files.folder.path("log.csv") + ": averages of 15, 10 ms"));
  EXPECT_THAT(any, HasSubstr("also fits: averages of 40, 10 ms behind a move of 15 samples at 6000 mm/min"));
  EXPECT_THAT(any, HasSubstr("also fits: averages of 40, 15 ms behind a move of 10 samples at 9000 mm/min"));
  const std::string one = files.identify(log, {"--feed-mm-min", "6000"}).out;
  EXPECT_THAT(one, HasSubstr("lengths = [40, 10]"));
  EXPECT_THAT(one, Not(HasSubstr("15, 10 ms")));
  const Outcome none = files.identify(log, {"--feed-mm-min", "4000"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("no move at the given feed of 4000 mm/min explains the log"));
}

/// Every position of the control two or three times.
TEST(CliIdentify, ALogFasterThanTheControlIsNamed) {
  Files files;
  files.task = files.folder.write("fast.toml", "sample_period_ms = 0.4\n");
  const std::vector<std::string> rows = move_behind({22, 22});
  std::vector<std::string> fast;
  for (std::size_t k = 0; k < rows.size() * 5 / 2; ++k) {
    const std::string& row = rows[2 * k / 5];
    fast.push_back(fmt::format("{:.1f},{}", 0.4 * static_cast<double>(k), row.substr(row.find(',') + 1)));
  }
  const Outcome done = files.identify(table("t_ms,x_mm", fast));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("the log is faster than the control"));
}

TEST(CliIdentify, ALogOfTwoMovesIsNamed) {
  Files files;
  const std::vector<std::string> rows = move_behind({22, 22});
  std::vector<std::string> twice = rows;
  const auto place = [](const std::string& row) { return std::stod(row.substr(row.find(',') + 1)); };
  for (const std::string& row : rows)
    twice.push_back(fmt::format("{},{:.9f}", twice.size(), place(rows.back()) + place(row)));
  const Outcome done = files.identify(table("t_ms,x_mm", twice));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("between two moves; allowed is one straight move, or one corner"));
}

/// A drive logs each position of the control four times, and the control's clock lies anywhere among them.
TEST(CliIdentify, ALogMayHaveSeveralRowsASample) {
  const std::vector<std::string> rows = move_behind({22, 15});
  for (const std::size_t later : {0U, 1U, 3U}) {
    std::vector<std::string> drive;
    for (std::size_t k = 0; k < 4 * rows.size(); ++k) {
      const std::string& row = rows[(k + 3 - later) / 4 < rows.size() ? (k + 3 - later) / 4 : rows.size() - 1];
      drive.push_back(fmt::format("{:.2f},{}", 0.25 * static_cast<double>(k), row.substr(row.find(',') + 1)));
    }
    const std::string log = table("t_ms,x_mm", drive);
    EXPECT_THAT(Files().identify(log, {"--feed-mm-min", "6000"}).out, HasSubstr("lengths = [22, 15]")) << later;
  }
}

struct BadLog {
  const char* name;
  std::string text, position, message;
};

std::vector<BadLog> bad_logs() {
  const std::vector<std::string> good = move_behind({22, 22});
  const auto with = [&](std::size_t row, const std::string& text) {
    std::vector<std::string> rows = good;
    rows[row] = text;
    return table("t_ms,x_mm", rows);
  };
  std::vector<std::string> gap = good;
  gap.erase(gap.begin() + 100, gap.begin() + 103);
  const std::vector<std::string> ends_moving(good.begin(), good.begin() + 150);
  const std::vector<std::string> starts_moving(good.begin() + 100, good.end());
  std::vector<std::string> slower, third;
  for (std::size_t k = 0; k < good.size(); k += 3) third.push_back(good[k]);
  for (std::size_t k = 0; k < good.size(); ++k)
    slower.push_back(fmt::format("{:.2f}{}", 1.05 * static_cast<double>(k), good[k].substr(good[k].find(','))));
  const std::vector<std::string> few(good.begin(), good.begin() + 19);
  return {
      {"Empty", "", ":1:1: ", "has no header; allowed are one time"},
      {"OnlyAHeader", "t_ms,x_mm\n", ":1:1: ", "has no samples"},
      {"NoTime", table("y_mm,x_mm", good), ":1:1: ", "the header has no time"},
      {"NoAxis", "t_ms\n0\n1\n", ":1:1: ", "the header has no axis"},
      {"NoUnit", table("t_ms,x", good), ":1:6: ", "column `x` names no known unit"},
      {"UnitOfAnotherKind", table("t_mm,x_mm", good), ":1:1: ", "column `t_mm` names no known unit"},
      {"AxisTwice", "t_ms,x_mm,x_um\n0,0,0\n", ":1:11: ", "stands twice"},
      {"TimeTwice", "t_ms,time_s,x_um\n0,0,0\n", ":1:6: ", "is a second time"},
      {"NoHeader", table("0,1", good), ":1:1: ", "column `0` names no known unit"},
      {"NaN", with(30, "30,nan"), ":32:4: ", "`nan` is no number"},
      {"Infinite", with(30, "30,-inf"), ":32:4: ", "`-inf` is no number"},
      {"Word", with(30, "30,1.5mm"), ":32:4: ", "`1.5mm` is no number"},
      {"NaNTime", with(30, "nan,1"), ":32:1: ", "`nan` is no number"},
      {"FieldMissing", with(30, "30"), ":32:1: ", "the row has 1 values; the header has 2 columns"},
      {"FieldEmpty", with(30, "30,"), ":32:4: ", "`` is no number"},
      {"FieldTooMany", with(30, "30,1,2"), ":32:1: ", "the row has 3 values"},
      {"TimeStandsStill", with(30, good[29]), ":32:1: ", "allowed are rising times"},
      {"TimeGoesBack", with(30, "3,1"), ":32:1: ", "allowed are rising times"},
      {"SamplesMissing", table("t_ms,x_mm", gap), ":102:1: ", "4 ms after the one before; allowed is the task's"},
      {"EveryThirdSample", table("t_ms,x_mm", third), ":3:1: ", "or set `sample_period_ms` = 3 to find the filter"},
      {"OfAnotherPeriod", table("t_ms,x_mm", slower), ": ",
       "samples are 1.05 ms apart, the task's sample period is 1 ms; allowed are"},
      {"TimeInSeconds", table("t_s,x_mm", good), ":3:1: ", "1000 times as long: is the unit of the time right?"},
      {"TimeInMicroseconds", table("t_us,x_mm", good), ":3:1: ", "0.001 times as long: is the unit of the time right?"},
      {"WayInMetres", table("t_ms,x_m", good), ": ", "100 m/s; allowed are 20 m/s: are the units of the positions"},
      {"TooShort", table("t_ms,x_mm", few), ":20:1: ", "the log ends here, after 19 samples; allowed are 20 or more"},
      {"EndsMoving", table("t_ms,x_mm", ends_moving), ": ", "must begin and end at rest"},
      {"StartsMoving", table("t_ms,x_mm", starts_moving), ": ", "must begin and end at rest"},
      {"NeverMoves", table("t_ms,x_mm", std::vector<std::string>(good.begin(), good.begin() + 50)), ": ",
       "must begin and end at rest"},
      {"ShorterThanItsFilter", table("t_ms,x_mm", move_behind({40, 40}, 30)), ": ",
       "the move must be longer than the filter"},
      {"Binary", std::string("t_ms,x_mm\n0,\0\n", 14), ": ", "is not a text file"},
  };
}

class CliBadLog : public ::testing::TestWithParam<BadLog> {};

TEST_P(CliBadLog, IsNamedAndNothingIsWritten) {
  const BadLog& bad = GetParam();
  Files files;
  const std::string log = files.folder.path("log.csv");
  const Outcome done =
      files.identify(bad.text, {"--out", files.folder.path("out.toml"), "--figure", files.folder.path("figure.svg")});
  EXPECT_EQ(done.code, 2);
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, StartsWith(log + bad.position));
  EXPECT_THAT(done.err, HasSubstr(bad.message));
  EXPECT_EQ(files.folder.count(), 2U);  // log and task
}
INSTANTIATE_TEST_SUITE_P(Cli, CliBadLog, ::testing::ValuesIn(bad_logs()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST(CliIdentify, WhatIsNotConsideredIsRefused) {
  Files files;
  files.task = files.folder.write(
      "servo.toml", fmt::format("{}[[axis]]\nacceleration_max_mm_s2 = 6000\nservo_gain_1_s = 100\n", task_text));
  const Outcome done = files.identify(table("t_ms,x_mm", move_behind({22})));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("servo.toml:4:18: `servo_gain_1_s` is not considered here"));
  const Outcome none = run({"identify", files.folder.path("none.csv"), "--task", files.folder.path("task.toml")});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("none.csv: no such file"));
}

TEST(CliIdentify, TooMuchNoiseIsRefused) {
  Files files;
  std::vector<std::string> rows = move_behind({22});
  // 50 um up and down, half a sample's way.
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::size_t comma = rows[k].find(',');
    rows[k] = fmt::format("{},{:.6f}", rows[k].substr(0, comma), std::stod(rows[k].substr(comma + 1)) + 0.05 * (k % 2));
  }
  const Outcome done = files.identify(table("t_ms,x_mm", rows));
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, Not(HasSubstr("lengths")));
}

}  // namespace
}  // namespace accdec
