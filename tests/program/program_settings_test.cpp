#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/filter.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/delays/control_delays.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/simulate/direct.hpp>

#include "corner_program.hpp"
#include "program_command.hpp"
#include "reference.hpp"

// Settings of a control, chosen for a whole program.

namespace accdec {
namespace {

using test::Output;
using test::ProgramCommand;
using testing::HasSubstr;

/// Samples of the plan at the programmed feeds; unlimited if it does not hold.
double planned(Toolpath path, const Filter& filter, const Task& task) {
  const Machine machine = program_machine(task.machine, path);
  limit_rapids(path, filter, task.sample_period, machine);
  snap_durations(path, filter, task.sample_period, machine);
  const ProgramPlan plan = plan_program(path, filter, task.sample_period, machine, false);
  return all_holds(plan) ? static_cast<double>(plan.simulation.samples) : unlimited;
}

TEST(ProgramSettings, NoMemberOfTheFamilyIsPlannedFaster) {
  const Task task = test::averages_task(2, {});
  const Toolpath path = test::path_of(test::corner_program, task.machine);
  const std::optional<ProgramSettings> found = settings_for_program(path, task, true, {}, {});
  ASSERT_TRUE(found && found->complete);
  // Guesses leave little to plan.
  EXPECT_LT(found->tried, found->members / 4);
  double least = unlimited;
  for (int a = 1; a <= task.design.order_max + 1; ++a) {
    for (int b = 1; b <= a && a + b - 2 <= task.design.order_max; ++b)
      least = std::min(least, planned(path, averages(std::vector<int>{a, b}), task));
  }
  EXPECT_EQ(planned(path, make_filter(found->chosen.filter), task), least);
}

/// The delays of a plan follow from its width: the first sample of the rest in which the motion, made directly, is
/// within the width of the corner. The width holds along the path or for each axis.
TEST(ProgramSettings, OneInPositionWidthGivesAllDelays) {
  Task task = test::averages_task(1, {DelayKind::in_position, DelayKind::exact_stop});
  for (const auto& [family, feeds, by_axis] : {std::tuple(SettingFamily::averages, Feeds::keep, false),
                                               {SettingFamily::averages, Feeds::choose, true},
                                               {SettingFamily::averages, Feeds::keep, true},
                                               {SettingFamily::taps, Feeds::keep, false},
                                               {SettingFamily::taps, Feeds::choose, true}}) {
    task.settings->families = {family};
    task.settings->in_position_by_axis = by_axis;
    const int latency = by_axis ? 2 : 0;
    task.settings->in_position_latency = latency * task.sample_period;
    const TemporaryFolder folder;
    const std::string program = folder.write("part.ngc", test::corner_program);
    ProgramFileOptions options;
    options.fixed.feeds = feeds;
    ProgramFile file = read_program_file(program, task, options, {});
    const ProgramResult result = run_fixed_plan(file, task, options, {});
    ASSERT_TRUE(result.verification.feasible) << result.message;
    ASSERT_TRUE(result.settings && result.settings->chosen.width);
    const Toolpath& path = result.plan.path;
    const FilteredCommand& command = *result.plan.command();
    const DirectMotion motion = direct_motion(path, task.sample_period, command.delays, {{command.filter}, {}});
    const double width = result.settings->chosen.width->middle();
    int seen = 0;
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (result.settings->chosen.delays[b] != DelayKind::in_position) continue;
      ++seen;
      for (int d = 0; d <= command.delays[b] - latency; ++d) {
        const auto k = static_cast<std::size_t>(motion.windows[b].first + d);
        const double x = std::abs(motion.position[0][k] - path.point(b + 1)[0]),
                     y = std::abs(motion.position[1][k] - path.point(b + 1)[1]),
                     way = by_axis ? std::max(x, y) : std::hypot(x, y);
        EXPECT_EQ(way <= width, d == command.delays[b] - latency) << "line " << path.line[b] << ", sample " << d;
      }
    }
    EXPECT_GT(seen, 0);
  }
}

/// The raster with one in-position width. Curves tuned for other delays broke limits with those that the width gives.
/// Every block then ended in a stop: 45 s.
TEST(ProgramSettings, TunedCurvesAreNoSlowerThanUntunedOnesWithTheDelaysOfAWidth) {
  Task task = test::averages_task(2, {DelayKind::continuous, DelayKind::in_position, DelayKind::exact_stop});
  task.machine.axes.resize(1);  // for X, Y and Z
  task.machine.axes[0].velocity_max = 0.5;
  LineSource source(test_support::source_folder() + "/problems/program/raster.ngc");
  Toolpath path = read_toolpath(source, task.machine, {});
  const Filter filter = averages(std::vector<int>{31, 11});
  int held = 0;
  for (const double width : {0.05e-3, 0.08e-3, 0.0951613e-3, 0.12e-3, 0.2e-3, 0.335e-3}) {
    path.control = control_of(task, width);
    const double untuned = planned(path, filter, task);
    if (!(untuned < 4000.0)) continue;
    ++held;
    const ProgramResult result = run_program({"raster.ngc", path, task}, filter);
    EXPECT_TRUE(result.verification.feasible) << result.message;
    EXPECT_LE(result.cycle_time, untuned * task.sample_period * (1.0 + 1e-9)) << width;
  }
  EXPECT_GE(held, 1);
}

/// Free taps are compared as a task without a control plans them: at programmed feeds or chosen ones, with the filter
/// that suits each.
TEST(ProgramSettings, FreeTapsAreNoSlowerThanWithoutAControl) {
  Task task = test::averages_task(1, {});
  for (Axis& axis : task.machine.axes) axis.jerk_max = 500.0;
  const TemporaryFolder folder;
  const std::string program = folder.write("part.ngc",
                                           "G21 G90 G64 P0.05\nG1 X40 F6000\nX13.5145 Y6.5083\nX24.9396 Y31.2733\n"
                                           "X3.3378 Y14.6239\nX-8.9008 Y38.9971\nM2\n");
  const ProgramResult set = run_fixed_plan(read_program_file(program, task, {}, {}), task, {}, {});
  task.settings.reset();
  const ProgramResult free = run_fixed_plan(read_program_file(program, task, {}, {}), task, {}, {});
  ASSERT_TRUE(set.settings && set.settings->free_taps && free.verification.feasible);
  EXPECT_LE(*set.settings->free_taps, free.cycle_time * (1.0 + 1e-9));
  EXPECT_LE(*set.settings->free_taps, set.cycle_time);
}

/// With no time at all there still is an answer, after a few plans.
TEST(ProgramSettings, ASearchWithoutTimeAnswersWithAGuess) {
  Task task = test::averages_task(2, {DelayKind::continuous, DelayKind::in_position, DelayKind::exact_stop});
  task.machine.axes.resize(1);  // for X, Y and Z
  LineSource source(test_support::source_folder() + "/problems/program/raster.ngc");
  const Toolpath path = read_toolpath(source, task.machine, {});
  const std::optional<ProgramSettings> found = settings_for_program(path, task, true, Effort(0.0), {});
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->complete);
  EXPECT_LE(found->tried, 20);
}

