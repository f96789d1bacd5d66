#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/malformed_tasks.hpp"

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

DesignResult example() {
  return evaluate_task(parse_task(malformed::with_end("[[mode]]\nfrequency_Hz = [38, 46]\nresidual_max = 0.9\n"), "t"));
}

TEST(ResultJson, HoldsTheContract) {
  const DesignResult result = example();
  const Json json = Json::parse(result_to_json(result));
  EXPECT_EQ(json["schema"], "accdec.result/1");
  EXPECT_EQ(json["status"], "feasible");
  EXPECT_EQ(json["sample_period_s"], 1e-3);
  EXPECT_EQ(json["filter"]["order"], 20);
  EXPECT_EQ(json["filter"]["taps"].size(), 21U);
  EXPECT_EQ(json["task"]["corner"][0]["error_max_um"], 400.0);
  EXPECT_EQ(json["task"]["mode"][0]["frequency_Hz"], (std::vector<double>{38, 46}));
  EXPECT_EQ(json["corners"][0]["name"], "A");
  EXPECT_EQ(json["corners"][0]["delay_samples"], 3);
  EXPECT_NEAR(json["corners"][0]["corner_time_s"].get<double>(), 0.024, 1e-15);  // (20 + 1 + 3) T
  EXPECT_NEAR(json["cycle_time_s"].get<double>(), 0.024, 1e-15);
  EXPECT_TRUE(json["lower_bound_s"].is_null());
  EXPECT_TRUE(json["gap"].is_null());
  EXPECT_EQ(json["solver"]["method"], "given");
  EXPECT_TRUE(json["verification"]["feasible"]);
  for (const char* key : {"kind", "axis", "corner", "event", "value", "bound", "utilisation", "sample"})
    EXPECT_TRUE(json["limits"][0].contains(key)) << key;
  EXPECT_EQ(json["limits"].back()["kind"], "vibration");
  EXPECT_TRUE(json["limits"].back().contains("frequency_Hz"));
}

/// One of every kind of rows and nodes, with numbers that only full precision keeps apart.
Certificate certificate_of_every_kind() {
  using namespace proof;
  BranchAndBound proof;
  proof.objective = Objective::cycle;
  proof.runs = 0.1 + 0.2;
  proof.bound_samples = 1e6 / 3.0;
  proof.conflict = {"force x", "quotes \" too"};
  proof.multipliers = {{{TapDifference{3, -1}, 0.1},
                        {EventForce{false, 1, 4}, 1e-300},
                        {EventForce{true, 0, 5}, 0.0},
                        {EventForce{false, 1, 4, 2}, 0.25},
                        {EventForce{true, 0, 5, 0}, 0.5},
                        {proof::Blend{LimitKind::force_speed, 0, 1, 7, -1, 2, -1}, 1.0},
                        {proof::Vibration{1, 40.0, 0.5, 0.0, 2}, 1.0},
                        {proof::Vibration{1, 40.0, 0.5, 0.1, 0}, 1.0},
                        {proof::Blend{LimitKind::acceleration, 1, 0, 7, 1}, 1.0 / 3.0},
                        {proof::Blend{LimitKind::jerk, 0, 1, 7, -1}, 1.0},
                        {proof::Blend{LimitKind::force, 0, 1, 7, -1}, 1.0},
                        {Error{1, 0.1}, 2.0},
                        {RangeError{0, -0.7, {5, true, false}, {-2, false, true}}, 2.0},
                        {proof::Contour{1, true}, 2.0},
                        {Reversal{1, 0, 12, -1}, 2.0},
                        {Budget{}, 5.0},
                        {Vibration{1, 38.1, -3.0}, 2.0},
                        {EventPower{false, 0, 2, 0.1, 0.2}, 2.0},
                        {EventPower{true, 1, 2, 0.1, 0.2}, 2.0},
                        {BlendPower{false, 1, 0, 3, -1, 0.1, 0.2}, 2.0},
                        {BlendPower{true, 0, 1, 3, 1, 0.1, 0.2}, 2.0},
                        {Speed{1, 9, -0.5, 0.25}, 2.0},
                        {Response{4, -1}, 2.0}},
                       {}};
  proof.tree = {Split{1, true, 3},
                Split{0, false, 9},
                OrderSplit{12},
                ResponseSplit{4, 1.0 / 3.0},
                Refuted{1},
                TooLong{},
                Unreachable{},
                SymmetricOrders{},
                RefutedSymmetric{0, -2},
                proof::ContourSplit{1, 4.25},
                ReversalSplit{1, 0, 12}};
  return {proof};
}

