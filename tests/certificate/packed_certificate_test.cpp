#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/exact/exact.hpp>
#include <accdec/files/packed_text.hpp>

#include "support/certificates.hpp"
#include "support/tasks.hpp"

// Long certificates are packed in the file; what is packed has to be as good as what is not.

namespace accdec {
namespace {

using nlohmann::json;

class PackedCertificate : public ::testing::Test {
 protected:
  static DesignResult design() {
    Axis axis;
    axis.acceleration_max = 8.0;
    axis.jerk_max = 800.0;
    return design_exact(testing::plane_task(axis, testing::plane_corner("A", 77, 0, 0.1, 0.1), 50e-6));
  }
  static json packed(const std::string& text) {
    return {{"gzip", pack_text(text)}, {"kind", "packed"}, {"schema", "accdec.certificate/1"}};
  }
  CheckReport check(const json& certificate) const { return testing::check_forged(result.task, result, certificate); }
  void expect_refused(const json& certificate, const std::string& why) const {
    const CheckReport report = check(certificate);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find(why), std::string::npos) << report.reason;
  }
  DesignResult result = design();
  json good = testing::certificate_json(result);
};

TEST_F(PackedCertificate, IsReadLikeAPlainOne) {
  const CheckReport plain = check(good), unpacked = check(packed(good.dump()));
  EXPECT_TRUE(plain.accepted) << plain.reason;
  EXPECT_TRUE(unpacked.accepted) << unpacked.reason;
  EXPECT_EQ(plain.reason, unpacked.reason);
}

// Multipliers that no leaf names make it long without making it wrong.
TEST_F(PackedCertificate, IsWrittenAboveAMegabyteOnly) {
  EXPECT_EQ(json::parse(result_to_json(result))["certificate"]["kind"], "branch and bound");
  Certificate certificate = *result.certificate;
  auto& proof = std::get<proof::BranchAndBound>(certificate.proof);
  for (int i = 0; i < 60'000; ++i) proof.multipliers.push_back({{proof::Error{0, 1e-5 * i}, 1.0 / (i + 3)}});
  DesignResult large = result;
  large.certificate = std::make_shared<Certificate>(certificate);
  const std::string file = result_to_json(large);
  const std::size_t plain = certificate_to_json(certificate).size();
  ASSERT_GT(plain, 1'000'000u);
  EXPECT_EQ(json::parse(file)["certificate"]["kind"], "packed");
  EXPECT_LT(file.size(), plain / 2);
  const DesignResult read = parse_result(file, "large.json");
  ASSERT_TRUE(read.certificate);
  EXPECT_EQ(*read.certificate, certificate);
  EXPECT_TRUE(check_certificate(read.task, read).accepted);
}

TEST_F(PackedCertificate, ForgedOnesAreRefused) {
  json forged = good;
  forged["tree"] = json::array({nullptr});
  expect_refused(packed(forged.dump()), "left out as too long");
  forged = good;
  forged["bound_samples"] = 1e6;
  EXPECT_FALSE(check(packed(forged.dump())).accepted);
  forged = good;
  forged["surprise"] = 1;
  expect_refused(packed(forged.dump()), "unknown member");
  const std::string text = good.dump();
  expect_refused(packed(text.substr(0, text.size() / 2)), "not valid JSON");
  expect_refused(packed(text + text), "not valid JSON");
  expect_refused(packed(text + '\0' + text), "zero byte");
  expect_refused(packed("{\"kind\": \"constant feed\", \"kind\": \"enumeration\"}"), "twice");
  expect_refused(packed("[]"), "must be an object");
  expect_refused(packed(packed(text).dump()), "more than once");
  expect_refused(packed(std::string(40'000'000, ' ')), "MB");
}

TEST_F(PackedCertificate, DamagedLettersAreRefused) {
  json certificate = packed(good.dump());
  const std::string letters = certificate["gzip"];
  for (const std::string& bad : {std::string(), letters.substr(0, letters.size() - 4), letters.substr(4), "=" + letters,
                                 letters + letters, std::string("AAAA")}) {
    certificate["gzip"] = bad;
    const CheckReport report = check(certificate);
    EXPECT_FALSE(report.accepted);
    EXPECT_NE(report.reason.find("certificate.gzip"), std::string::npos) << report.reason;
  }
  for (const json& bad : {json(nullptr), json(7), json::array()}) {
    certificate["gzip"] = bad;
    EXPECT_FALSE(check(certificate).accepted);
  }
}

}  // namespace
}  // namespace accdec