/// p(d) of two averages by its definition.
TEST(ProgramSettings, TheShortestDelayOfAControlIsThatOfItsKinds) {
  const Filter filter = averages(std::vector<int>{18, 12});
  const auto way = [&](int d) {
    double sum = 0.0;
    for (int i = d + 1; i <= filter.order(); ++i) sum += filter.tap(i) * (i - d);
    return 1e-4 * sum;  // m at 100 mm/s and 1 ms
  };
  ASSERT_LT(way(15), 0.23e-3);
  ASSERT_GT(way(14), 0.23e-3);
  const ControlDelays control{{DelayKind::continuous, DelayKind::in_position, DelayKind::exact_stop}, 0.23e-3};
  EXPECT_EQ(control_delay(control, filter, 1e-4, 0), 0);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 1), 15);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 15), 15);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 16), 28);
  EXPECT_EQ(control_delay(control, filter, 1e-4, 29), 29) << "an exact stop waits a sample more than the filter";
  EXPECT_EQ(control_delay(control, filter, 1e-4, 30), std::nullopt) << "no control can be told to wait two";
  // At 45 degrees each axis has 0.71 of the way.
  ControlDelays by_axis = control;
  by_axis.by_axis = true;
  const double diagonal[] = {0.1, -0.1}, part = watched_part(by_axis, diagonal, 2, std::hypot(0.1, 0.1));
  EXPECT_NEAR(part, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(watched_part(control, diagonal, 2, std::hypot(0.1, 0.1)), 1.0);
  int first = 1;
  while (way(first) * std::sqrt(0.5) > 0.23e-3) ++first;
  EXPECT_EQ(control_delay(by_axis, filter, part * 1e-4, 1), first);
  EXPECT_LT(first, 15);
  EXPECT_EQ(control_delay({}, filter, 1e-4, 16), 16);
  EXPECT_EQ(control_delay({{DelayKind::continuous, DelayKind::dwell}, 0.0}, filter, 1e-4, 16), 16);
  EXPECT_EQ(control_delay({{DelayKind::continuous}, 0.0}, filter, 1e-4, 1), std::nullopt);
}