TEST(ResultJson, RoundTripIsExact) {
  DesignResult result = example();
  result.lower_bound = 0.1 + 0.2;
  result.gap = 1.0 / 3.0;
  result.certificate = std::make_shared<Certificate>(certificate_of_every_kind());
  result.message = "quotes \" and \n line feeds, \xC3\xA9";
  result.solver = {"nlp", "ipopt", "3.11.9", "solved", 17, 0.25, {}};
  const std::string text = result_to_json(result);
  const DesignResult again = parse_result(text, "r.json");
  EXPECT_EQ(result_to_json(again), text);
  EXPECT_EQ(again.lower_bound, result.lower_bound);
  EXPECT_EQ(again.message, result.message);
  ASSERT_NE(again.certificate, nullptr);
  EXPECT_EQ(*again.certificate, *result.certificate);
  ASSERT_EQ(again.limits.size(), result.limits.size());
  for (std::size_t i = 0; i < result.limits.size(); ++i)
    EXPECT_EQ(again.limits[i].utilisation, result.limits[i].utilisation);
  EXPECT_EQ(again.task.corners[0].geometry().direction_out, result.task.corners[0].geometry().direction_out);
}

TEST(ResultJson, EveryStopReasonComesBack) {
  for (const StopReason reason : stop_reasons) {
    DesignResult result = example();
    result.stop = reason;
    const std::string text = result_to_json(result);
    EXPECT_THAT(text, HasSubstr(fmt::format("\"stop\": \"{}\"", to_string(reason))));
    EXPECT_EQ(parse_result(text, "r.json").stop, reason);
  }
  // Older results have none.
  Json json = Json::parse(result_to_json(example()));
  json.erase("stop");
  EXPECT_EQ(parse_result(json.dump(), "r.json").stop, StopReason::finished);
}

TEST(ResultJson, OtherCertificatesComeBack) {
  proof::BranchAndBound bare;
  bare.objective = Objective::corner;
  for (const Certificate& certificate : {Certificate{proof::ConstantFeed{}}, Certificate{proof::CornerSpeed{}},
                                         Certificate{proof::Enumeration{}}, Certificate{bare}}) {
    DesignResult result = example();
    result.certificate = std::make_shared<Certificate>(certificate);
    const DesignResult again = parse_result(result_to_json(result), "r.json");
    ASSERT_NE(again.certificate, nullptr);
    EXPECT_EQ(*again.certificate, certificate);
  }
}

TEST(ResultJson, WhatIsNotFiniteIsNull) {
  DesignResult result = example();
  result.limits[0].utilisation = unlimited;
  result.limits[0].value = unlimited;
  result.verification.max_violation = unlimited;
  const std::string text = result_to_json(result);
  EXPECT_THAT(text, ::testing::Not(HasSubstr("inf")));
  const DesignResult again = parse_result(text, "r.json");
  EXPECT_EQ(again.limits[0].utilisation, unlimited);
  EXPECT_EQ(again.verification.max_violation, unlimited);
}

TEST(ResultJson, ResultsWithoutFilter) {
  DesignResult result;
  result.task = example().task;
  result.status = Status::infeasible;
  result.message = "force x against friction";
  const DesignResult again = parse_result(result_to_json(result), "r.json");
  EXPECT_FALSE(again.filter);
  EXPECT_EQ(again.status, Status::infeasible);
  EXPECT_EQ(again.message, result.message);
}

