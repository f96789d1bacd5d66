#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/task.hpp>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string task_text(const std::string& controller, const std::string& design = "", double period_ms = 1.0) {
  return fmt::format(
      "sample_period_ms = {}\n[design]\n{}\n[controller]\n{}\n[[axis]]\nacceleration_max_mm_s2 = 5000\n"
      "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\nerror_max_um = 50\n",
      period_ms, design, controller);
}

ControllerSettings settings_in(const std::string& text) {
  const Task task = parse_task(text, "task.toml");
  return task.settings.value_or(ControllerSettings{});
}

std::string refusal(const std::string& text) {
  try {
    parse_task(text, "task.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

constexpr const char* own = R"(title = "Mine, \"quoted\""
family = "averages"
delays = "in-position"
[[stage]]
parameter = "P1"
unit = "x 0.5 ms"
unit_ms = 0.5
length_step_ms = 0.5
length_max_ms = 20
[[source]]
fact = "one average"
where = "own measurement"
)";

TEST(Controllers, EveryShippedOneHasItsSources) {
  const std::filesystem::path folder = test_support::source_folder() + "/problems/controllers";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path());
    ++files;
    const Controller shipped = parse_controller(read_text_file(entry.path().string()), entry.path().string());
    const Controller built_in = find_controller(entry.path().stem().string());
    EXPECT_EQ(built_in.title, shipped.title);
    EXPECT_EQ(built_in.stages.size(), shipped.stages.size());
    EXPECT_FALSE(built_in.sources.empty());
    for (const ControllerSource& source : built_in.sources) {
      EXPECT_FALSE(source.fact.empty());
      EXPECT_TRUE(source.where.find("page ") != std::string::npos || source.where.find("http") != std::string::npos ||
                  source.where.find("man 1") != std::string::npos || source.where.find("measured") != std::string::npos)
          << source.where;
    }
    if (built_in.delays.empty()) {
      EXPECT_FALSE(built_in.unknown.empty()) << "delays that are not known are to be said";
    }
    const Task task = parse_task(task_text(fmt::format("name = \"{}\"", built_in.name)), "task.toml");
    ASSERT_TRUE(task.settings);
    EXPECT_EQ(task.settings->controller, built_in.title);
    EXPECT_EQ(task.settings->families, built_in.families);
  }
  EXPECT_EQ(files, controllers().size());
  EXPECT_GE(files, 10U);
}

TEST(Controllers, ATaskTakesItsSettings) {
  const ControllerSettings siemens = settings_in(task_text("name = \"sinumerik-840d\""));
  EXPECT_THAT(siemens.families, ElementsAre(SettingFamily::averages));
  EXPECT_THAT(siemens.delays, ElementsAre(DelayKind::continuous, DelayKind::in_position, DelayKind::exact_stop));
  ASSERT_EQ(siemens.stages.size(), 2U);
  EXPECT_THAT(siemens.stages[0].name, StartsWith("MD32410"));
  EXPECT_EQ(siemens.stages[1].unit, "s");
  EXPECT_EQ(siemens.stages[1].unit_seconds, 1.0);
  // 16 cycles of the control.
  EXPECT_DOUBLE_EQ(settings_in(task_text("name = \"sinumerik-808d\"", "", 2.0)).stages[0].length_max, 0.032);
  // Powers of two, of which 0.5 ms is no multiple of the period.
  const std::vector<double> set = settings_in(task_text("name = \"kollmorgen-akd\"")).stages[0].length_set;
  EXPECT_EQ(set.size(), 10U);
  EXPECT_DOUBLE_EQ(set.front(), 1e-3);
  EXPECT_DOUBLE_EQ(set.back(), 0.512);
}

TEST(Controllers, StepsBecomeWholeSamples) {
  // 0.1 ms in a task of 1 ms: 1 ms. In one of 0.25 ms: 0.5 ms, the least common multiple.
  EXPECT_DOUBLE_EQ(settings_in(task_text("name = \"panasonic-a5\"")).stages[0].length_step, 1e-3);
  EXPECT_DOUBLE_EQ(settings_in(task_text("name = \"panasonic-a5\"", "", 0.25)).stages[0].length_step, 5e-4);
  EXPECT_THAT(refusal(task_text("name = \"panasonic-a5\"", "", 0.0314159)),
              HasSubstr("no time of Pr2.23 positional command FIR filter is a multiple of the sample period"));
}

