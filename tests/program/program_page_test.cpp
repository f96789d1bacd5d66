#include <cmath>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec {
namespace {

ProgramResult planned(const std::string& text) {
  Task task;
  task.sample_period = 1e-3;
  Axis axis;
  axis.name = "all";
  axis.velocity_max = 0.2;
  axis.acceleration_max = 1.0;
  task.machine.axes = {axis};
  LineSource source("test.ngc", text);
  return run_profiles({"test", read_toolpath(source, task.machine, {}), task});
}

TEST(TimeLost, IsWhatTheMotionTakesBeyondWayOverFeed) {
  const double feed = 0.1;
  const ProgramResult result = planned("G64 P0.05 F6000\nG1 X30\nG1 Y30\nG1 X60 Y50\nM2\n");
  ASSERT_TRUE(result.verification.feasible);
  double samples = 0.0, way = 0.0, x = 0.0, y = 0.0;
  visit_samples(result, [&](std::int64_t k, const double* at, const double*) {
    way += std::hypot(at[0] - x, at[1] - y);
    x = at[0], y = at[1];
    samples = static_cast<double>(k);
  });
  const std::vector<CornerLoss> classes = time_lost(result.plan.path, motion_of(result));
  double sum = 0.0;
  long joints = 0;
  for (const CornerLoss& loss : classes) {
    sum += loss.time;
    joints += loss.count;
    EXPECT_GE(loss.time, -1e-12);
  }
  EXPECT_EQ(joints, 3);
  EXPECT_NEAR(sum, samples * 1e-3 - way / feed, 1e-9);
  // Turns of 90 and 56.3 degrees, and the stop at the end.
  EXPECT_EQ(classes[4].count, 1);
  EXPECT_EQ(classes[3].count, 1);
  EXPECT_EQ(classes.back().count, 1);
  // Start and stop lose v/(2 a) each, a along the last leg by what its x has; a sample or two are rounding.
  const double along = 1.0 / (30.0 / std::hypot(30.0, 20.0));
  EXPECT_NEAR(classes.back().time, 0.5 * feed + 0.5 * feed / along, 2e-3);
}

// A corner cut short is shorter: what it loses is the speed along the motion's own way. Without a delay, an average of
// n samples turns from one leg into the other along (1 - k/n, k/n) of the feed.
TEST(TimeLost, OfACornerCutShortIsLostAlongTheMotion) {
  constexpr int n = 40;
  Task task;
  task.sample_period = 1e-3;
  LineSource source("test.ngc", "G64 P10 F6000\nG1 X30\nG1 Y30\nM2\n");
  const ProgramResult result = run_program({"test", read_toolpath(source, {}, {}), task}, boxcar(n - 1));
  ASSERT_TRUE(result.verification.feasible) << result.message;
  ASSERT_EQ(result.delay_total, 0.0);
  double corner = 0.0;
  for (int k = 1; k < n; ++k) corner += 1e-3 * (1.0 - std::hypot(1.0 - double(k) / n, double(k) / n));
  const std::vector<CornerLoss> classes = time_lost(result.plan.path, motion_of(result));
  EXPECT_NEAR(classes[4].time, corner, 1e-12);
  EXPECT_NEAR(classes.back().time, 1e-3 * n, 1e-9);  // (n - 1)/2 samples at each end, and the last one at rest
  EXPECT_EQ(classes[4].count, 1);
}

// A fast leg into a slow one, cut short by half a millimetre: each sample counts at the feed of the leg it is nearer
// to.
TEST(TimeLost, OfFastAndSlowLegsCutShortIsNotNegative) {
  for (const char* moves : {"G1 X20 F6000\nY20 F200\nX0 F6000\n", "G0 X20\nG1 Y10 F200\nG0 X0 Y0\n"}) {
    const ProgramResult result = planned("G64 P0.5\n" + std::string(moves) + "M2\n");
    ASSERT_TRUE(result.verification.feasible);
    double lost = 0.0;
    for (const CornerLoss& loss : time_lost(result.plan.path, motion_of(result))) {
      EXPECT_GE(loss.time, -1e-9) << moves << class_name(loss);
      lost += loss.time;
    }
    EXPECT_LT(lost, result.cycle_time);
  }
}

// The program alone says what cannot be lost: its way at its feeds. Every sample of a motion that keeps to its path has
// the feed of its own block, however the path turns back on itself.
TEST(TimeLost, OfPathsThatTurnBackIsTheTimeBeyondTheirFeeds) {
  const std::string start = "G61.1 F600\n";
  for (const std::string& moves :
       {std::string("G0 X10\nG1 Z-20 F200\nG0 Z0\nG0 X20\nG1 Z-20\nG0 Z0\n"),
        std::string("G1 Z-2 F200\nG0 Z0\nG0 Z-1.8\nG1 Z-4\nG0 Z0\nG0 Z-3.8\nG1 Z-6\nG0 Z0\n"),
        std::string("G1 X50\nG1 X0 F6000\nX50 F600\nX0 F6000\nX30\n"),
        std::string("G1 X9\nX1 F3000\nG1 Y9 F600\nX9\nX0 Y0 F6000\n")}) {
    for (const bool blended : {false, true}) {
      const ProgramResult result = planned((blended ? "G64 P0.001 F600\n" : start) + moves + "M2\n");
      ASSERT_TRUE(result.verification.feasible) << moves;
      double programmed = 0.0, lost = 0.0;
      for (const double duration : result.plan.path.duration) programmed += duration;
      for (const CornerLoss& loss : time_lost(result.plan.path, motion_of(result))) {
        EXPECT_GE(loss.time, -1e-9) << moves;
        lost += loss.time;
      }
      // Blended, the motion leaves out less than 2 um at each corner, at 200 mm/min or more.
      const double way_left_out = blended ? 2e-6 * static_cast<double>(result.plan.path.blocks()) / (0.2 / 60.0) : 0.0;
      EXPECT_NEAR(lost, result.cycle_time - programmed, 1e-9 + way_left_out) << moves;
    }
  }
}

// A dwell is asked for: it is not lost, and it makes nothing else so, whichever plan drives it.
TEST(TimeLost, LeavesOutDwells) {
  const auto lost = [](const ProgramResult& result) {
    double sum = 0.0;
    for (const CornerLoss& loss : time_lost(result.plan.path, motion_of(result))) sum += loss.time;
    return sum;
  };
  const auto moves = [](const char* first, const char* between, const char* last) {
    return std::string("G61.1 F600\n") + first + "G1 X10\n" + between + "Y5\nX0 Y0\n" + last + "M2\n";
  };
  const std::string dwells = moves("G4 P0.7\n", "G4 P1.5\nG4 P0.25\n", "G4 P40\n"), none = moves("", "", "");
  const auto profiles = [](const std::string& text) { return planned(text); };
  const auto fixed = [](const std::string& text) {
    Task task;
    task.sample_period = 1e-3;
    LineSource source("test.ngc", text);
    return run_program({"test", read_toolpath(source, {}, {}), task}, boxcar(20));
  };
  const auto compare = [&](const auto& plan) {
    const ProgramResult with = plan(dwells), without = plan(none);
    ASSERT_TRUE(with.verification.feasible && without.verification.feasible);
    EXPECT_NEAR(with.cycle_time, without.cycle_time + 42.45, 1e-9) << with.plan.name();
    EXPECT_NEAR(lost(with), lost(without), 1e-9) << with.plan.name();
  };
  compare(profiles);
  compare(fixed);
}

// Bounds stand beside the names of their classes of motions.
TEST(ProgramPage, NamesItsBoundsAndWhatTheyHoldFor) {
  ProgramResult result = planned("G64 P0.1 F6000\nG1 X50\nG1 Y50\nM2\n");
  ASSERT_TRUE(result.verification.feasible);
  result.corner_bound.emplace();
  result.corner_bound->time = result.cycle_time;
  result.corner_bound->any_motion = 0.5 * result.cycle_time;
  const std::string page = program_page(result.plan.path, {}, result, ViewFrom::automatic);
  const std::size_t at = page.find("Lower bounds of the time"), end = page.find("</table>", at);
  ASSERT_NE(at, std::string::npos);
  const std::string table = page.substr(at, end - at);
  for (const char* words : {"way over feed", "any motion", "50.00", "even if it swings out before a corner",
                            "monotone legs", "100.00", "sums of legs that never run back"})
    EXPECT_NE(table.find(words), std::string::npos) << words << " in " << table;
  // The rows have one line each; more words about a bound stand below the table.
  const std::size_t below = page.find("<p>monotone legs: free motions may be faster; ", end);
  EXPECT_NE(below, std::string::npos);
  EXPECT_EQ(table.find("free motions"), std::string::npos) << table;
}

// A rapid move at 200 mm/s, one of 600 mm/min: the colours are for the latter.
TEST(ProgramPage, ItsColoursAreForFeedMoves) {
  Machine machine;
  machine.axes.resize(1);
  machine.axes[0].name = "all";
  machine.axes[0].velocity_max = 0.2;
  machine.axes[0].acceleration_max = 1.0;
  const ProgramResult result = planned("G61.1 F600\nG0 X100\nG1 X101\nM2\n");
  ASSERT_TRUE(result.verification.feasible);
  const std::string page = program_page(result.plan.path, machine, result, ViewFrom::automatic);
  const std::size_t at = page.find("feed:");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(page.substr(at + 5)), 10.0, 1e-2);
}

}  // namespace
}  // namespace accdec