std::string message_of(const std::string& text) {
  try {
    parse_result(text, "r.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "was read";
}

/// The message for the example after one change.
template <class Change>
std::string after(Change change) {
  Json json = Json::parse(result_to_json(example()));
  change(json);
  return message_of(json.dump(1));
}

TEST(ResultJson, MalformedResultsSayWhereAndWhat) {
  EXPECT_THAT(message_of(""), HasSubstr("r.json:1:1: the file is empty"));
  EXPECT_THAT(message_of("{\n \"a\": ,\n}"), StartsWith("r.json:2:7: not valid JSON"));
  EXPECT_THAT(message_of("{\"a\": NaN}"), StartsWith("r.json:1:7: not valid JSON"));
  EXPECT_THAT(message_of("{\"a\": 1e999}"), HasSubstr("beyond double precision"));
  EXPECT_THAT(message_of("[]"), HasSubstr("must be an object, got array"));
  EXPECT_THAT(message_of("{}"), HasSubstr("lacks the member `schema`"));
  EXPECT_THAT(message_of(std::string(100000, '[')), HasSubstr("not valid JSON"));
  EXPECT_THAT(
      after([](Json& j) { j["schema"] = "accdec.program/1"; }),
      StartsWith("r.json:2:12: schema: \"accdec.program/1\" is another kind of file; allowed is \"accdec.result/1\""));
  EXPECT_THAT(after([](Json& j) { j["statsu"] = "x"; }), HasSubstr("statsu: unknown member; did you mean `status`?"));
  EXPECT_THAT(after([](Json& j) { j["status"] = "good"; }),
              HasSubstr("r.json:3:12: status: \"good\" is unknown; allowed are optimal, feasible"));
  EXPECT_THAT(after([](Json& j) { j.erase("corners"); }), HasSubstr("lacks the member `corners`"));
  EXPECT_THAT(after([](Json& j) { j["corners"].push_back(j["corners"][0]); }),
              HasSubstr("corners: has 2 entries for the task's 1 corners"));
  EXPECT_THAT(after([](Json& j) { j["corners"][0]["name"] = "Z"; }),
              HasSubstr("corners[0]: is named \"Z\", the task's corner \"A\""));
  EXPECT_THAT(after([](Json& j) { j["corners"][0]["delay_samples"] = -1; }),
              HasSubstr("corners[0].delay_samples: -1 is out of range"));
  EXPECT_THAT(after([](Json& j) { j["corners"][0]["delay_samples"] = 1.5; }), HasSubstr("must be a whole number"));
  EXPECT_THAT(after([](Json& j) { j["corners"][0]["corner_error_m"] = nullptr; }),
              HasSubstr("corners[0].corner_error_m: must be a number, got null"));
  EXPECT_THAT(after([](Json& j) { j["filter"]["taps"].push_back(1); }),
              HasSubstr("filter.taps: has 22 taps; order 20 needs 21"));
  EXPECT_THAT(after([](Json& j) { j["filter"]["taps"][3] = -1; }), HasSubstr("filter.taps: tap b_3 = -1 is negative"));
  EXPECT_THAT(after([](Json& j) { j["sample_period_s"] = 2; }), HasSubstr("differs from the task's 0.001 s"));
  EXPECT_THAT(after([](Json& j) { j["limits"][0]["kind"] = "heat"; }),
              HasSubstr("limits[0].kind: \"heat\" is unknown"));
  EXPECT_THAT(
      after([](Json& j) { j["task"]["corner"][0]["angle_deg"] = 200; }),
      HasSubstr("task.corner[0].angle_deg: `angle_deg` = 200 is out of range; allowed is 0 < angle_deg <= 180"));
  EXPECT_THAT(after([](Json& j) { j["task"]["corner"][0]["eror_max_um"] = 200; }),
              HasSubstr("did you mean `error_max_um`?"));
  EXPECT_THAT(after([](Json& j) { j["task"]["title"] = nullptr; }), HasSubstr("task.title: must not be null"));
  EXPECT_THAT(after([](Json& j) {
                j["task"]["controller"] = {{"file", "mine.toml"}};
              }),
              HasSubstr("task.controller.file: `file` names a file, and none is opened here"));
}

TEST(ResultJson, SaysSeveralErrorsAtOnce) {
  const std::string message = after([](Json& j) {
    j["task"] = 3;
    j["corners"][0]["delay_samples"] = -1;
    j["limits"][0].erase("bound");
  });
  EXPECT_THAT(message,
              ::testing::ContainsRegex("task: must be an object, got number\n.*corners.0..delay_samples: -1 is "
                                       "out of range.*\n.*limits.0.: lacks the member `bound`"));
}

TEST(ResultJson, PositionsOfTaskErrorsAreThoseOfTheResultFile) {
  std::string text = result_to_json(example());
  const std::size_t at = text.find("\"angle_deg\": 95");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 15, "\"angle_deg\": 99999");
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  EXPECT_THAT(message_of(text), StartsWith("r.json:" + std::to_string(line) + ":22: task.corner[0].angle_deg"));
}

// The parser of JSON takes a zero byte for the end of the file: what follows would be read by nobody.
TEST(ResultJson, AZeroByteIsNoEnd) {
  for (const std::string& text : {std::string("5\0{\"\\x\":1}", 11), std::string("{}\0", 3)}) {
    EXPECT_THAT([&] { parse_result(text, "r.json"); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("a zero byte; a result is text")));
  }
}

TEST(Recheck, AcceptsWhatWasWrittenAndRejectsWhatWasChanged) {
  const DesignResult result = parse_result(result_to_json(example()), "r.json");
  const ResultCheck good = verify_result(result);
  EXPECT_TRUE(good.accepted) << ::testing::PrintToString(good.reasons);
  const auto reasons = [&](auto change) {
    DesignResult changed = result;
    change(changed);
    const ResultCheck found = verify_result(changed);
    EXPECT_EQ(found.accepted, found.reasons.empty());
    return ::testing::PrintToString(found.reasons);
  };
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].corner_error *= 1.0 + 1e-6; }), HasSubstr("corner_error_m"));
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].polyline_error *= 1.0 + 1e-6; }), HasSubstr("polyline_error_m"));
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].contour_deviation *= 1.0 + 1e-6; }), HasSubstr("contour_deviation_m"));
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].speed_min *= 1.0 + 1e-6; }), HasSubstr("speed_min_m_s"));
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].corner_time *= 1.0 + 1e-6; }), HasSubstr("corner_time_s"));
  EXPECT_THAT(reasons([](auto& r) { r.cycle_time *= 1.0 - 1e-6; }), HasSubstr("cycle_time_s"));
  EXPECT_THAT(reasons([](auto& r) { r.corners[0].delay = 2; }), HasSubstr("the task gives delay 3, the result has 2"));
  EXPECT_THAT(reasons([](auto& r) { r.filter = Filter(std::vector<double>(21, 1.0)); }),
              HasSubstr("not those of the task's filter"));
  EXPECT_THAT(reasons([](auto& r) { r.limits.pop_back(); }), HasSubstr("limits are recorded"));
  EXPECT_THAT(reasons([](auto& r) { r.limits[1].utilisation *= 0.99; }), HasSubstr("utilisation of"));
  EXPECT_THAT(reasons([](auto& r) { r.limits[1].value *= 0.99; }), HasSubstr("value of"));
  EXPECT_THAT(reasons([](auto& r) { r.limits.back().bound *= 2.0; }), HasSubstr("should be the vibration limit"));
  EXPECT_THAT(reasons([](auto& r) { r.status = Status::optimal; }), HasSubstr("claims optimal without a certificate"));
  EXPECT_THAT(reasons([](auto& r) { r.lower_bound = 0.01; }), HasSubstr("lower bound without a certificate"));
  EXPECT_THAT(reasons([](auto& r) { r.gap = 0.01; }), HasSubstr("a gap is recorded without a lower bound"));
  EXPECT_THAT(reasons([](auto& r) { r.lower_bound = 0.01; }), HasSubstr("lower bound is recorded without a gap"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.performed = false; }), HasSubstr("verification.performed"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.max_violation = 0.5; }), HasSubstr("verification.max_violation"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.tolerance = 1e-3; }), HasSubstr("verification.tolerance"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.worst = "none"; }), HasSubstr("verification.worst"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.certificate_checked = true; }), HasSubstr("without a certificate"));
  EXPECT_THAT(reasons([](auto& r) { r.verification.certificate = "proved"; }), HasSubstr("verification.certificate"));
  EXPECT_THAT(reasons([](auto& r) { r.status = Status::failed; }), HasSubstr("no design to verify"));
  EXPECT_THAT(reasons([](auto& r) { r.task.corners[0].error_max = 1e-6; }),
              HasSubstr("a limit is broken: corner error"));
}

