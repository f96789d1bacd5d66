#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/corner.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/filter.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"

// Proofs for several corners: cuts over ranges of delays and samples, what a target leaves of all delays together, and
// splits on the order, as symmetric filters have them.

namespace accdec {
namespace {

using nlohmann::json;

Task two_corners() {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 800.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 95, 10, 0.1, 0.1), 50e-6);
  task.corners.push_back(task.corners[0]);
  task.corners[1] = testing::plane_task(axis, testing::plane_corner("B", 60, 40, 0.06, 0.09), 20e-6).corners[0];
  task.corners[1].weight = 3.0;
  task.design.order_max = 60;
  return task;
}

/// Other proofs for several corners have lemmas in place of all that.
Task symmetric(Task task) {
  task.design.symmetric = true;
  return task;
}

class JointCertificate : public ::testing::Test {
 protected:
  JointCertificate()
      : task(symmetric(two_corners())), result(design_exact(task)), good(testing::certificate_json(result)) {}
  CheckReport check(const json& certificate) const { return testing::check_forged(task, result, certificate); }
  /// Calls `change` for every row of a kind in turn.
  template <typename Change>
  int each_row(const std::string& kind, const Change& change) {
    int rows = 0;
    for (std::size_t i = 0; i < good["multipliers"].size(); ++i) {
      for (std::size_t r = 0; r < good["multipliers"][i].size(); ++r) {
        if (good["multipliers"][i][r][0] != kind) continue;
        json bad = good;
        change(bad["multipliers"][i][r], bad);
        ++rows;
      }
    }
    return rows;
  }
  Task task;
  DesignResult result;
  json good;
};

TEST_F(JointCertificate, Accepted) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const CheckReport report = check(good);
  EXPECT_TRUE(report.accepted) << report.reason;
  int orders = 0;
  for (const json& node : good["tree"]) orders += node.is_array() && node.size() == 2 && node[0] == "N";
  EXPECT_GT(orders, 0);
}

// The budget is what couples the corners: without it ranges of delays are not refuted.
TEST_F(JointCertificate, BudgetsTakenAwayAreRejected) {
  json bad = good;
  int rows = 0;
  for (json& multipliers : bad["multipliers"]) {
    for (json& row : multipliers) {
      if (row[0] != "budget") continue;
      row[1] = 0.0;
      ++rows;
    }
  }
  EXPECT_GT(rows, 0);
  EXPECT_FALSE(check(bad).accepted);
  each_row("budget", [&](json& row, json& negative) {
    row[1] = -1.0;
    EXPECT_FALSE(check(negative).accepted);
  });
}

TEST_F(JointCertificate, ForeignRowsAreRejected) {
  const auto rejects = [&](const json& row, const char* reason) {
    json bad = good;
    for (json& rows : bad["multipliers"]) rows.push_back(row);
    const CheckReport report = check(bad);
    EXPECT_FALSE(report.accepted) << row;
    EXPECT_NE(report.reason.find(reason), std::string::npos) << report.reason;
  };
  rejects(json::array({"range error", 7, 0.5, 10, false, false, 5, false, false, 1.0}), "corner that is not there");
  rejects(json::array({"range error", 0, 3.0, 10, false, false, 5, false, false, 1.0}), "does not apply");
  rejects(json::array({"range error", 0, 0.5, 1000000000, false, false, 5, false, false, 1.0}), "sample that is not");
  rejects(json::array({"range error", 0, 0.5, 10, false, false, 5, false, false, -1.0}), "negative");
  rejects(json::array({"range error", 0, 0.5, 10, 3, false, 5, false, false, 1.0}), "cannot be read");
  rejects(json::array({"range error", 0, 0.5, 1.0}), "cannot be read");
  rejects(json::array({"budget", json()}), "cannot be read");
}

// Splits of the order that leave some out, or lie outside what is left.
TEST_F(JointCertificate, MovedSplitsOfTheOrder) {
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    if (!good["tree"][i].is_array() || good["tree"][i][0] != "N") continue;
    for (const int at : {-1, 0, 60, 1000}) {
      json bad = good;
      bad["tree"][i][1] = at;
      EXPECT_FALSE(check(bad).accepted) << i << " at " << at;
    }
  }
}

TEST_F(JointCertificate, OfLighterWeights) {
  for (const std::size_t j : {0u, 1u}) {
    Task other = task;
    other.corners[j].weight *= 0.8;
    EXPECT_FALSE(check_certificate(other, result).accepted);
  }
}