/// Averages of L and M have taps that rise by 1/(L M) a sample. At 100 mm/s, a jerk of 500 m/s^3 lets starts and stops
/// have L M >= 200. The legs of an exact stop are a sample apart at most. An x that goes on then has 2/(L M) there, and
/// averages of 20 and 20 are needed.
TEST_F(ProgramCommand, AnExactStopDoesNotWaitForTheJerkOfBothLegs) {
  write("part.ngc", "G21 G90 G61.1 F6000\nG0 X0 Y0\nG1 X30\nG1 X60\nG1 X90 Y20\nM2\n");
  const std::string axes = "[controller]\ndelays = \"exact-stop\"\n[[axis]]\njerk_max_mm_s3 = 500000\n";
  const std::string period = "sample_period_ms = 1\n", run_kept = "program part.ngc --feeds keep --task t.toml";
  write("t.toml", period + "[design]\nfamily = \"averages\"\nstages = 2\norder_max = 60\n" + axes);
  ASSERT_EQ(run(run_kept + " --json r.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("Set these: averages of 20 ms and 20 ms; exact-stop at 2 joints"));
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  write("t.toml", period + "[filter]\nkind = \"averages\"\nlengths = [15, 14]\n" + axes);
  // Both legs of the first joint then have v1 + v2 <= L M J T^2, and take the least time at equal feeds.
  ASSERT_EQ(run(run_kept + " --json r.json").code, 0) << read("err");
  EXPECT_THAT(read("out"), HasSubstr("An exact stop lasts until the filter is empty, or a sample longer"));
  EXPECT_EQ(run("verify r.json").code, 0) << read("out");
  const nlohmann::json record = nlohmann::json::parse(read("r.json"));
  const double both = 15 * 14 * 500.0 * 1e-6, least = 0.03 / (0.5 * both);
  const auto& durations = record["commands"]["duration_s"];
  EXPECT_NEAR(durations[0].get<double>(), least, 2e-4 * least);
  EXPECT_NEAR(durations[1].get<double>(), least, 2e-4 * least);
  for (const int delay : {0, 1}) EXPECT_LE(record["commands"]["delay_samples"][delay].get<int>(), 15 + 14 - 2 + 1);
}

TEST_F(ProgramCommand, AProgramOfAControlSaysFirstWhatToSet) {
  write("control.toml", std::string(test::corner_machine) +
                            "[controller]\nname = \"sinumerik-840d\"\n[design]\nlength_max_ms = 40\n"
                            "[filter]\nkind = \"averages\"\nlengths = [32, 32]\n");
  write("part.ngc", test::corner_program);
  ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json --emit e.ngc --figure r.html").code, 0)
      << read("err");
  const std::string out = read("out");
  EXPECT_EQ(out.find("Set these: MD32410"), 0U) << out;
  EXPECT_THAT(out, HasSubstr("Today's setting takes"));
  EXPECT_THAT(out, HasSubstr("ree taps"));
  // No plan undercuts the bound of any motion.
  const nlohmann::json record = nlohmann::json::parse(read("r.json"));
  EXPECT_GE(record["settings"]["free_taps_s"].get<double>(), record["lower_bound_s"].get<double>());
  EXPECT_THAT(read("r.html"), HasSubstr("Set these: MD32410"));
  EXPECT_THAT(read("e.ngc"), HasSubstr("; set these: MD32410"));
  EXPECT_EQ(read("e.ngc").find("\nG4 "), std::string::npos) << "the control has no dwells";
  const Output verified = run("verify r.json");
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
  // Another width gives other delays.
  std::string text = read("r.json");
  if (const std::size_t at = text.find("\"width_m\":"); at != std::string::npos) {
    EXPECT_THAT(read("e.ngc"), HasSubstr(" G9 G602\n"));
    for (const char* name : {"\"width_m\":", "\"width_low_m\":", "\"width_high_m\":"}) {
      const std::size_t value = text.find(name) + std::string(name).size();
      const double number = std::stod(text.substr(value));
      text.replace(value, text.find_first_of(",}", value) - value, std::to_string(2.0 * number));
    }
    write("forged.json", text);
    EXPECT_EQ(run("verify forged.json").code, 2);  // the answer says another one
  }
}

/// The words of the lines that move, each with what stands behind its coordinates and feed.
std::vector<std::string> words_behind_moves(const std::string& program) {
  std::vector<std::string> found;
  std::istringstream lines(program);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("G1 ") && !line.starts_with("G0 ")) continue;
    std::string behind;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const bool own = word.starts_with("G9") || word.starts_with("G60");
      if (own) behind += (behind.empty() ? "" : " ") + word;
    }
    found.push_back(behind);
  }
  return found;
}

