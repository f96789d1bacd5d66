// The bound for any motion beside the fastest motions of small programs, by linear programs over all samples.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <coin/ClpSimplex.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/window_bound.hpp>
#include <accdec/plan/run/free_plan.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>

#include "../program/reference.hpp"
#include "support/tries.hpp"

namespace accdec::free_bound_test {
namespace {

constexpr int sides = 16;
using Point = std::array<double, 2>;
using Row = std::vector<std::pair<int, double>>;

struct Legs {
  std::vector<Point> points;  // m, the first at 0
  double tolerance, feed;     // m, m/s

  std::string program() const {
    std::string text = fmt::format("G64 P{} F{}\n", 1e3 * tolerance, 6e4 * feed);
    for (std::size_t i = 1; i < points.size(); ++i)
      text += fmt::format("G1 X{:.9f} Y{:.9f}\n", 1e3 * points[i][0], 1e3 * points[i][1]);
    return text + "M2\n";
  }
};

/// All samples of a motion over two corners. Each is passed by a sample, and all polygons are inscribed: every motion
/// that is found is valid.
class SampledMotion {
 public:
  SampledMotion(const Legs& legs, const Axis& axis, double period) : legs_(legs), axis_(axis), period_(period) {}

  /// The fewest samples with any passes of the corners, counted up from a number too small; s.
  double least_time(int from) const {
    for (int count = from;; ++count) {
      for (int first = 2; first < count - 2; ++first) {
        for (int second = first + 1; second < count - 1; ++second) {
          if (possible(count, {0, first, second, count})) return count * period_;
        }
      }
    }
  }

 private:
  bool possible(int count, const std::vector<int>& passes) const {
    start_ = {0};
    index_.clear(), value_.clear(), low_.clear(), high_.clear();
    count_ = count;
    limit({1.0, -2.0, 1.0}, axis_.acceleration_max * period_ * period_);
    limit({1.0, -3.0, 3.0, -1.0}, axis_.jerk_max * std::pow(period_, 3));
    const double inside = std::cos(std::numbers::pi / sides);
    for (int m = 0; m < sides; ++m) {
      const double angle = 2.0 * std::numbers::pi * m / sides;
      const Point e{std::cos(angle), std::sin(angle)};
      for (int k = 0; k < count; ++k)
        row({{at(k + 1, 0), e[0]}, {at(k + 1, 1), e[1]}, {at(k, 0), -e[0]}, {at(k, 1), -e[1]}}, -1e30, inside);
      for (std::size_t leg = 0; leg + 1 < passes.size(); ++leg) {
        const Point &p = legs_.points[leg], &q = legs_.points[leg + 1];
        const bool forward = e[0] * (q[0] - p[0]) + e[1] * (q[1] - p[1]) >= 0.0;
        if (leg > 0) beyond(passes[leg], e, p, inside);
        for (int k = passes[leg]; k <= passes[leg + 1]; ++k) beyond(k, e, forward ? q : p, inside);
      }
    }
    return solve();
  }

  int at(int k, int a) const { return 2 * std::clamp(k, 0, count_) + a; }  // at rest before and after
  double step() const { return legs_.feed * period_; }
  void row(const Row& entries, double from, double to) const {
    for (const auto& [column, factor] : entries) index_.push_back(column), value_.push_back(factor);
    start_.push_back(static_cast<CoinBigIndex>(index_.size()));
    low_.push_back(from), high_.push_back(to);
  }
  /// A sample is no farther beyond a point than the tolerance.
  void beyond(int k, const Point& e, const Point& p, double inside) const {
    const double most = (inside * legs_.tolerance + e[0] * p[0] + e[1] * p[1]) / step();
    row({{at(k, 0), e[0]}, {at(k, 1), e[1]}}, -1e30, most);
  }
  void limit(const std::vector<double>& difference, double most) const {
    for (int k = 0; most < 1e20 && k <= count_ + 3; ++k) {
      for (int a = 0; a < 2; ++a) {
        std::map<int, double> sum;
        for (int j = 0; j < static_cast<int>(difference.size()); ++j)
          sum[at(k - j, a)] += difference[static_cast<std::size_t>(j)];
        row({sum.begin(), sum.end()}, -most / step(), most / step());
      }
    }
  }
  bool solve() const {
    const auto columns = static_cast<std::size_t>(2 * count_ + 2);
    std::vector<double> costs(columns, 0.0), least(columns, -1e30), most(columns, 1e30);
    for (std::size_t a = 0; a < 2; ++a) {
      least[a] = most[a] = 0.0;
      least[columns - 2 + a] = most[columns - 2 + a] = legs_.points.back()[a] / step();
    }
    CoinPackedMatrix matrix(false, static_cast<int>(columns), static_cast<int>(low_.size()),
                            static_cast<CoinBigIndex>(index_.size()), value_.data(), index_.data(), start_.data(),
                            nullptr);
    ClpSimplex lp;
    lp.setLogLevel(0);
    lp.loadProblem(matrix, least.data(), most.data(), costs.data(), low_.data(), high_.data());
    lp.dual();
    return lp.status() == 0;
  }

