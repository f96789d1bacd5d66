#include <functional>

#include <gmock/gmock.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"

// Claims of a proved result that contradict each other, its certificate or its simulation.

namespace accdec {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Forgery {
  const char* what;
  std::function<void(DesignResult&)> forge;
  const char* reason;
};

void expect_refused(const DesignResult& result, const std::vector<Forgery>& forgeries) {
  ASSERT_EQ(result.status, Status::optimal);
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  for (const Forgery& forgery : forgeries) {
    DesignResult forged = result;
    forgery.forge(forged);
    const ResultCheck check = verify_result(forged);
    EXPECT_FALSE(check.accepted) << forgery.what;
    EXPECT_THAT(check.reasons, ::testing::Contains(HasSubstr(forgery.reason))) << forgery.what;
  }
}

DesignResult designed(const char* problem) {
  return design_task(read_task(test_support::source_folder() + "/problems/" + problem));
}

/// Claims that no result may make, for a searched or a given filter.
std::vector<Forgery> contradictions() {
  return {
      {"feasible without a gap", [](auto& r) { r.status = Status::feasible; }, "that is optimal"},
      {"feasible with a certificate and no bound",
       [](auto& r) { r.status = Status::feasible, r.lower_bound.reset(), r.gap.reset(); },
       "a certificate is recorded without a lower bound"},
      {"optimal without a bound", [](auto& r) { r.lower_bound.reset(), r.gap.reset(); },
       "a certificate is recorded without a lower bound"},
      {"optimal with a gap", [](auto& r) { r.lower_bound = 0.9 * r.objective(), r.gap = 0.1; },
       "claims optimal with a lower bound below the cycle time"},
      {"optimal with a gap and no other bound", [](auto& r) { r.gap = 0.1; }, "gap is recorded as 0.1, found 0"},
      {"optimal, but stopped", [](auto& r) { r.stop = StopReason::time_limit; }, "the search was stopped: time limit"},
      {"optimal, but interrupted", [](auto& r) { r.stop = StopReason::interrupted; }, "the search was stopped"},
      {"optimal with a gap reached", [](auto& r) { r.stop = StopReason::gap_reached; }, "the search was stopped"},
      {"optimal without a certificate", [](auto& r) { r.certificate.reset(); }, "claims optimal without a certificate"},
      {"a gap reached that is not there",
       [](auto& r) {
         r.status = Status::feasible, r.stop = StopReason::gap_reached;
         r.certificate.reset(), r.lower_bound.reset(), r.gap.reset();
       },
       "records that a gap was reached, but no gap"},
      {"checked, nobody knows what", [](auto& r) { r.verification.certificate_checked = true; },
       "certificate_checked is recorded without what the check found"},
      {"found by no check", [](auto& r) { r.verification.certificate = "all is well"; },
       "verification.certificate is recorded of a certificate that was not checked"},
      {"a check that found something else",
       [](auto& r) { r.verification.certificate_checked = true, r.verification.certificate = "all is well"; },
       "verification.certificate is recorded as \"all is well\", found: "},
  };
}

TEST(ForgedResult, ContradictionsOfASearchAreRefused) {
  const DesignResult result = designed("corner/acceleration-jerk.toml");
  expect_refused(result, contradictions());
  // A bound that is true, but not the one of the certificate, and a gap to it.
  expect_refused(result, {{"a lower bound than the proved one",
                           [](auto& r) {
                             r.status = Status::feasible, r.stop = StopReason::time_limit;
                             r.lower_bound = 0.9 * r.objective(), r.gap = 0.1;
                           },
                           "the certificate proves"}});
}

TEST(ForgedResult, ContradictionsOfAGivenFilterAreRefused) {
  const DesignResult result = designed("machine/given-filter.toml");
  expect_refused(result, contradictions());
  expect_refused(result, {{"delays that are smallest, and not",
                           [](auto& r) {
                             r.status = Status::feasible, r.stop = StopReason::time_limit;
                             r.lower_bound = 0.9 * r.objective(), r.gap = 0.1;
                           },
                           "proves the delays to be the smallest, but the status is feasible"}});
}

TEST(ForgedResult, WhatACheckFoundMayBeRecorded) {
  DesignResult result = designed("corner/acceleration-jerk.toml");
  result.verification.certificate = verify_result(result).proof;
  result.verification.certificate_checked = true;
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  result.verification.certificate_checked = false;
  EXPECT_FALSE(verify_result(result).accepted);
}

// A boxcar of 21 taps accelerates alike in 21 samples. Each of them is where the limit is used most, and no later one
// of the blend.
TEST(ForgedResult, ALimitIsUsedMostWhereItSays) {
  DesignResult result = design_task(parse_task(R"(sample_period_ms = 1.0
[filter]
kind = "boxcar"
order = 20
[[axis]]
acceleration_max_mm_s2 = 6000
[[corner]]
angle_deg = 90
feed_in_mm_min = 6000
error_max_um = 200
)",
                                               "task.toml"));
  ASSERT_THAT(verify_result(result).reasons, IsEmpty());
  LimitUse& x = result.limits[0];
  ASSERT_EQ(x.kind, LimitKind::acceleration);
  x.event = Event::start;
  int places = 0;
  for (x.sample = -10; x.sample < 100; ++x.sample) {
    const ResultCheck check = verify_result(result);
    places += check.accepted ? 1 : 0;
    if (!check.accepted) {
      EXPECT_THAT(check.reasons, ElementsAre(HasSubstr("where it is not used most")));
    }
  }
  EXPECT_EQ(places, 21);
  x.sample = 100'000;
  EXPECT_FALSE(verify_result(result).accepted);
}

