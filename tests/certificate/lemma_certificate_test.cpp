#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/verify.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"
#include "support/tries.hpp"

// Proofs for several corners by lemmas: some corners' delays that no filter holds together, up to an order or of any
// order through a window.

namespace accdec {
namespace {

using nlohmann::json;

Task three_corners() {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 800.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 95, 10, 0.1, 0.1), 50e-6);
  task.corners.push_back(testing::plane_task(axis, testing::plane_corner("B", 60, 40, 0.06, 0.09), 20e-6).corners[0]);
  task.corners.push_back(testing::plane_task(axis, testing::plane_corner("C", 135, 0, 0.08, 0.08), 30e-6).corners[0]);
  task.corners[1].weight = 3.0;
  task.corners[2].weight = 2.0;
  task.design.order_max = 200;
  return task;
}

class LemmaCertificate : public ::testing::Test {
 protected:
  LemmaCertificate() : task(three_corners()), result(design_exact(task)), good(testing::certificate_json(result)) {}
  CheckReport check(const json& certificate) const { return testing::check_forged(task, result, certificate); }
  Task task;
  DesignResult result;
  json good;
};

TEST_F(LemmaCertificate, Accepted) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const CheckReport report = check(good);
  EXPECT_TRUE(report.accepted) << report.reason;
  int windows = 0, together = 0;
  for (const json& lemma : good["lemmas"]) windows += lemma.contains("window"), together += lemma["delays"].size() > 1;
  EXPECT_GT(windows, 0);
  EXPECT_GT(together, 0);
}

// The best design contradicts any lemma that lets its delays through, so no tree can prove one.
TEST_F(LemmaCertificate, LemmasThatForbidTheBestDesignAreRejected) {
  for (std::size_t l = 0; l < good["lemmas"].size(); ++l) {
    json bad = good;
    json& lemma = bad["lemmas"][l];
    if (lemma.contains("order")) lemma["order"] = std::max(lemma["order"].get<int>(), result.filter->order());
    for (json& delay : lemma["delays"])
      delay[1] = std::max(delay[1].get<int>(), result.corners[delay[0].get<std::size_t>()].delay);
    EXPECT_FALSE(check(bad).accepted) << l;
  }
}

TEST_F(LemmaCertificate, DamagedLemmasAreRejected) {
  const auto rejects = [&](const char* reason, const auto& change) {
    json bad = good;
    change(bad);
    const CheckReport report = check(bad);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find(reason), std::string::npos) << report.reason;
  };
  rejects("lemma that is not there", [](json& bad) { bad.erase("lemmas"); });
  rejects("lemma that is not there", [](json& bad) {
    for (json& node : bad["tree"])
      if (node.is_array() && node[0] == "lemma") node[1] = 1000;
  });
  rejects("corner that is not there", [](json& bad) {
    bad["lemmas"].back()["delays"] = json::array({json::array({7, 3})});
  });
  rejects("cannot have", [](json& bad) { bad["lemmas"].back()["delays"] = json::array({json::array({0, -1})}); });
  rejects("either an `order` or a `window`", [](json& bad) {
    for (json& lemma : bad["lemmas"])
      if (lemma.contains("window")) lemma["order"] = 10;
  });
  rejects("window", [](json& bad) {
    for (json& lemma : bad["lemmas"])
      if (lemma.contains("window")) lemma["window"][1] = 3;
  });
  rejects("cut off", [](json& bad) { bad["lemmas"][0]["tree"] = json::array(); });
  rejects("lemma that is not there", [](json& bad) {
    bad["lemmas"][0]["tree"] = json::array({json::array({"lemma", 0})});
  });
  rejects("neither refuted nor split", [](json& bad) {
    for (json& lemma : bad["lemmas"])
      if (lemma.contains("window")) lemma["tree"] = json::array({json::array({"lemma", 0})});
  });
  // Something rests on every lemma: for smaller delays it no longer reaches.
  for (std::size_t l = 0; l < good["lemmas"].size(); ++l) {
    json bad = good;
    bad["lemmas"][l]["order"] = -1;
    bad["lemmas"][l].erase("window");
    EXPECT_FALSE(check(bad).accepted) << l;
  }
}

// A forger claims that a worse design is the best and changes numbers until somebody believes it.
TEST_F(LemmaCertificate, ChangedNumbersNeverProveMoreThanIsTrue) {
  std::vector<int> delays;
  for (const CornerResult& c : result.corners) delays.push_back(c.delay);
  // On flat angles a longer delay need not do at once.
  do ++delays[2];
  while (!verify_by_simulation(task, *result.filter, delays).feasible && delays[2] < 100);
  DesignResult worse = assess(task, *result.filter, delays, false);
  worse.status = Status::optimal;
  worse.lower_bound = worse.objective();
  worse.gap = 0.0;
  worse.certificate = result.certificate;
  good["bound_samples"] = worse.objective() / task.sample_period;
  std::mt19937 random(3);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (int trial = 0; trial < test_support::tries(300); ++trial) {
    json bad = good;
    for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
      json& lemma = bad["lemmas"][below(bad["lemmas"].size())];
      if (lemma["delays"].empty()) continue;
      const int by = static_cast<int>(below(5)) - 1;
      switch (below(5)) {
        case 0: lemma["delays"][below(lemma["delays"].size())][1] = 30 + by; break;
        case 1: lemma["delays"][below(lemma["delays"].size())][0] = below(3); break;
        case 2:
          if (lemma["delays"].size() > 1) lemma["delays"].erase(0);
          break;
        case 3:
          if (lemma.contains("order")) lemma["order"] = 300;
          if (lemma.contains("window")) lemma["window"][below(3)] = 4 * by;
          break;
        default:
          json& node = bad["tree"][below(bad["tree"].size())];
          if (node.is_null()) node = json::array({"lemma", below(bad["lemmas"].size())});
      }
    }
    const CheckReport report = testing::check_forged(task, worse, bad);
    ASSERT_FALSE(report.accepted) << bad["lemmas"] << bad["tree"];
  }
}

