#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/program_result.hpp"

// Every value of a result is changed or put out of its kind, one at a time.

namespace accdec {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Pointers to all values; of a list the first, the middle and the last, or only the first.
void values(const Json& json, const Json::json_pointer& at, bool first, std::vector<Json::json_pointer>& all) {
  all.push_back(at);
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) values(value, at / key, first, all);
  } else if (json.is_array()) {
    const std::size_t size = json.size();
    for (std::size_t i = 0; i < size; ++i) {
      if (i == 0 || (!first && (i == size / 2 || i + 1 == size))) values(json[i], at / i, first, all);
    }
  }
}

/// Each value as null, as each other kind, huge, and left out.
/// @param tried  values of these places are passed over; the others are added
template <class Check>
void for_each_wrong(const Json& good, std::set<std::string>& tried, const Check& check) {
  std::vector<Json::json_pointer> all;
  values(good, Json::json_pointer(), true, all);
  for (const Json::json_pointer& at : all) {
    if (!tried.insert(at.to_string()).second) continue;
    for (const Json& wrong : {Json(nullptr), Json("x"), Json::array(), Json::object(), Json(1e300)}) {
      if (good[at].type() == wrong.type()) continue;
      Json bad = good;
      bad[at] = wrong;
      check(bad, at.to_string() + " as " + wrong.dump());
    }
    if (at.empty() || at.back().find_first_not_of("0123456789") == std::string::npos) continue;
    Json bad = good;
    bad[at.parent_pointer()].erase(at.back());
    check(bad, at.to_string() + " left out");
  }
}

void expect_house_message(const Outcome& outcome, const std::string& what) {
  EXPECT_THAT(outcome.code, AnyOf(0, 1, 2)) << what;
  EXPECT_THAT(outcome.out + outcome.err,
              Not(AnyOf(HasSubstr("json.exception"), HasSubstr("std::"), HasSubstr("basic_"))))
      << what;
  if (outcome.code != 2) return;
  EXPECT_THAT(outcome.err, HasSubstr("result.json")) << what;
}

TEST_F(ProgramResult, ValuesOfOtherKindsAreNamedInItsOwnWords) {
  std::set<std::string> tried;  // one reader reads what all plans have
  for (const std::vector<std::string>& how : {std::vector<std::string>{"--plan", "fixed"}, {"--plan", "free"}}) {
    ASSERT_EQ(plan(how).code, 0);
    for_each_wrong(json(), tried,
                   [&](const Json& bad, const std::string& what) { expect_house_message(changed(bad), what); });
  }
  ASSERT_EQ(plan().code, 0);
  const Json good = json();
  Json bad = good;
  bad["samples"] = nullptr;
  EXPECT_THAT(changed(bad).err, HasSubstr("samples: must be a whole number, got null"));
  bad = good;
  bad["commands"]["points_m"][3] = "x";
  EXPECT_THAT(changed(bad).err, HasSubstr("commands.points_m[3]: must be a number, got string"));
  bad = good;
  bad["commands"].erase("dwell");
  EXPECT_THAT(changed(bad).err, HasSubstr("commands: lacks the member `dwell`"));
}

TEST_F(ProgramResult, ValuesOfDesignsOfOtherKindsAreNamedInItsOwnWords) {
  const std::string task = folder_.write("corner.toml",
                                         "sample_period_ms = 1.0\n[[axis]]\nacceleration_max_mm_s2 = 6000\n"
                                         "jerk_max_mm_s3 = 2000000\n[[corner]]\nangle_deg = 90\n"
                                         "feed_in_mm_min = 3000\nerror_max_um = 50\n");
  ASSERT_EQ(run({"design", task, "--json", result_}).code, 0);
  std::set<std::string> tried;
  for_each_wrong(json(), tried,
                 [&](const Json& bad, const std::string& what) { expect_house_message(changed(bad), what); });
}

// The arc tolerance is doubled, because a slightly larger one gives the same chords.
TEST_F(ProgramResult, NoNumberOfInputsAndCommandsCanBeForged) {
  for (const char* how : {"fixed", "profiles", "free"}) {
    if (how != std::string("fixed")) {
      std::string task = folder_.read("mill.toml");
      if (const std::size_t at = task.find("[filter]"); at != std::string::npos)
        task.erase(at, task.find("[[axis]]") - at);
      folder_.write("mill.toml", task);
    }
    ASSERT_EQ(plan({"--plan", how, "--time-limit", "3"}).code, 0);
    const Json good = json();
    ASSERT_EQ(verify().code, 0) << verify().out;
    std::vector<Json::json_pointer> all;
    for (const char* part : {"inputs", "commands"})
      values(good[part], Json::json_pointer("/" + std::string(part)), false, all);
    for (const Json::json_pointer& at : all) {
      if (!good[at].is_number() && !good[at].is_null()) continue;
      Json bad = good;
      bad[at] = at.back() == "arc_tolerance_m" ? Json(2.0 * good[at].get<double>()) : forged(good[at]);
      // To a free motion a feed is an upper bound, which it may keep if it is a little lower. A step may be as long as
      // the faster feed of the blocks at its ends allows, so all chords of an arc are slowed together.
      if (how == std::string("free") && at.parent_pointer().back() == "duration_s") {
        const double alike = good[at].get<double>();
        for (Json& duration : bad[at.parent_pointer()]) {
          if (std::abs(duration.get<double>() - alike) < 1e-2 * alike) duration = 1e3 * duration.get<double>();
        }
      }
      // A sample of a free motion that is at 0 but for rounding stays there.
      if (at.parent_pointer().back() == "positions_m" && std::abs(bad[at].get<double>()) < 1e-12) continue;
      EXPECT_NE(changed(bad).code, 0) << how << " " << at.to_string() << " as " << bad[at].dump();
    }
  }
}

}  // namespace
}  // namespace accdec
