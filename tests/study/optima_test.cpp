#include <gmock/gmock.h>

#include <accdec/family.hpp>
#include <accdec/study/optima.hpp>
#include <accdec/study/optima_report.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using study::find_optimum;
using study::Optimum;
using ::testing::HasSubstr;

Task corner_task(Axis axis, double tolerance) {
  return testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), tolerance);
}

// With an acceleration limit alone the boxcar of ceil(v/(a T)) taps is the fastest start, and no filter does better at
// equal N + d.
TEST(Optima, TheBoxcarIsTheOptimumOfAnAccelerationLimit) {
  Axis axis;
  axis.acceleration_max = 6.0;
  Task task = corner_task(axis, 1e-9);  // as good as an exact stop: d = N
  const Optimum o = find_optimum("stop", task, {});
  EXPECT_EQ(o.design.status, Status::optimal);
  EXPECT_TRUE(o.accepted) << o.objection;
  EXPECT_GT(o.certificate_bytes, 0U);
  EXPECT_EQ(o.design.certificate, nullptr);
  // 0.1 m/s at 6 m/s^2 and 1 ms: 17 taps, N = 16, both legs apart from d = 16 on.
  EXPECT_DOUBLE_EQ(o.samples(), 32.0);
  ASSERT_TRUE(o.saving().has_value());
  EXPECT_NEAR(*o.saving(), 0.0, 1e-9);
  // Every Hann of the same peak is longer: its mean tap is half its largest.
  const auto family = [&](const char* name) -> const FamilyResult& {
    return o.families.at(static_cast<std::size_t>(find_family(name) - families().data()));
  };
  ASSERT_TRUE(family("boxcar").result.filter.has_value());
  EXPECT_NEAR(family("boxcar").result.cycle_time, 33e-3, 1e-12);
  EXPECT_TRUE(stops_exactly(family("boxcar").result));
  EXPECT_TRUE(stops_exactly(o.design));
  ASSERT_TRUE(family("hann").result.filter.has_value());
  EXPECT_GT(family("hann").result.cycle_time, 1.5 * family("boxcar").result.cycle_time);
}

TEST(Optima, NoShapeBeatsAnOptimum) {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 500.0;
  axis.force_max = 300.0;
  Task task = corner_task(axis, 50e-6);
  task.corners.front().set_feeds(0.1, 0.1);
  const Optimum o = find_optimum("friction", task, {});
  ASSERT_EQ(o.design.status, Status::optimal) << o.design.message;
  for (const FamilyResult& family : o.families) {
    if (family.result.filter) {
      EXPECT_GE(family.result.cycle_time, o.design.cycle_time - 1e-12);
    }
  }
}

TEST(OptimaReport, TellsWhatIsMissing) {
  Optimum impossible;
  impossible.name = "impossible";
  impossible.design.status = Status::infeasible;
  impossible.accepted = true;
  Optimum rejected;
  rejected.name = "rejected";
  EXPECT_FALSE(impossible.saving().has_value());
  EXPECT_EQ(impossible.best_family(), nullptr);
  const auto documents = optima_documents({impossible, rejected}, {});
  const auto text = [&](const std::string& name) {
    for (const auto& [file, content] : documents) {
      if (file == name) return content;
    }
    return std::string("no such file");
  };
  EXPECT_THAT(text("optima.md"), HasSubstr("| 1 | impossible | infeasible | - | - | - | - | - | 0 | 0 | accepted |"));
  // No time of any family, no best one, no parameters, no saving.
  const std::string empty(families().size() + 3, ',');
  EXPECT_THAT(text("optima.csv"), HasSubstr("\nrejected,failed,,,,,,0,0,0,0,REJECTED" + empty + "\n"));
  EXPECT_EQ(text("growth.csv"), "no such file");
}

}  // namespace
}  // namespace accdec
