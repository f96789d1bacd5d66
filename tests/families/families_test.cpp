#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/corner.hpp>
#include <accdec/family.hpp>
#include <accdec/machine.hpp>
#include <accdec/verify.hpp>

#include "support/tasks.hpp"

namespace accdec {
namespace {

using testing::plane_corner;
using testing::plane_task;
using testing::random_task;

const Family& family(const char* name) {
  return *find_family(name);
}

// 0.1 m/s at 6 m/s^2 and 1 ms: a tap of at most 0.06, so 17 taps; parted legs at d = 16.
TEST(Families, BoxcarOfAnAccelerationLimit) {
  Axis axis;
  axis.acceleration_max = 6.0;
  const FamilyResult best = best_member(plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 0.0), family("boxcar"));
  ASSERT_TRUE(best.spec) << best.result.message;
  EXPECT_EQ(best.spec->order, 16);
  EXPECT_EQ(best.result.corners.at(0).delay, 16);
  EXPECT_TRUE(stops_exactly(best.result));
}

// Acceleration and jerk limits on one axis: averages of ceil(v/(a T)) and ceil(a/(j T)) taps. 0.1 m/s, 6 m/s^2 and
// 600 m/s^3 at 1 ms: 17 and 10.
TEST(Families, TwoAveragesOfAccelerationAndJerk) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  const FamilyResult best = best_member(plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 0.0), family("trapezoid"));
  ASSERT_TRUE(best.spec) << best.result.message;
  EXPECT_EQ(best.spec->order - best.spec->ramp + 1, 17);
  EXPECT_EQ(best.spec->ramp + 1, 10);
}

// The start that saturates m a + c V = F is a geometric series. The legs of an exact stop do not overlap, so only the
// fastest start counts. With friction the exponential is the optimum: B_k = (F + (m/T) s B_{k-1})/((m/T + c) s) at feed
// s.
TEST(Families, ExponentialSaturatesForceWithFriction) {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 840.0;
  axis.force_max = 465.0;
  const double s = 0.5, inertia = axis.mass / 1e-3;
  double response = 0.0;
  int taps = 0;
  while (response < 1.0 - 1e-12) {
    response = (axis.force_max + inertia * s * response) / ((inertia + axis.damping) * s);
    ++taps;
  }
  const FamilyResult best = best_member(plane_task(axis, plane_corner("A", 90, 0, s, s), 0.0), family("exponential"));
  ASSERT_TRUE(best.spec) << best.result.message;
  EXPECT_EQ(best.spec->order + 1, taps);
  EXPECT_NEAR(best.spec->ratio, inertia / (inertia + axis.damping), 2e-3);  // any ratio between two whole lengths does
}

// The start of a mass, played backwards, is its stop. Its power is then the regenerated power, at the speed a sample
// later. So the best filter under a regeneration limit is as short as that under a power limit, and it rises.
TEST(Families, ExponentialsForRegenerationAreThoseForPowerBackwards) {
  Axis starts;
  starts.mass = 40.0;
  starts.acceleration_max = 6.0;
  starts.power_max = 6.0;
  Axis stops = starts;
  std::swap(stops.power_max, stops.regeneration_max);
  const auto best_with = [](const Axis& axis) {
    return best_member(plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 150e-6), family("exponential"));
  };
  const FamilyResult power = best_with(starts), regeneration = best_with(stops);
  ASSERT_TRUE(power.spec) << power.result.message;
  ASSERT_TRUE(regeneration.spec) << regeneration.result.message;
  EXPECT_LT(power.spec->ratio, 1.0);
  EXPECT_GT(regeneration.spec->ratio, 1.0);
  EXPECT_LE(regeneration.result.objective(), power.result.objective() + 1e-12);
  EXPECT_GE(regeneration.result.objective(), power.result.objective() - 3e-3);  // a sample at each end, and of delay
}