  const Legs& legs_;
  const Axis& axis_;
  const double period_;
  mutable int count_ = 0;
  mutable std::vector<CoinBigIndex> start_;
  mutable std::vector<int> index_;
  mutable std::vector<double> value_, low_, high_;
};

Legs random_legs(std::mt19937& random, int count, double shortest, double tolerance) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Legs legs{{{0.0, 0.0}}, tolerance, 0.1};
  double heading = 2.0 * std::numbers::pi * unit(random);
  for (int i = 0; i < count; ++i) {
    const double length = shortest * (1.0 + unit(random));
    const Point& p = legs.points.back();
    legs.points.push_back({p[0] + length * std::cos(heading), p[1] + length * std::sin(heading)});
    heading += (unit(random) < 0.5 ? -1.0 : 1.0) * (0.6 + 1.6 * unit(random));
  }
  return legs;
}

// The search begins far below the bound and tries all passes of every number of samples.
TEST(FreeBound, IsNotAboveTheFastestMotionsOfSmallPrograms) {
  std::mt19937 random(3);
  constexpr double T = 8e-3;
  for (int i = 0; i < 1; ++i) {  // some thousand linear programs each
    const Machine machine = test::machine_of(1.0, i % 2 == 1 ? 20.0 : unlimited);
    const Legs legs = random_legs(random, 3, 1.2e-3, i % 2 == 0 ? 3e-4 : 1e-4);
    const double bound = any_motion_bound(test::path_of(legs.program(), machine), machine, T, Deadline(60.0)).time;
    const double least = SampledMotion(legs, machine.axes[0], T).least_time(static_cast<int>(0.6 * bound / T));
    EXPECT_LE(bound, least) << legs.program();
    // A period (two with a jerk limit) is taken off, and corners must be passed on samples here.
    EXPECT_GE(bound + (i % 2 == 1 ? 2.0 : 1.0) * T, 0.65 * least) << legs.program();
  }
}

// From point to point and back, from rest to rest: every way D takes 2 sqrt(D/a), with or without stops between them.
TEST(FreeBound, OfAnAxisThatGoesBackAndForthIsTheClosedForm) {
  const Machine machine = test::machine_of(1.0);
  constexpr double way = 1e-3, tolerance = 1e-6;
  Legs legs{{{0.0, 0.0}}, tolerance, 0.1};
  for (int i = 1; i <= 9; ++i) legs.points.push_back({2e-5 * i, i % 2 == 0 ? 0.0 : way});
  const double bound = any_motion_bound(test::path_of(legs.program(), machine), machine, 1e-6, Deadline(60.0)).time;
  EXPECT_NEAR(bound, 9.0 * 2.0 * std::sqrt(way), 2e-3);
  EXPECT_LE(bound, 9.0 * 2.0 * std::sqrt(way) + 1e-9);
}

TEST(FreeBound, OfChainsIsNotAbovePlansOfFineChords) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    Machine machine = test::machine_of(i % 3 == 0 ? 5.0 : 1.0, i % 4 == 1 ? 50.0 : unlimited, 0.3);
    machine.axes[1].acceleration_max *= 0.5;
    const double tolerance = std::pow(10.0, -2.0 + 0.9 * unit(random)),
                 size = std::pow(10.0, -0.2 + 0.6 * unit(random));
    std::string text = fmt::format("G91 G64 P{} F{}\n", tolerance, i % 2 == 0 ? 1500 : 6000);
    for (int b = 0; b < 40; ++b)
      text += fmt::format("G1 X{:.6f} Y{:.6f}\n", size * (0.2 + std::abs(unit(random))), size * unit(random));
    const Toolpath path = test::path_of(text + "M2\n", machine);
    const ProfilePlan plan = plan_profiles(path, machine, 1e-3);
    ASSERT_TRUE(plan.holds()) << text;
    const SplineSlack slack = spline_slack(machine, 1e-3);
    const SwingTimes chains(machine, 2);
    const double bound = window_bound(path, machine, slack.wider, 0, path.blocks() - 1, &chains) - slack.saved;
    EXPECT_LE(bound, 1e-3 * static_cast<double>(plan.check.samples)) << text;
    EXPECT_GE(bound, window_bound(path, machine, slack.wider, 0, path.blocks() - 1) - slack.saved - 1e-12) << text;
  }
}

TEST(FreeBound, IsNotAbovePlansThatAreFree) {
  std::mt19937 random(9);
  for (int i = 0; i < test_support::tries(3); ++i) {
    Task task;
    task.sample_period = 1e-3;
    task.machine = test::machine_of(i == 0 ? 3.0 : 1.0, i == 1 ? 50.0 : unlimited);
    const Legs legs = random_legs(random, 4, i < 2 ? 1e-3 : 4e-3, i % 2 == 0 ? 2e-4 : 3e-5);
    const ProgramFile file{"test", test::path_of(legs.program(), task.machine)};
    const double bound = any_motion_bound(file.path, task.machine, task.sample_period, Deadline(60.0), false).time;
    ProgramFileOptions quick;
    quick.free.sweeps = 2;
    const ProgramResult free = run_free_plan(file, task, quick, {});
    ASSERT_TRUE(free.verification.feasible) << free.message;
    EXPECT_LE(bound, free.cycle_time) << legs.program();
    EXPECT_GE(bound, 0.7 * free.cycle_time) << legs.program();
  }
}

}  // namespace
}  // namespace accdec::free_bound_test