TEST(Recheck, AnInfeasibleResultCarriesNothingBesides) {
  // A limit that constant feed breaks, and a given filter that breaks one whatever the delay.
  Task open = example().task, given = open;
  open.filter.reset();
  for (TaskCorner& corner : open.corners) corner.delay.reset();
  for (Axis& axis : open.machine.axes) axis.damping = 1e3, axis.force_max = 1.0;
  for (TaskCorner& corner : given.corners) corner.delay.reset();
  for (Axis& axis : given.machine.axes) axis.jerk_max = 1e-6;
  for (const Task& task : {open, given}) {
    const DesignResult result = parse_result(result_to_json(design_task(task, {})), "r.json");
    ASSERT_EQ(result.status, Status::infeasible);
    const ResultCheck good = verify_result(result);
    EXPECT_TRUE(good.accepted) << ::testing::PrintToString(good.reasons);
    const auto rejected = [&](auto change) {
      DesignResult changed = result;
      change(changed);
      return !verify_result(changed).accepted;
    };
    EXPECT_TRUE(rejected([](auto& r) { r.cycle_time = 1.0; }));
    EXPECT_TRUE(rejected([](auto& r) { r.corner_time = 1.0; }));
    EXPECT_TRUE(rejected([](auto& r) { r.stop = StopReason::time_limit; }));
    EXPECT_TRUE(rejected([](auto& r) { r.lower_bound = 1.0; }));
    EXPECT_TRUE(rejected([](auto& r) { r.gap = 1.0; }));
    EXPECT_TRUE(rejected([](auto& r) { r.filter = Filter({1.0}); }));
    EXPECT_TRUE(rejected([](auto& r) { r.corners.push_back({}); }));
    EXPECT_TRUE(rejected([](auto& r) { r.limits.push_back({}); }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.performed = true; }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.feasible = true; }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.max_violation = 0.1; }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.tolerance = 1e-9; }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.worst = "jerk x"; }));
    EXPECT_TRUE(rejected([](auto& r) { r.verification.certificate = "proved"; }));
  }
}