/// The least objective, samples, of one member with the delays it needs; judged by the blend formulas, not the
/// search's.
double cost(const Task& task, const FilterSpec& spec, int order_max) {
  const double allowed = 1.0 + 0.9 * verification_tolerance;
  double sum = 0.0, weights = 0.0;
  try {
    const Filter filter = make_filter(spec);
    if (filter.order() > order_max || filter.order() < task.design.order_min) return unlimited;
    for (const LimitUse& use : vibration_utilisation(filter, task.sample_period, task.machine)) {
      if (use.utilisation > allowed) return unlimited;
    }
    for (const TaskCorner& c : task.corners) {
      const auto holds = [&](int d) {
        for (const LimitUse& use :
             axis_utilisation(filter, c.geometry(), d, task.sample_period, task.machine, c.name)) {
          if (use.utilisation > allowed) return false;
        }
        const CornerMeasures m = measure(Blend(filter, c.geometry(), d, task.sample_period));
        return (!c.error_max || m.corner_error <= *c.error_max * allowed) && c.speed_min <= m.speed_min * allowed;
      };
      int d = 0;
      while (d <= filter.order() + 2 && !holds(d)) ++d;
      if (d > filter.order() + 2) return unlimited;
      sum += c.weight * d;
      weights += c.weight;
    }
    return sum + (filter.order() + 1.0) * (task.design.objective == Objective::cycle ? task.design.runs : weights);
  } catch (const std::invalid_argument&) {
    return unlimited;  // a shape that needs a larger order
  }
}

/// Every order, every pair, every whole parameter; of real ones a grid, which no search may be worse than.
double brute_force(const Task& task, const Family& b, int order_max) {
  double best = unlimited;
  const auto offer = [&](const FilterSpec& spec) { best = std::min(best, cost(task, spec, order_max)); };
  for (int order = 0; order <= order_max; ++order) {
    for (int delay = b.pairs > 0 ? 1 : 0; order + b.pairs * delay <= order_max && delay <= (b.pairs > 0 ? 99 : 0);
         ++delay) {
      FilterSpec spec{.kind = b.shape,
                      .order = order,
                      .pairs = b.pairs,
                      .pair_delay = static_cast<double>(delay),
                      .outer = b.outer};
      for (int g = 1; g <= 40; ++g) {
        spec.alpha = 0.15 * g;
        spec.ratio = g <= 20 ? g / 20.0 : 20.0 / (41 - g);
        spec.cutoff = order > 0 ? 2.0 / order * g / 40.0 : 0.0;
        spec.ramp = g - 1;
        const bool grid =
            b.shape == Shape::gaussian || b.shape == Shape::exponential || b.shape == Shape::blackman_sinc;
        if (b.shape == Shape::averages) {
          if (g > order + 1) break;
          for (int l = 1; g + l <= order + 2; ++l) {
            spec.lengths = {g, l, order + 3 - g - l};
            offer(spec);
          }
          continue;
        }
        offer(spec);
        if (!grid && b.shape != Shape::trapezoid) break;
      }
    }
  }
  return best;
}

TEST(Families, AgreeWithTryingEverything) {
  std::mt19937 rng(5);
  std::map<std::string_view, int> found;
  for (int trial = 0; trial < 204; ++trial) {
    Task task = random_task(rng, 1 + trial % 2);
    task.design.order_max = 12;
    task.design.runs = 1.5;
    if (trial % 3 == 0) task.design.objective = Objective::corner;
    // Every second time easier: few families hold within so few taps, and no boxcar under a jerk limit.
    if (static_cast<std::size_t>(trial) / families().size() % 2 == 1) {
      task.sample_period *= 4.0;
      for (Axis& axis : task.machine.axes) axis.jerk_max = unlimited;
    }
    const Family& b = families()[static_cast<std::size_t>(trial) % families().size()];
    if (b.pairs > 0 && task.machine.modes.empty()) task.machine.modes.push_back({60.0, 70.0, 0.6});
    SCOPED_TRACE(::testing::Message() << "trial " << trial << ", " << b.name);
    const double expected = brute_force(task, b, 12);
    const FamilyResult best = best_member(task, b);
    const bool grid = b.shape == Shape::gaussian || b.shape == Shape::exponential || b.shape == Shape::blackman_sinc;
    if (!best.spec) {
      // Beyond three times the two averages nothing is looked for.
      const FamilyResult two = best_member(task, family("trapezoid"));
      const double limit = two.spec ? hopeless_factor * two.result.objective() / task.sample_period : unlimited;
      EXPECT_GE(expected, limit * (1.0 - 1e-9)) << best.result.message;
      continue;
    }
    ++found[b.name];
    EXPECT_EQ(best.result.status, Status::feasible) << best.result.message;
    const double got = best.result.objective() / task.sample_period;
    EXPECT_LE(got, expected + 1e-9);
    if (!grid) {
      EXPECT_GE(got, expected - 1e-9);
    }
    EXPECT_NEAR(got, cost(task, *best.spec, 12), 1e-9);
  }
  for (const Family& b : families()) EXPECT_GE(found[b.name], 1) << b.name;
}