TEST(Controllers, KeysOfTheTaskOverride) {
  const std::string name = "name = \"sinumerik-840d\"\n";
  const ControllerSettings capped = settings_in(task_text(name, "length_max_ms = [30, 12]\nlength_step_ms = 2"));
  EXPECT_DOUBLE_EQ(capped.stages[0].length_max, 0.030);
  EXPECT_DOUBLE_EQ(capped.stages[1].length_max, 0.012);
  EXPECT_DOUBLE_EQ(capped.stages[1].length_step, 0.002);
  EXPECT_THAT(capped.stages[1].name, StartsWith("MD32411"));
  EXPECT_EQ(settings_in(task_text(name, "stages = 1")).stages.size(), 1U);
  EXPECT_THAT(settings_in(task_text(name + "delays = \"exact-stop\"")).delays, ElementsAre(DelayKind::exact_stop));
  EXPECT_THAT(refusal(task_text(name, "stages = 3")),
              StartsWith("task.toml:3:10: `stages` = 3, but the controller has 2"));
  EXPECT_THAT(refusal(task_text("name = \"kollmorgen-akd\"", "length_max_ms = 4")),
              HasSubstr("allowed is `length_set_ms`"));
  EXPECT_EQ(settings_in(task_text("name = \"kollmorgen-akd\"", "length_set_ms = [2, 4]")).stages[0].length_set.size(),
            2U);
}

/// A maker's list begins with 0, which is off. A stage is off without it, too.
TEST(Controllers, ASetMayHaveOff) {
  const std::string family = "family = \"averages\"\nstages = 2\n";
  const ControllerSettings listed = settings_in(task_text("", family + "length_set_ms = [4, 0, 2]"));
  EXPECT_THAT(listed.stages[1].length_set, ElementsAre(0.002, 0.004));
  EXPECT_THAT(settings_in(task_text("", family + "length_set_2_ms = [0, 2]")).stages[1].length_set, ElementsAre(0.002));
  EXPECT_THAT(refusal(task_text("", family + "length_set_2_ms = [0]")),
              StartsWith("task.toml:5:19: `length_set_2_ms` = 0 turns stage 2 off; allowed is a smaller number"));
  const std::string times = "length_step_ms = 0.5\nlength_max_ms = 20";
  std::string mine = own;
  mine.replace(mine.find(times), times.size(), "length_set_ms = [0]");
  EXPECT_THROW(parse_controller(mine, "mine.toml"), InputError);
}

TEST(Controllers, AFileOfOnesOwnLiesBesideTheTask) {
  const TemporaryFolder folder;
  folder.write("mine.toml", own);
  for (const char* key : {"file", "name"}) {
    const std::string path = folder.write("task.toml", task_text(fmt::format("{} = \"mine.toml\"", key)));
    const ControllerSettings settings = read_task(path).settings.value();
    EXPECT_EQ(settings.controller, "Mine, \"quoted\"");
    EXPECT_DOUBLE_EQ(settings.stages.at(0).length_step, 1e-3);
    EXPECT_DOUBLE_EQ(settings.stages.at(0).unit_seconds, 5e-4);
  }
  const std::string missing = folder.write("task.toml", task_text("file = \"none.toml\""));
  EXPECT_THROW(read_task(missing), InputError);
}

