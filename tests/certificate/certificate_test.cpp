#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/exact/exact.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"

namespace accdec {
namespace {

using nlohmann::json;

/// A proved design and many ways to lie about it.
class Certificates : public ::testing::Test {
 protected:
  Certificates() {
    Axis axis;
    axis.acceleration_max = 6.0;
    axis.jerk_max = 800.0;
    task = testing::plane_task(axis, testing::plane_corner("A", 95, 10, 0.1, 0.1), 50e-6);
    task.design.order_max = 60;
    result = design_exact(task);
    good = testing::certificate_json(result);
  }
  CheckReport check(const json& certificate) const { return testing::check_forged(task, result, certificate); }
  void expect_rejected(const CheckReport& report, const std::string& reason) const {
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find(reason), std::string::npos) << report.reason;
  }
  Task task;
  DesignResult result;
  json good;
};

TEST_F(Certificates, Accepted) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const CheckReport report = check(good);
  EXPECT_TRUE(report.accepted) << report.reason;
}

TEST_F(Certificates, EveryDamagedSetOfMultipliersIsRejected) {
  for (std::size_t i = 0; i < good["multipliers"].size(); ++i) {
    json bad = good;
    for (json& row : bad["multipliers"][i]) row[row.size() - 1] = 0.0;
    expect_rejected(check(bad), "is not refuted");
    bad = good;
    bad["multipliers"][i] = json::array();
    expect_rejected(check(bad), "is not refuted");
  }
}

TEST_F(Certificates, NegativeAndInfiniteMultipliers) {
  json bad = good;
  json& row = bad["multipliers"][0][0];
  row[row.size() - 1] = -1.0;
  expect_rejected(check(bad), "negative");
}

TEST_F(Certificates, ShortenedAndLengthenedTrees) {
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    json bad = good;
    bad["tree"].erase(i);
    EXPECT_FALSE(check(bad).accepted) << i;
  }
  json bad = good;
  bad["tree"].erase(bad["tree"].size() - 1);
  expect_rejected(check(bad), "cut off");
  bad = good;
  bad["tree"].push_back(0);
  expect_rejected(check(bad), "goes on");
}

TEST_F(Certificates, RefutedPartsCalledTooLong) {
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    if (!good["tree"][i].is_number()) continue;
    json bad = good;
    bad["tree"][i] = nullptr;
    expect_rejected(check(bad), "left out as too long");
  }
}

TEST_F(Certificates, ForeignReferences) {
  json bad = good;
  bad["tree"] = json::array({9999});
  expect_rejected(check(bad), "multipliers that are not there");
  bad["tree"] = json::array({json::array({3, "d", 1})});
  expect_rejected(check(bad), "corner that is not there");
  bad["tree"] = json::array({json::array({0, "d", 100000})});
  expect_rejected(check(bad), "outside the box");
  bad = good;
  bad["multipliers"][0].push_back(json::array({"blend force", 0, 0, 3, 1, 1.0}));
  EXPECT_FALSE(check(bad).accepted);
  bad["multipliers"][0].back() = json::array({"vibration", 0, 10.0, 0.0, 1.0});
  EXPECT_FALSE(check(bad).accepted);
  bad["multipliers"][0].back() = json::array({"magic", 0, 0, 0, 0, 1.0});
  EXPECT_FALSE(check(bad).accepted);
  bad["multipliers"][0].back() = "text";
  EXPECT_FALSE(check(bad).accepted);
}

TEST_F(Certificates, ClaimsBeyondTheProof) {
  DesignResult changed = result;
  changed.cycle_time += task.sample_period;
  changed.lower_bound = changed.cycle_time;
  expect_rejected(check_certificate(task, changed), "proves");
  json bad = good;
  bad["bound_samples"] = bad["bound_samples"].get<double>() + 1.0;
  EXPECT_FALSE(testing::check_forged(task, changed, bad).accepted);
  changed = result;
  changed.lower_bound = *changed.lower_bound - task.sample_period;
  expect_rejected(check_certificate(task, changed), "below the cycle time");
  changed = result;
  changed.status = Status::infeasible;
  EXPECT_FALSE(check_certificate(task, changed).accepted);
  bad["bound_samples"] = nullptr;
  EXPECT_FALSE(testing::check_forged(task, changed, bad).accepted);
  bad = good;
  bad["bound_samples"] = nullptr;
  expect_rejected(testing::check_forged(task, result, bad), "nothing exists");
}

// A proof for stricter limits proves nothing for looser ones.
TEST_F(Certificates, OfAnotherTask) {
  Task other = task;
  for (Axis& axis : other.machine.axes) axis.acceleration_max *= 1.3, axis.jerk_max *= 1.5;
  EXPECT_FALSE(check_certificate(other, result).accepted);
  other = task;
  other.corners[0].error_max = 90e-6;
  EXPECT_FALSE(check_certificate(other, result).accepted);
}

TEST_F(Certificates, UnknownLabelsAndSchemas) {
  json bad = good;
  bad["schema"] = "accdec.certificate/2";
  expect_rejected(check(bad), "schema is unknown");
  int splits = 0;
  for (std::size_t i = 0; i < good["tree"].size(); ++i) {
    if (!good["tree"][i].is_array() || good["tree"][i].size() != 3) continue;
    bad = good;
    bad["tree"][i][1] = good["tree"][i][1].get<std::string>() + "x";
    expect_rejected(check(bad), "splits neither a delay nor a sample");
    ++splits;
  }
  EXPECT_GT(splits, 0);
}

TEST_F(Certificates, NotOfTheForm) {
  for (const char* text : {"[]", "{}", "3", "\"kind\"", "{\"kind\":3}", "{\"kind\":\"branch and bound\"}",
                           "{\"kind\":\"magic\",\"schema\":\"accdec.certificate/1\"}"})
    expect_rejected(check(json::parse(text)), "cannot be read");
  for (const char* key : {"tree", "multipliers", "bound_samples", "objective", "runs", "schema", "kind"}) {
    json bad = good;
    bad.erase(key);
    expect_rejected(check(bad), "cannot be read");
  }
  json bad = good;
  bad["extra"] = 1;
  expect_rejected(check(bad), "unknown member");
  DesignResult changed = result;
  changed.certificate.reset();
  expect_rejected(check_certificate(task, changed), "no certificate");
}

}  // namespace
}  // namespace accdec