/// The joints of the plan and the words of the program say the same, in the control's own language.
TEST_F(ProgramCommand, AProgramIsWrittenAsItsControlReadsIt) {
  write("part.ngc", "G21 G90 G64 P0.02\nG1 X30 F3000 (first)\nY30\nG61.1\nX10\nG64 P0.02\nM8\nY10\nX0\nM30\n");
  struct Language {
    std::string name, begin, remark, stop, wait;
  };
  for (const Language& language :
       {Language{"sinumerik-840d", "G710 G17 G90 G94\nG64\n", "; set these: ", "G9 G601", ""},
        Language{"beckhoff-tf5200", "G71 G17 G90 G94\nG359\n", "(set these: ", "G60", "\nG04 0."}}) {
    write("control.toml", std::string(test::corner_machine) + "[controller]\nname = \"" + language.name +
                              "\"\n[design]\nlength_max_ms = 40\n");
    ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json --emit e.ngc").code, 0)
        << read("err");
    const std::string text = read("e.ngc");
    EXPECT_THAT(text, HasSubstr(language.begin)) << language.name;
    EXPECT_THAT(text, HasSubstr(language.remark)) << language.name;
    for (const char* foreign : {"G21", "G61.1", "G64 P", "G4 P"})
      EXPECT_EQ(text.find(foreign), std::string::npos) << foreign;
    EXPECT_EQ(text.find(language.remark.front() == ';' ? "(" : "\n;"), std::string::npos) << text;
    EXPECT_THAT(text, HasSubstr("\nM8\n"));
    EXPECT_EQ(text.find("\nG04 ") != std::string::npos, !language.wait.empty()) << text;
    const auto kinds = nlohmann::json::parse(read("r.json"))["settings"]["delays"];
    const std::vector<std::string> words = words_behind_moves(text);
    ASSERT_EQ(words.size(), kinds.size()) << text;
    for (std::size_t b = 0; b + 1 < words.size(); ++b) {
      const std::string in_position = language.name == "beckhoff-tf5200" ? "G60" : "G9 G602";
      const std::string expected = kinds[b] == "continuous"    ? ""
                                   : kinds[b] == "in-position" ? in_position
                                                               : language.stop;
      EXPECT_EQ(words[b], expected) << language.name << ", move " << b << " of\n" << text;
    }
  }
}

TEST_F(ProgramCommand, ALanguageWithoutASourceIsRefusedByName) {
  write("part.ngc", test::corner_program);
  write("control.toml", std::string(test::corner_machine) + "[controller]\nname = \"fanuc-0i\"\n");
  const Output refused = run("program part.ngc --feeds keep --task control.toml --json r.json --emit e.ngc");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--emit: no source says which words FANUC Series 0i"));
  EXPECT_THAT(refused.err, HasSubstr("control.toml:"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path("e.ngc")) || std::filesystem::exists(folder_.path("r.json")));
}

/// Way over feed bounds the time of any taps. The answer in words is forged with the number, so that only the bound
/// can tell.
TEST_F(ProgramCommand, FreeTapsFasterThanAnyFilterAreRejected) {
  write("control.toml", std::string(test::corner_machine) + "[design]\nfamily = \"averages\"\nstages = 1\n");
  write("part.ngc", "G21 G90 G64 P0.05\nG1 X30 F3000\nY30\nX10\nM2\n");
  ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json").code, 0) << read("err");
  nlohmann::ordered_json record = nlohmann::ordered_json::parse(read("r.json"));
  const double bound = record["lower_bound_s"], time = record["cycle_time_s"];
  EXPECT_NEAR(bound, 80.0 / 50.0, 0.01);
  ASSERT_LT(1.01 * bound, time);
  const std::string answer = record["settings"]["answer"];
  const std::size_t begin = answer.find(" Free taps would take"), end = answer.find(" or less");
  ASSERT_TRUE(begin != std::string::npos && end != std::string::npos) << answer;
  for (const auto& [free, code] : {std::pair(1.01 * bound, 0), std::pair(0.99 * bound, 1)}) {
    record["settings"]["free_taps_s"] = free;
    record["settings"]["answer"] =
        fmt::format("{} Free taps would take {:.6g} s ({:.1f} % less){}", answer.substr(0, begin), free,
                    100.0 * (1.0 - free / time), answer.substr(end));
    write("forged.json", record.dump());
    const Output verified = run("verify forged.json");
    EXPECT_EQ(verified.code, code) << verified.out << verified.err;
    EXPECT_EQ(verified.out.find("settings.free_taps_s is below the bound of any filter") != std::string::npos,
              code == 1);
  }
}

