#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/certificate/family_members.hpp>
#include <accdec/certificate/late_outlines.hpp>
#include <accdec/certificate/member_limits.hpp>
#include <accdec/certificate/refuted_outlines.hpp>
#include <accdec/filter.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Two corners of any angles and feeds with errors of some samples' way.
Task task_of(std::mt19937& rng, SettingFamily family, int stages, const char* shaper, double step) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task;
  task.sample_period = 1e-3;
  task.machine.axes.assign(2, {});
  for (const char* name : {"A", "B"}) {
    task.corners.emplace_back(name, PlanarLegs{0.3 + 2.7 * u(rng), u(rng)}, 0.05 + 0.1 * u(rng), 0.05 + 0.1 * u(rng));
    task.corners.back().error_max = 1e-4 * (0.1 + 5.0 * u(rng));
  }
  task.design.order_min = 0, task.design.order_max = 28;
  ControllerSettings settings;
  settings.families = {family};
  settings.stages.assign(static_cast<std::size_t>(stages), {});
  if (shaper != nullptr) settings.shaper = find_shaper(shaper);
  settings.shaper_frequency_step = step;
  task.settings = settings;
  return task;
}

/// The samples that a member costs at least, by the errors of its corners.
int least_cost(const Task& task, const FamilyMember& member, const CheckedResponse& response, bool between) {
  const MemberLimits limits(task, member, response);
  int cost = member.order() + 1;
  for (const TaskCorner& corner : task.corners) cost += limits.least_delay(corner, between);
  return cost;
}

struct Counts {
  int covered = 0, late = 0;
};

/// Goes through a family as the checker does, and compares what is covered with each member's own errors.
Counts expect_covered_are_late(const Task& task, int limit) {
  const CheckedResponse response(task);
  LateOutlines lates;
  bool covered = false;
  Counts counts;
  const auto ask = [&](const AveragesOutline& outline) {
    covered = lates.covers(outline);
    return false;
  };
  const auto look = [&](const FamilyMember& member, const std::string& words) {
    const bool late = least_cost(task, member, response, false) >= limit;
    counts.late += late ? 1 : 0, counts.covered += covered ? 1 : 0;
    if (covered) {
      EXPECT_TRUE(late) << words << ", limit " << limit;
    } else if (late) {
      lates.remember(lates.asks_between() && least_cost(task, member, response, true) >= limit);
    }
  };
  visit_family(task, task.settings->families.front(), task.design.order_max + 1, look, ask);
  return counts;
}

TEST(LateOutlines, AreLateByTheirOwnErrors) {
  std::mt19937 rng(2611);
  const auto expect = [&](SettingFamily family, int stages, const char* shaper, double step) {
    Counts all;
    for (int i = 0; i < 4; ++i) {
      const Task task = task_of(rng, family, stages, shaper, step);
      for (const int limit : {18, 28, 38}) {
        const Counts counts = expect_covered_are_late(task, limit);
        all.covered += counts.covered, all.late += counts.late;
      }
    }
    EXPECT_GT(all.covered, (step > 0.0 ? 1 : 2) * all.late / 3) << stages << " stages, " << (shaper ? shaper : "none");
  };
  for (const int stages : {1, 2, 3}) expect(SettingFamily::averages, stages, nullptr, 0.0);
  for (const char* shaper : {"zv", "zvd", "mzv", "ei"}) {
    for (const int stages : {1, 2}) expect(SettingFamily::shaper, stages, shaper, 0.0);
    expect(SettingFamily::shaper, 1, shaper, 1.5);
  }
}

/// Lengths that the bounds on taps and their differences call held are held by every start and stop.
TEST(LateOutlines, WhoseLegsHoldBreakNoLimitOfALeg) {
  std::mt19937 rng(2612);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int held = 0, broken = 0;
  for (int i = 0; i < 120; ++i) {
    const char* const shapers[] = {nullptr, "zv", "zvd", "mzv", "ei"};
    const char* const shaper = shapers[rng() % 5];
    Task task = task_of(rng, shaper ? SettingFamily::shaper : SettingFamily::averages, 2, shaper, i % 2 ? 9.0 : 0.0);
    task.design.order_max = 9;
    for (Axis& axis : task.machine.axes) {
      axis.acceleration_max = 10.0 + 100.0 * u(rng), axis.jerk_max = 1e3 + 1e5 * u(rng);
      axis.mass = 10.0, axis.damping = 50.0 * u(rng), axis.coulomb = 30.0 * u(rng);
      axis.force_max = 200.0 + 900.0 * u(rng), axis.power_max = 20.0 + 100.0 * u(rng);
      axis.regeneration_max = 10.0 + 100.0 * u(rng);
    }
    const CheckedResponse response(task);
    const RefutedOutlines outlines(task, response, 10);
    bool holds = false;
    const auto ask = [&](const AveragesOutline& outline) {
      holds = outlines.legs_hold(outline);
      return false;
    };
    const auto look = [&](const FamilyMember& member, const std::string& words) {
      if (!holds) return static_cast<void>(++broken);
      ++held;
      Task legs = task;
      for (TaskCorner& corner : legs.corners) corner.error_max.reset();
      const int apart = member.order() + 2;
      const VerificationReport report = verify_by_simulation(legs, Filter(member.taps), {apart, apart});
      EXPECT_TRUE(report.feasible) << words << ": " << report.worst;
    };
    visit_family(task, task.settings->families.front(), 10, look, ask);
  }
  EXPECT_GT(held, 1000);
  EXPECT_GT(broken, 1000);
}

}  // namespace
}  // namespace accdec
