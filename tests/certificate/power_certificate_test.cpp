#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/exact/exact.hpp>
#include <accdec/verify.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"

namespace accdec {
namespace {

using nlohmann::json;

Task power_task() {
  Axis axis;
  axis.mass = 34.0;
  axis.damping = 50.0;
  axis.force_max = 465.0;
  axis.power_max = 110.0;
  axis.regeneration_max = 60.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 100, 20, 0.4, 0.4), 200e-6);
  task.sample_period = 3e-3;
  task.design.order_max = 60;
  return task;
}

Task speed_task() {
  Axis axis;
  axis.acceleration_max = 10.0;
  axis.jerk_max = 1500.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 90, 0, 0.1, 0.1), 60e-6);
  task.corners[0].speed_min = 0.032;
  task.design.order_max = 60;
  return task;
}

/// A proved design and ways to lie about it.
class ChordCertificate : public ::testing::Test {
 protected:
  explicit ChordCertificate(Task given) : task(std::move(given)), result(design_exact(task)) {
    good = testing::certificate_json(result);
  }
  CheckReport check(const json& certificate) const { return testing::check_forged(task, result, certificate); }
  void expect_rejected(const json& certificate, const std::string& reason) const {
    const CheckReport report = check(certificate);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find(reason), std::string::npos) << report.reason;
  }
  /// Applies `change` to every chord of the proof in turn.
  template <class Change>
  int each_chord(Change change) const {
    int count = 0;
    for (std::size_t i = 0; i < good["multipliers"].size(); ++i) {
      for (std::size_t r = 0; r < good["multipliers"][i].size(); ++r) {
        const std::string kind = good["multipliers"][i][r][0];
        if (kind.find("power") == kind.npos && kind.find("regeneration") == kind.npos && kind != "speed") continue;
        json bad = good;
        json& row = bad["multipliers"][i][r];
        if (!change(row, row[row.size() - 3], row[row.size() - 2])) continue;
        ++count;
        EXPECT_FALSE(check(bad).accepted) << row.dump();
      }
    }
    return count;
  }
  /// Index of the first leaf in the tree.
  std::size_t first_leaf() const {
    std::size_t i = 0;
    while (!good["tree"][i].is_number()) ++i;
    return i;
  }
  Task task;
  DesignResult result;
  json good;
};

class PowerCertificate : public ChordCertificate {
 protected:
  PowerCertificate() : ChordCertificate(power_task()) {}
};

class SpeedCertificate : public ChordCertificate {
 protected:
  SpeedCertificate() : ChordCertificate(speed_task()) {}
};

TEST_F(SpeedCertificate, SectorsTooNarrow) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_TRUE(check(good).accepted) << check(good).reason;
  EXPECT_TRUE(verify_result(result).accepted);
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              low = 0.5 * (low.get<double>() + high.get<double>());
              return true;
            }),
            0);
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              high = 0.5 * (low.get<double>() + high.get<double>());
              return true;
            }),
            0);
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              std::swap(low, high);
              return true;
            }),
            0);
  EXPECT_GT(each_chord([](json&, json&, json& high) {
              high = high.get<double>() + 3.0;
              return true;
            }),
            0);
  Task slower = task;
  slower.corners[0].speed_min = 0.02;
  EXPECT_FALSE(check_certificate(slower, result).accepted);
  slower.corners[0].speed_min = 0.0;
  EXPECT_FALSE(check_certificate(slower, result).accepted);
}

TEST_F(PowerCertificate, Accepted) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const CheckReport report = check(good);
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_TRUE(verify_result(result).accepted);
}

// Multipliers serve several delays; at a longer one some of their samples lie where both legs stand still.
TEST(PowerProof, RowsOfSamplesLongPastAreLeftOut) {
  Axis axis;
  axis.mass = 96.8;
  axis.force_max = 42622.0;
  axis.power_max = 6479.5;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 53.130102, -45.0, 0.378157, 0.378157), 9.49e-6);
  task.sample_period = 5e-4;
  task.design.order_min = 1;
  task.design.order_max = 2;
  const DesignResult result = design_exact(task);
  ASSERT_EQ(result.status, Status::optimal);
  const CheckReport report = check_certificate(task, result);
  EXPECT_TRUE(report.accepted) << report.reason;
}

TEST_F(PowerCertificate, ChordsTooShort) {
  // The upper end below what speeds are left in the box, or the lower end above it. Chords of a proof that began with
  // a longer target reach further than it needs, but not by as much as this.
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              high = 0.98 * low.get<double>() + 0.02 * high.get<double>();
              return true;
            }),
            10);
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              low = 0.02 * low.get<double>() + 0.98 * high.get<double>();
              return true;
            }),
            10);
}

TEST_F(PowerCertificate, ChordsThatAreNone) {
  EXPECT_GT(each_chord([](json&, json& low, json& high) {
              std::swap(low, high);
              return true;
            }),
            10);
  EXPECT_GT(each_chord([](json&, json& low, json&) {
              low = nullptr;
              return true;
            }),
            10);
  EXPECT_GT(each_chord([](json& row, json& low, json&) {
              if (row[0] == "speed") return false;
              low = -low.get<double>();
              return true;
            }),
            10);
}