TEST_F(LemmaCertificate, OfLighterWeights) {
  for (const std::size_t j : {0u, 1u, 2u}) {
    Task other = task;
    other.corners[j].weight *= 0.8;
    EXPECT_FALSE(check_certificate(other, result).accepted);
  }
}

// A filter is shifted until the anchor's sample is at its place, and the taps at and beyond the ends of the window are
// moved into them. Then it holds every error cut of the window.
TEST(CheckedWindows, CutsHoldForFiltersOfAnyOrder) {
  std::mt19937 random(9);
  std::uniform_int_distribution<int> order(2, 90), anchor_at(-5, 45), delay(0, 30), wide(0, 6);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  Task task = three_corners();
  for (int trial = 0; trial < 3000; ++trial) {
    const Filter filter = trapezoid(order(random), 1);
    const int shift = anchor_at(random), d = delay(random), n = filter.order();
    std::uniform_int_distribution<int> sample(0, n + d + 1);
    const int j = static_cast<int>(trial % 3), k = sample(random);
    TaskCorner& corner = task.corners[static_cast<std::size_t>(j)];
    const double c = corner.geometry().cos_interior();
    const double p = filter.remaining_moment(k) * corner.geometry().feed_in,
                 q = filter.elapsed_moment(k - d) * corner.geometry().feed_out;
    corner.error_max = task.sample_period * std::sqrt(p * p + q * q + 2.0 * p * q * c);
    const CheckedRows rows(task);
    CheckedBox box;
    box.window = true;
    box.order = 40;
    for (int i = 0; i < 3; ++i) box.corners.push_back({0, 30, 0, 71});
    // The sample in the window, at an end where it lies beyond.
    CheckedRange& range = box.corners[static_cast<std::size_t>(j)];
    range.d1 = std::max(0, d - wide(random)), range.d2 = d + wide(random);
    const int last = range.d2 + box.order + 1, at = std::clamp(k + shift, 0, last);
    range.k1 = std::max(0, at - wide(random)), range.k2 = std::min(last, at + wide(random));
    const double theta = std::acos(c), low = std::max(1e-9, theta - 1.5707963 + 1e-9), high = 1.5707963 - 1e-9;
    CheckedSum sum(box.order, box.window);
    sum.delays.resize(3), sum.samples.resize(3);
    rows.add({proof::Error{j, low + part(random) * (std::min(high, theta + low) - low)}, 1.0}, box, sum);
    double value = 0.0;
    for (int i = 0; i <= n; ++i)
      value += sum.taps[static_cast<std::size_t>(std::clamp(i + shift, 0, box.order))].lo * filter.tap(i);
    EXPECT_LE(value, sum.rhs.hi + 1e-10) << "order " << n << " shift " << shift << " k " << k << " d " << d;
  }
}

TEST(CheckedWindows, VibrationHoldsForFiltersOfAnyOrder) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> order(2, 90), shifted(-30, 45);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  Task task = three_corners();
  for (int trial = 0; trial < 2000; ++trial) {
    const Filter filter = trapezoid(order(random), 1);
    const int shift = shifted(random);
    const double frequency = 10.0 + 200.0 * part(random);
    task.machine.modes = {{frequency, frequency, residual_vibration(filter, frequency, task.sample_period)}};
    CheckedBox box;
    box.window = true;
    box.order = 40;
    for (int i = 0; i < 3; ++i) box.corners.push_back({0, 30, 0, 71});
    const CheckedRows rows(task);
    CheckedSum sum(box.order, box.window);
    rows.add({proof::Vibration{0, frequency, 6.3 * part(random)}, 1.0}, box, sum);
    double value = 0.0;
    for (int i = 0; i <= filter.order(); ++i)
      value += sum.taps[static_cast<std::size_t>(std::clamp(i + shift, 0, box.order))].lo * filter.tap(i);
    EXPECT_LE(value, sum.rhs.hi + 1e-10) << "order " << filter.order() << " shift " << shift;
  }
}

TEST(CheckedWindows, RowsOfTheEndsAreRejected) {
  const Task task = three_corners();
  const CheckedRows rows(task);
  CheckedBox box;
  box.window = true;
  box.order = 40;
  for (int i = 0; i < 3; ++i) box.corners.push_back({5, 5, 0, 46});
  const auto accepted = [&](const proof::Row& row) {
    CheckedSum sum(box.order, box.window);
    sum.delays.resize(3), sum.samples.resize(3);
    try {
      rows.add({row, 1.0}, box, sum);
    } catch (const Rejected&) {
      return false;
    }
    return true;
  };
  for (const int k : {0, 1, 2, 20, 39, 40, 41}) EXPECT_EQ(accepted(proof::TapDifference{k, 1}), k >= 2 && k <= 39) << k;
  for (const int k : {1, 2, 6, 7, 20, 40, 41, 46})
    EXPECT_EQ(accepted(proof::Blend{LimitKind::acceleration, 0, 0, k, 1}), k >= 7 && k <= 40) << k;
  EXPECT_TRUE(accepted(proof::Error{0, 0.8}));
  EXPECT_FALSE(accepted(proof::Error{0, 2.0}));
  EXPECT_FALSE(accepted(proof::Budget{}));
  EXPECT_FALSE(accepted(proof::Response{5, 1}));
  EXPECT_FALSE(accepted(proof::Vibration{0, 30.0, 0.0}));
}

}  // namespace
}  // namespace accdec