TEST(Families, WiderFamiliesAreNeverWorse) {
  std::mt19937 rng(3);
  int found = 0;
  for (int trial = 0; trial < 12; ++trial) {
    Task task = random_task(rng, 2);
    // If nothing holds, all cascades of three lengths are tried: as many as the cube of the largest order.
    task.sample_period = 3e-3;
    task.design.order_max = 80;
    double before = unlimited;
    for (const char* name : {"boxcar", "trapezoid", "averages"}) {
      const FamilyResult best = best_member(task, family(name));
      const double time = best.spec ? best.result.objective() : unlimited;
      EXPECT_LE(time, before * (1.0 + 1e-12)) << name;
      before = time;
    }
    found += before < unlimited ? 1 : 0;
  }
  EXPECT_GE(found, 6);
}

TEST(Families, GivenDelaysStay) {
  Axis axis;
  axis.acceleration_max = 5.0;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), std::nullopt);
  task.corners[0].delay = 3;
  const FamilyResult best = best_member(task, family("hann"));
  ASSERT_TRUE(best.spec);
  EXPECT_EQ(best.result.corners.at(0).delay, 3);
}

// One family by itself is cut off inside of its search; what it had by then is verified, and said to be that.
TEST(Families, AFamilyAloneEndsInTime) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  const Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 5e-5);
  const FamilyResult none = best_member(task, family("averages"), 0.0);
  EXPECT_FALSE(none.spec);
  EXPECT_EQ(none.result.status, Status::failed);
  EXPECT_THAT(none.result.message, ::testing::HasSubstr("not searched to the end"));
}

// A family is either searched to the end, or without a filter and without a claim that there is none.
TEST(Families, NothingIsClaimedOfASearchThatWasCutOff) {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 600.0;
  const Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 5e-5);
  for (const FamilyResult& none : best_members(task, 0.0)) {
    EXPECT_FALSE(none.spec);
    // Pairs of impulses have nothing to do here, which needs no search.
    const bool without_search = none.result.message.find("vibration") != std::string::npos;
    EXPECT_EQ(none.result.status, without_search ? Status::infeasible : Status::failed);
  }
  const std::vector<FamilyResult> all = best_members(task), within = best_members(task, 0.02);
  ASSERT_EQ(all.size(), within.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (within[i].result.status == Status::failed) continue;
    EXPECT_EQ(within[i].result.status, all[i].result.status);
    ASSERT_EQ(within[i].spec.has_value(), all[i].spec.has_value());
    EXPECT_TRUE(!within[i].spec || within[i].result.objective() == all[i].result.objective());
  }
}

// A filter of a million taps with a vibration band needs checks at some hundred thousand frequencies and as many
// delays. Looking for the request to stop only between orders would take hours.
TEST(Families, AStopIsHeardWithinAnOrderOfAMillionTaps) {
  Axis axis;
  axis.acceleration_max = 1e-4;
  Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 1e-6);
  task.machine.modes.push_back({10.0, 200.0, 1e-4});
  task.design.order_min = 999'000;
  task.design.order_max = 1'000'000;
  std::atomic<bool> cancel = false;
  const std::jthread user([&cancel] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancel = true;
  });
  long unfinished = 0;
  for (const FamilyResult& family : best_members(task, unlimited, &cancel)) {
    EXPECT_FALSE(family.spec);
    unfinished += family.result.status == Status::failed ? 1 : 0;
  }
  EXPECT_GT(unfinished, 10);
}

TEST(Families, WhatCannotBeIsSaid) {
  Axis axis;
  axis.velocity_max = 0.05;
  const Task task = plane_task(axis, plane_corner("A", 90, 0, 0.1, 0.1), 1e-4);
  EXPECT_EQ(best_member(task, family("boxcar")).result.status, Status::infeasible);
  EXPECT_THAT(best_member(task, family("boxcar")).result.message, ::testing::HasSubstr("velocity"));
  Task quiet = task;
  quiet.machine.axes[0].velocity_max = quiet.machine.axes[1].velocity_max = unlimited;
  EXPECT_THAT(best_member(quiet, family("boxcar-zv")).result.message, ::testing::HasSubstr("vibration"));
  EXPECT_EQ(find_family("sinc"), nullptr);
}

}  // namespace
}  // namespace accdec
