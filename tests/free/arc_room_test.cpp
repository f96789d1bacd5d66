// Tolerances hold for arcs, not only for the ends of their chords.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plan/run/fixed_plan.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/verify/verify_program_result.hpp>

#include "../program/reference.hpp"
#include "support/temporary_folder.hpp"

namespace accdec::arc_room_test {
namespace {

constexpr double pi = std::numbers::pi, T = 1e-3;

struct Circle {
  double x, radius, begin, turn, tolerance;  // m, rad
};

/// Two arcs within a tolerance and one on the exact path, which the second one meets without a corner.
struct Loops {
  double tolerance;  // mm
  std::string program() const {
    return fmt::format(
        "G21 G90 G17 G64 P{} F6000\nG1 X4\nG3 X-4 I-4\nG3 X4.8 I4.4\nG61.1\nG3 X-3.2 I-4\nG64 P0.05\nG1 Y-5\nM2\n",
        tolerance);
  }
  std::vector<Circle> circles() const {
    const double wide = 1e-3 * tolerance;
    return {{0.0, 4e-3, 0.0, pi, wide}, {0.4e-3, 4.4e-3, pi, pi, wide}, {0.8e-3, 4e-3, 0.0, pi, 2e-6}};
  }
};

double distance(const Sample& a, const Sample& b, double x, double y) {
  const double ux = b.position[0] - a.position[0], uy = b.position[1] - a.position[1], length2 = ux * ux + uy * uy;
  const double px = x - a.position[0], py = y - a.position[1];
  const double t = length2 > 0.0 ? std::clamp((px * ux + py * uy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(px - t * ux, py - t * uy);
}

/// Points of the circles in their order against the polyline through the samples.
void expect_on_circles(const ProgramResult& result, const Loops& loops) {
  std::vector<Sample> samples;
  Motion motion(result.plan, T);
  for (Sample sample; motion.next(sample);) samples.push_back(sample);
  std::size_t at = 0;
  for (const Circle& circle : loops.circles()) {
    constexpr int parts = 400;
    for (int i = 1; i < parts; ++i) {
      const double angle = circle.begin + circle.turn * i / parts;
      const double x = circle.x + circle.radius * std::cos(angle), y = circle.radius * std::sin(angle);
      double least = unlimited;
      std::size_t best = at;
      // Not farther than 0.5 mm behind the nearest place: the loops cross each other.
      double way = 0.0;
      for (std::size_t k = at; k + 1 < samples.size() && (way < 0.5e-3 || least > 0.1e-3); ++k) {
        const double off = distance(samples[k], samples[k + 1], x, y);
        if (off < least) least = off, best = k, way = 0.0;
        way += std::hypot(samples[k + 1].position[0] - samples[k].position[0],
                          samples[k + 1].position[1] - samples[k].position[1]);
      }
      at = best;
      ASSERT_LE(least, circle.tolerance + 1e-9) << loops.program() << result.plan.name() << " " << angle;
    }
  }
}

class ArcRoom : public testing::TestWithParam<double> {};

TEST_P(ArcRoom, EveryPlanStaysWithinTheToleranceOfTheArcs) {
  const Loops loops{GetParam()};
  Task task;
  task.sample_period = T;
  task.machine = test::machine_of(5.0, loops.tolerance > 0.01 ? unlimited : 200.0, 0.5, 3);
  task.filter = FilterSpec{};
  task.filter->kind = Shape::boxcar;
  task.filter->order = 20;
  const TemporaryFolder folder;
  const std::string name = folder.write("part.ngc", loops.program());
  const ProgramFile file = read_program_file(name, task, {}, {});
  ProgramFileOptions quick;
  quick.free.sweeps = 1;
  for (const ProgramResult& result : {run_fixed_plan(file, task, {}, {}), plan_profiles_of({name, file.path, task}),
                                      run_free_plan(file, task, quick, {})}) {
    EXPECT_TRUE(result.verification.feasible) << result.message;
    expect_on_circles(result, loops);
    ASSERT_TRUE(result.arcs);
    EXPECT_LE(result.arcs->error, result.arcs->tolerance * (1.0 + 1e-9));
    const ProgramResultCheck check = verify_program_result(result, task);
    EXPECT_THAT(check.reasons, testing::IsEmpty());
    EXPECT_NEAR(check.found.arcs->error, result.arcs->error, 1e-12);
    EXPECT_EQ(check.found.arcs->line, result.arcs->line);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ArcRoom, testing::Values(0.05, 0.004));

// The sum of a joint's tolerance and of the largest distance of a chord beside it is the program's.
TEST(ArcRoomOfJoints, IsWhatTheirChordsNeed) {
  const Machine machine = test::machine_of(1.0);
  for (const double tolerance : {0.05, 0.004, 0.001}) {
    const Toolpath path = test::path_of(Loops{tolerance}.program(), machine);
    ASSERT_EQ(path.arcs.size(), 3U);
    for (std::size_t i = 0; i < 2; ++i) {
      const PathArc& arc = path.arcs[i];
      const double off = arc.radius * (1.0 - std::cos(0.5 * arc.angle / (arc.last - arc.first + 1.0)));
      EXPECT_LE(off, 0.125e-3 * tolerance);
      for (std::size_t b = arc.first; b < arc.last; ++b) EXPECT_NEAR(path.tolerance[b] + off, 1e-3 * tolerance, 1e-12);
      EXPECT_LE(path.tolerance[arc.first - 1] + off, 1e-3 * tolerance + 1e-12);  // of the line that meets it
    }
    // The exact arc begins without a corner: its own tolerance holds from its first point on.
    const PathArc& exact = path.arcs[2];
    EXPECT_LE(path.tolerance[exact.first - 1], 2e-6);
    EXPECT_LE(path.tolerance[exact.first], 2e-6);
    EXPECT_GT(path.narrowed, 0.0);
  }
  EXPECT_EQ(test::path_of("G64 P0.05 F6000\nG1 X5\nG1 Y5\nM2\n", machine).narrowed, 0.0);
}

}  // namespace
}  // namespace accdec::arc_room_test