// A larger multiplier on a bound of the response, or the bound's other side, is a false tightening.
TEST_F(PowerCertificate, FalseBoundsOnResponses) {
  int count = 0;
  for (std::size_t i = 0; i < good["multipliers"].size(); ++i) {
    for (std::size_t r = 0; r < good["multipliers"][i].size(); ++r) {
      if (good["multipliers"][i][r][0] != "response") continue;
      // The other side is a bound, too: a multiplier that hardly counts may stand by it.
      if (good["multipliers"][i][r][3].get<double>() < 1e-6) continue;
      json bad = good;
      json& row = bad["multipliers"][i][r];
      row[2] = -row[2].get<int>();
      row[3] = 1e3 * row[3].get<double>();
      ++count;
      EXPECT_FALSE(check(bad).accepted) << row.dump();
    }
  }
  EXPECT_GT(count, 0);
}

TEST_F(PowerCertificate, PartsCalledUnreachable) {
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    if (!good["tree"][i].is_number()) continue;
    json bad = good;
    bad["tree"][i] = "unreachable";
    // Some are: then the statement is true, though not how it was first shown.
    const CheckReport report = check(bad);
    if (report.accepted) continue;
    EXPECT_NE(report.reason.find("called unreachable, but is not"), std::string::npos) << report.reason;
  }
  json bad = good;
  bad["tree"] = json::array({"unreachable"});
  expect_rejected(bad, "called unreachable, but is not");
}

// A leaf split on a response: the same multipliers refute both parts, and neither may be missing or lie outside.
TEST_F(PowerCertificate, SplitsOnResponses) {
  const std::size_t i = first_leaf();
  const json leaf = good["tree"][i];
  const auto with = [&](const std::vector<json>& entries) {
    json changed = good;
    changed["tree"].erase(i);
    for (std::size_t e = 0; e < entries.size(); ++e)
      changed["tree"].insert(changed["tree"].begin() + static_cast<std::ptrdiff_t>(i + e), entries[e]);
    return changed;
  };
  const json split = json::array({2, "B", 0.25});
  const CheckReport both = check(with({split, leaf, leaf}));
  EXPECT_TRUE(both.accepted) << both.reason;
  EXPECT_FALSE(check(with({split, leaf})).accepted);
  EXPECT_FALSE(check(with({split})).accepted);
  expect_rejected(with({json::array({0, "B", 0.25}), leaf, leaf}), "a response that is not there");
  expect_rejected(with({json::array({1000, "B", 0.25}), leaf, leaf}), "a response that is not there");
  expect_rejected(with({json::array({2, "B", 1.25}), leaf, leaf}), "outside 0 .. 1");
  expect_rejected(with({json::array({2, "B", -0.25}), leaf, leaf}), "outside 0 .. 1");
  EXPECT_FALSE(check(with({json::array({2, "B", nullptr}), leaf, leaf})).accepted);
  EXPECT_FALSE(check(with({json::array({"symmetric"}), leaf, leaf})).accepted);
}

TEST_F(PowerCertificate, ShortenedTrees) {
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    json bad = good;
    bad["tree"].erase(i);
    EXPECT_FALSE(check(bad).accepted) << i;
  }
}

// A proof under these limits does not hold if one limit is wider.
TEST_F(PowerCertificate, OfAnotherTask) {
  const auto expect_foreign = [&](const std::function<void(Task&)>& change) {
    Task other = task;
    change(other);
    EXPECT_FALSE(check_certificate(other, result).accepted);
  };
  expect_foreign([](Task& t) {
    for (Axis& a : t.machine.axes) a.power_max *= 1.3;
  });
  expect_foreign([](Task& t) {
    for (Axis& a : t.machine.axes) a.power_max = unlimited;
  });
  expect_foreign([](Task& t) {
    for (Axis& a : t.machine.axes) a.regeneration_max *= 1.3;
  });
  expect_foreign([](Task& t) {
    for (Axis& a : t.machine.axes) a.regeneration_max = unlimited;
  });
  expect_foreign([](Task& t) {
    for (Axis& a : t.machine.axes) a.force_max *= 1.3;
  });
}

// One tap a little larger at the cost of another is still a filter, but breaks a limit or the numbers recorded with it.
TEST_F(PowerCertificate, ChangedTaps) {
  ASSERT_TRUE(result.filter);
  const std::vector<double> taps(result.filter->taps().begin(), result.filter->taps().end());
  bool power = false, regeneration = false;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    std::vector<double> changed = taps;
    const std::size_t from = i + 1 < taps.size() ? i + 1 : 0;
    const double moved = std::min(0.01, changed[from]);
    changed[i] += moved;
    changed[from] -= moved;
    if (moved == 0.0) continue;
    DesignResult lie = result;
    lie.filter = Filter(changed);
    const ResultCheck found = verify_result(lie);
    EXPECT_FALSE(found.accepted) << i;
    ASSERT_FALSE(found.reasons.empty());
    for (const std::string& reason : found.reasons) {
      power |= reason.find("power") != std::string::npos;
      regeneration |= reason.find("regeneration") != std::string::npos;
    }
  }
  EXPECT_TRUE(power);
  EXPECT_TRUE(regeneration);
}

}  // namespace
}  // namespace accdec