/// A control that looks at measured positions needs to know how they lag; an exact stop looks at none.
TEST(Controllers, AFileThatMeasuresNeedsAServo) {
  const TemporaryFolder folder;
  std::string text = own;
  text.replace(text.find("\"in-position\""), 13, "[\"in-position\", \"exact-stop\"]\nin_position_of = \"actual\"");
  folder.write("mine.toml", text);
  const auto read = [&](const std::string& more) {
    const std::string path = folder.write("task.toml", task_text("file = \"mine.toml\"\n" + more));
    return read_task(path, {.response = Considered::all});
  };
  EXPECT_TRUE(read("[[axis]]\nservo_gain_1_s = 100").settings->in_position_actual);
  EXPECT_FALSE(read("in_position_of = \"command\"").settings->in_position_actual);
  EXPECT_NO_THROW(read("delays = \"exact-stop\""));
  try {
    read("");
    ADD_FAILURE() << "an unknown lag";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("task.toml:5:8: `in_position_of` = \"actual\", but no axis says how"));
  }
}

TEST(Controllers, AFileSaysThatTheControlInterpolates) {
  const TemporaryFolder folder;
  std::string text = own;
  text.replace(text.find("\"averages\""), 10, "\"shaper\"\nshaper = \"mzv\"\nshaper_frequency_step_Hz = 0.5");
  folder.write("mine.toml", text);
  const std::string path = folder.write("task.toml", task_text("file = \"mine.toml\""));
  const Task task = read_task(path);
  EXPECT_EQ(task.settings->shaper_frequency_step, 0.5);
  EXPECT_EQ(parse_task(task_to_toml(task), "again.toml").settings->shaper_frequency_step, 0.5);
  text.replace(text.find("= 0.5"), 5, "= 1e-9");
  folder.write("mine.toml", text);
  try {
    read_task(path);
    ADD_FAILURE() << "a billion frequencies";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("task.toml:5:8: its step of 1e-09 Hz gives more than 10000 frequencies"));
  }
}

TEST(Controllers, WrittenTasksNeedNoFile) {
  const TemporaryFolder folder;
  folder.write("mine.toml", own);
  const Task task = read_task(folder.write("task.toml", task_text("file = \"mine.toml\"")));
  const Task again = parse_task(task_to_toml(task), "elsewhere/again.toml");
  ASSERT_TRUE(again.settings);
  EXPECT_EQ(again.settings->controller, task.settings->controller);
  EXPECT_EQ(again.settings->delays, task.settings->delays);
  ASSERT_EQ(again.settings->stages.size(), 1U);
  const SettableStage &a = again.settings->stages[0], &b = task.settings->stages[0];
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.unit_seconds, b.unit_seconds);
  EXPECT_EQ(a.length_step, b.length_step);
  EXPECT_EQ(a.length_max, b.length_max);
  EXPECT_EQ(task_to_toml(again), task_to_toml(task));
}

TEST(Controllers, OpensNoFileWhereNoneMayBeNamed) {
  const TemporaryFolder folder;
  folder.write("mine.toml", own);
  const std::string path = folder.path("task.toml");
  for (const std::string key : {"file", "name"}) {
    const std::string text = task_text(key + " = \"mine.toml\"");
    EXPECT_TRUE(parse_task(text, path).settings);
    EXPECT_THAT([&] { parse_task(text, path, {.controller_files = false}); },
                ::testing::ThrowsMessage<InputError>(StartsWith(path + ":5:8: `" + key + "` names a file")));
  }
  EXPECT_TRUE(parse_task(task_text("name = \"sinumerik-840d\""), path, {.controller_files = false}).settings);
}

TEST(Controllers, AnUnknownOneGetsTheListAndASuggestion) {
  const std::string message = refusal(task_text("name = \"sinumerik-840\""));
  EXPECT_THAT(message,
              StartsWith("task.toml:5:8: unknown controller \"sinumerik-840\"; did you mean \"sinumerik-840d\"?"));
  EXPECT_THAT(message, HasSubstr("kollmorgen-akd"));
  EXPECT_THAT(refusal(task_text("name = \"linuxcnc\"\nfile = \"mine.toml\"")), HasSubstr("allowed is either"));
  EXPECT_THAT(refusal(task_text("file = \"mine.json\"")), HasSubstr("must end in .toml"));
  EXPECT_THAT(refusal(task_text("delays = \"dwell\"\nparameter_units = \"s\"")), HasSubstr("goes with `parameters`"));
  EXPECT_THAT(refusal(task_text("name = \"sinumerik-840d\"\nparameters = \"P\"")), HasSubstr("one a stage is needed"));
}