/// The number of a grid may be the smallest that can be set, and the answer counts the samples between impulses.
TEST_F(ProgramCommand, ResultsOfEveryFamilyAreVerified) {
  write("part.ngc", "G21 G90 G64 P0.05\nG1 X30 F3000\nY30\nX10\nM2\n");
  const std::string mode = "[[mode]]\nfrequency_Hz = 40\nresidual_max = 0.05\n";
  for (const auto& [family, more, modes] :
       {std::tuple<std::string, std::string, std::string>{"gaussian", "alpha_step = 6\n", ""},
        {"gaussian", "", ""},
        {"exponential", "time_constant_step_ms = 40\n", ""},
        {"windowed-sinc", "cutoff_step_Hz = 20\n", ""},
        {"averages", "stages = 2\n", ""},
        {"one-pole", "", ""},
        {"shaper", "shaper = \"zv\"\nstages = 1\n", mode},
        {"shaper", "shaper = \"ei\"\nstages = 1\n", mode},
        {"shaper", "shaper = \"mzv\"\nstages = 1\nshaper_frequency_step_Hz = 1.7\n", mode}}) {
    write("control.toml",
          std::string(test::corner_machine) + modes + "[design]\nfamily = \"" + family + "\"\norder_max = 60\n" + more);
    ASSERT_EQ(run("program part.ngc --feeds keep --task control.toml --json r.json").code, 0) << family << read("err");
    const Output verified = run("verify r.json");
    EXPECT_EQ(verified.code, 0) << family << verified.out << verified.err;
  }
}

TEST_F(ProgramCommand, PlansOfPositionsAreRefusedForAControlWithOneFilter) {
  write("part.ngc", test::corner_program);
  for (const char* control :
       {"[design]\nfamily = \"averages\"\nstages = 2\n", "[controller]\ndelays = \"in-position\"\n"}) {
    write("control.toml", std::string(test::corner_machine) + control);
    for (const char* plan : {"profiles", "free"}) {
      const Output refused = run("program part.ngc --plan " + std::string(plan) + " --task control.toml --json r.json");
      EXPECT_EQ(refused.code, 2) << plan;
      EXPECT_THAT(refused.err, HasSubstr("use --plan fixed"));
    }
  }
}

/// Up to 3 ms, an average passes vibrations of 20 Hz nearly whole.
TEST_F(ProgramCommand, AFamilyWithoutASettingThatHoldsIsSaid) {
  write("control.toml", std::string(test::corner_machine) +
                            "[design]\nfamily = \"averages\"\nstages = 1\nlength_max_ms = 3\n"
                            "[[mode]]\nfrequency_Hz = [18, 22]\nresidual_max = 0.05\n");
  write("part.ngc", test::corner_program);
  const Output none = run("program part.ngc --feeds keep --task control.toml --json r.json");
  EXPECT_EQ(none.code, 1);
  EXPECT_THAT(none.err, HasSubstr("control.toml:9:10: no setting of 1 average that was planned holds all limits"));
  EXPECT_THAT(none.err, HasSubstr("at programmed feeds, the closest, one average of 3 ms, breaks jerk"));
  EXPECT_THAT(none.err, HasSubstr("the nearest that do"));
}

// At a thousandth of the feed, 33 um/s, a corner passed without waiting leaves out more than a nanometre with any
// filter: no setting holds, and there are thousands.
TEST_F(ProgramCommand, ATimeLimitEndsASearchInWhichNoSettingHolds) {
  write("control.toml",
        "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 39.4\nacceleration_max_mm_s2 = 313\n"
        "jerk_max_mm_s3 = 5156\n[design]\nfamily = \"averages\"\n[controller]\n"
        "delays = [\"continuous\"]\n");
  write("part.ngc", "G21 G90 G64 P0.000001 F2000\nG1 X5\nG1 Y5\nM2\n");
  const auto began = std::chrono::steady_clock::now();
  const Output none = run("program part.ngc --task control.toml --time-limit 1 --json r.json");
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), 30.0);
  EXPECT_EQ(none.code, 1) << none.out;
  EXPECT_THAT(none.out, HasSubstr("the control has no delays with which a plan holds all limits"));
}

}  // namespace
}  // namespace accdec
