#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/design.hpp>
#include <accdec/exact/exact.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"

// Proofs in which corners that ask the same are one.

namespace accdec {
namespace {

using nlohmann::json;

/// Five corners of two kinds; the last but for its tolerance like the first.
Task five_corners() {
  Axis axis;
  axis.acceleration_max = 6.0;
  axis.jerk_max = 800.0;
  Task task = testing::plane_task(axis, testing::plane_corner("A", 95, 10, 0.1, 0.1), 50e-6);
  const auto add = [&](const char* name, double angle, double heading, double error) {
    task.corners.push_back(
        testing::plane_task(axis, testing::plane_corner(name, angle, heading, 0.1, 0.1), error).corners[0]);
    task.corners.back().weight = static_cast<double>(task.corners.size());
  };
  add("B", 60, 40, 30e-6);
  add("C", 95, 190, 50e-6);
  add("D", 60, 130, 30e-6);
  add("E", 95, 10, 40e-6);
  task.design.order_max = 100;
  return task;
}

class MergedCertificate : public ::testing::Test {
 protected:
  MergedCertificate() : task(five_corners()), result(design_task(task)), good(testing::certificate_json(result)) {}
  CheckReport check(const json& certificate) const { return testing::check_forged(task, result, certificate); }
  Task task;
  DesignResult result;
  json good;
};

// The same as the joint proof of all five, which merges nothing.
TEST_F(MergedCertificate, ShortestAsWithoutMerging) {
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  EXPECT_EQ(good["corner_of"], json({0, 1, 0, 1, 2}));
  const CheckReport report = check(good);
  EXPECT_TRUE(report.accepted) << report.reason;
  const DesignResult apart = design_exact(task);
  ASSERT_EQ(apart.status, Status::optimal);
  EXPECT_DOUBLE_EQ(result.objective(), apart.objective());
  EXPECT_FALSE(testing::certificate_json(apart).contains("corner_of"));
}

TEST_F(MergedCertificate, CornersThatAreNotTheSame) {
  for (const json& kinds :
       {json({0, 1, 0, 1, 0}), json({0, 0, 0, 0, 0}), json({0, 1, 1, 0, 2}), json({0, 1, 0, 2, 1})}) {
    json bad = good;
    bad["corner_of"] = kinds;
    const CheckReport report = check(bad);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find("for one, but they are not"), std::string::npos) << report.reason;
  }
}

TEST_F(MergedCertificate, KindsThatAreNone) {
  for (const json& kinds : {json({0, 1, 0, 1}), json({0, 1, 0, 1, 2, 2}), json({1, 0, 1, 0, 2}), json({0, 1, 0, 1, 3}),
                            json({0, 1, 0, 1, -1}), json({0, 1, 0, 1, 0.5}), json("all")}) {
    json bad = good;
    bad["corner_of"] = kinds;
    EXPECT_FALSE(check(bad).accepted) << kinds;
  }
}

// Without the merging the tree is about other corners; merging more than it was made for changes what delays cost.
TEST_F(MergedCertificate, ProofsOfOtherMergings) {
  json bad = good;
  bad.erase("corner_of");
  EXPECT_FALSE(check(bad).accepted);
  bad["corner_of"] = {0, 1, 2, 3, 4};
  EXPECT_FALSE(check(bad).accepted);
}

// A proof of three corners is one of the whole only as long as the members are as the first.
TEST_F(MergedCertificate, ATaskInWhichAMemberChanged) {
  for (std::size_t j = 0; j < 4; ++j) {
    Task other = task;
    *other.corners[j].error_max *= 1.01;
    EXPECT_FALSE(testing::check_forged(other, result, good).accepted) << j;
  }
}

}  // namespace
}  // namespace accdec