TEST(Controllers, MalformedFiles) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = own;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const auto message = [](const std::string& text) -> std::string {
    try {
      parse_controller(text, "mine.toml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(own), "");
  EXPECT_THAT(message(""), HasSubstr("title"));
  EXPECT_THAT(message(changed("\"averages\"", "\"avrages\"")), HasSubstr("mine.toml:2:10"));
  EXPECT_THAT(message(changed("\"averages\"", "\"taps\"")), HasSubstr("free taps have no [[stage]]"));
  EXPECT_THAT(message(changed("unit_ms = 0.5", "unit_ms = 0")), HasSubstr("mine.toml:7:11"));
  // A number of Hz falls as the time grows.
  EXPECT_THAT(message(changed("unit = \"x 0.5 ms\"", "unit = \"Hz\"")), HasSubstr("is a unit of frequencies"));
  const std::string second = "\n[[stage]]\nparameter = \"P2\"\nunit_ms = 1\n";
  const std::string gaussian = changed("\"averages\"", "\"gaussian\"");
  EXPECT_EQ(message(gaussian), "");
  const auto line = std::count(gaussian.begin(), gaussian.end(), '\n') + 2;
  EXPECT_THAT(message(gaussian + second), StartsWith(fmt::format("mine.toml:{}:1: a second [[stage]]", line)));
  EXPECT_EQ(message(changed("\"averages\"", "[\"gaussian\", \"averages\"]") + second), "");
  EXPECT_THAT(message(changed("length_max_ms = 20", "length_max_ms = nan")), HasSubstr("mine.toml:9:17"));
  EXPECT_THAT(message(changed("length_max_ms = 20", "length_max_ms = 0.2")), HasSubstr("below `length_step_ms`"));
  EXPECT_THAT(message(changed("length_max_ms = 20", "length_set_ms = [1]")), HasSubstr("are both given"));
  EXPECT_THAT(message(changed("parameter = \"P1\"\n", "")), HasSubstr("parameter"));
  EXPECT_THAT(message(std::string(own).substr(0, std::string(own).find("[[source]]"))),
              HasSubstr("nothing counts as a fact without one"));
  EXPECT_THAT(message(changed("where = \"own measurement\"", "")), HasSubstr("where"));
  EXPECT_THAT(message(changed("delays = \"in-position\"", "delays = [\"exact-stop\", \"exact-stop\"]")),
              HasSubstr("mine.toml:3:25: `delays` names \"exact-stop\" twice"));
  EXPECT_THAT(message(changed("delays = \"in-position\"", "delays = \"in-position\"\ndelay_words = [\"G9\", \"G60\"]")),
              HasSubstr("`delay_words` has 2, and `delays` has 1"));
  EXPECT_THAT(message(std::string(own) + "[dialect]\ncomment = \";\"\n"), HasSubstr("goes with `delay_words`"));
}

TEST(Controllers, SayHowTheirProgramsAreWritten) {
  const std::string name = "name = \"sinumerik-840d\"\n";
  const ControllerSettings siemens = settings_in(task_text(name));
  EXPECT_EQ(siemens.word_of(DelayKind::in_position), "G9 G602");
  EXPECT_EQ(siemens.word_of(DelayKind::dwell), "");
  ASSERT_TRUE(siemens.dialect);
  EXPECT_EQ(siemens.dialect->metric, "G710");
  EXPECT_THAT(settings_in(task_text(name + "delays = \"exact-stop\"")).delay_words, ElementsAre("G9 G601"));
  EXPECT_THAT(settings_in(task_text(name + "delays = \"exact-stop\"\ndelay_words = \"G9\"")).delay_words,
              ElementsAre("G9"));
  const Task task = parse_task(task_text(name), "task.toml");
  EXPECT_EQ(parse_task(task_to_toml(task), "again.toml").settings->delay_words, siemens.delay_words);
  EXPECT_FALSE(settings_in(task_text("name = \"fanuc-0i\"")).dialect);
}

}  // namespace
}  // namespace accdec