TEST(ResultJson, SaysWhatIsNotConsidered) {
  DesignResult result = example();
  using List = std::vector<std::string>;
  const auto listed = [](const DesignResult& r) {
    return nlohmann::ordered_json::parse(result_to_json(r))["not_considered"].get<List>();
  };
  result.task.machine.modes.clear();
  EXPECT_EQ(listed(result), (List{"vibration", "servo"}));
  result.task.machine.modes.push_back({.frequency_low = 40, .frequency_high = 41, .residual_max = 0.1});
  EXPECT_EQ(listed(result), List{"servo"});
  // The list follows from the task; older results have none.
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(result_to_json(example()));
  json.erase("not_considered");
  EXPECT_NO_THROW(parse_result(json.dump(), "r"));
  json["not_considered"] = List{"gravity"};
  EXPECT_THAT(message_of(json.dump()),
              HasSubstr("not_considered[0]: \"gravity\" is unknown; allowed are vibration, servo"));
  json["not_considered"] = List{"servo", "servo"};
  EXPECT_THAT(message_of(json.dump()), HasSubstr("not_considered: must be ["));
}

TEST(ResultJson, TapsAreNotScaledAndKeysStandOnce) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(result_to_json(example()));
  for (auto& tap : json["filter"]["taps"]) tap = 2.0 * tap.get<double>();
  EXPECT_THAT(message_of(json.dump()), HasSubstr("filter.taps: have the sum 2; it must be 1"));
  std::string text = result_to_json(example());
  text.replace(text.find("\"gap\""), 0, "\"status\": \"optimal\",\n  ");
  EXPECT_THAT(message_of(text), HasSubstr("stands twice"));
}

}  // namespace
}  // namespace accdec