TEST_F(JointCertificate, StopsWhenAsked) {
  const CheckReport report = check_certificate(task, result, [] { return true; });
  EXPECT_FALSE(report.accepted);
  EXPECT_NE(report.reason.find("time"), std::string::npos) << report.reason;
}

/// A filter within the task's limits on acceleration and jerk: a trapezoid with some of its mass moved.
Filter filter_within(const Task& task, std::mt19937& random) {
  const CheckedRows rows(task);
  std::uniform_int_distribution<int> order(34, 50), lead(0, 5);
  const Filter shape = trapezoid(order(random), 12);
  std::vector<double> taps(static_cast<std::size_t>(lead(random)), 0.0);
  taps.insert(taps.end(), shape.taps().begin(), shape.taps().end());
  for (const double tap : taps) EXPECT_LE(tap, rows.tap_max());
  return Filter(taps);
}

// The checker's row for a cut must hold for every filter within the limits, and for every delay and sample in the box
// whose corner error is within the bound. With equality the bound is the error itself.
TEST(CheckedRanges, HoldForFiltersWithinTheLimits) {
  std::mt19937 random(7);
  Task task = two_corners();
  std::uniform_int_distribution<int> delay(0, 20), wide(0, 6), shift(-4, 8);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  std::bernoulli_distribution coin;
  for (int trial = 0; trial < 4000; ++trial) {
    const Filter filter = filter_within(task, random);
    const int j = coin(random) ? 1 : 0, d = delay(random), n = filter.order();
    TaskCorner& corner = task.corners[static_cast<std::size_t>(j)];
    std::uniform_int_distribution<int> sample((n + d) / 2 - 4, (n + d) / 2 + 4);
    const int k = sample(random);
    const double p = filter.remaining_moment(k) * corner.geometry().feed_in,
                 q = filter.elapsed_moment(k - d) * corner.geometry().feed_out;
    const double c = corner.geometry().cos_interior();
    corner.error_max = task.sample_period * std::sqrt(p * p + q * q + 2.0 * p * q * c);
    const CheckedRows rows(task);
    CheckedBox box;
    box.order = n + wide(random);
    for (int i = 0; i < 2; ++i) box.corners.push_back({d, d, k, k});
    CheckedRange& range = box.corners[static_cast<std::size_t>(j)];
    range.d1 = std::max(0, d - wide(random)), range.d2 = d + wide(random);
    range.k1 = std::max(0, k - wide(random)), range.k2 = k + wide(random);
    // Touched where the filter is, with nothing left to range over: no slack at all.
    const bool exact = trial % 8 == 0;
    if (exact) range = {d, d, k, k};
    // The direction in which the error lies, or any that grows with both distances.
    const double theta = std::acos(c), least = std::max(0.0, theta - 1.5707963), most = 1.5707963;
    const double angle = exact || coin(random) ? std::clamp(std::atan2(q * std::sin(theta), p + q * c), least, most)
                                               : least + part(random) * (most - least);
    CheckedSum sum(box.order, box.window);
    sum.delays.resize(2), sum.samples.resize(2);
    const proof::Tangent in{exact ? k : k + shift(random), coin(random), coin(random)},
        out{exact ? k - d : k - d - shift(random), coin(random), coin(random)};
    rows.add({proof::RangeError{j, angle, in, out}, 1.0}, box, sum);
    ASSERT_FALSE(box.nothing_left);
    const auto u = static_cast<std::size_t>(j);
    double value = sum.delays[u].lo * (d - range.d1) + sum.samples[u].lo * (k - range.k1);
    for (int i = 0; i <= box.order; ++i) value += sum.taps[static_cast<std::size_t>(i)].lo * filter.tap(i);
    for (int i = 1; i <= box.order; ++i) value += sum.cumulative[static_cast<std::size_t>(i)].lo * filter.cumulative(i);
    // Up to the rounding of these few hundred products of numbers below 100.
    EXPECT_LE(value, sum.rhs.hi + 1e-10) << "order " << n << " of " << box.order << ", d " << d << ", k " << k;
    const double straight = std::atan2(q * std::sin(theta), p + q * c);
    const bool plane_sees_it = straight >= least && straight <= most;
    if (exact && plane_sees_it) {
      EXPECT_NEAR(value, sum.rhs.lo, 1e-10);
    }
  }
}

}  // namespace
}  // namespace accdec