TEST(ForgedResult, ALimitIsMeasuredAtPlacesOfItsKind) {
  const DesignResult result = designed("corner/vibration-band.toml");
  ASSERT_THAT(verify_result(result).reasons, IsEmpty());
  for (std::size_t i = 0; i < result.limits.size(); ++i) {
    const auto refused = [&](auto change) {
      DesignResult forged = result;
      change(forged.limits[i]);
      return ::testing::PrintToString(verify_result(forged).reasons);
    };
    const auto measured = HasSubstr("at which no");
    if (result.limits[i].kind == LimitKind::vibration) {
      EXPECT_THAT(refused([](LimitUse& u) { u.sample = 7; }), measured);
      EXPECT_THAT(refused([](LimitUse& u) { u.event = Event::blend; }), measured);
      EXPECT_THAT(refused([](LimitUse& u) { u.frequency = 1.0; }), measured);
      EXPECT_THAT(refused([](LimitUse& u) { u.damping = -0.9; }), measured);
    } else {
      EXPECT_THAT(refused([](LimitUse& u) { u.frequency = 7.0; }), measured);
      EXPECT_THAT(refused([](LimitUse& u) { u.damping = 0.1; }), measured);
    }
    if (result.limits[i].kind == LimitKind::corner_error) {
      EXPECT_THAT(refused([](LimitUse& u) { u.event = Event::start; }), measured);
    }
  }
}

/// Each member counts under a limit that refutes it: the sum alone is not enough.
TEST(ForgedResult, MembersOfAFamilyCountUnderWhatRefutesThem) {
  const auto count_as = [](DesignResult& result, const char* rule, int members) {
    Certificate other = *result.certificate;
    auto& refuted = std::get<proof::FamilyEnumeration>(other.proof).refuted;
    ASSERT_GT(refuted.front().members, members);
    refuted.front().members -= members;
    refuted.push_back({refuted.front().family, rule, members});
    result.certificate = std::make_shared<Certificate>(std::move(other));
  };
  const char* const reason = "counts other refuted members";
  expect_refused(designed("settings/two-averages.toml"),
                 {{"one under another limit", [&](auto& r) { count_as(r, "velocity", 1); }, reason},
                  {"many under delays", [&](auto& r) { count_as(r, "delays", 5); }, reason}});
}

}  // namespace
}  // namespace accdec
