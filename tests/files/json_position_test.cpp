#include <string>

#include <gtest/gtest.h>

#include <accdec/files/json_position.hpp>

namespace accdec {
namespace {

TEST(JsonPosition, KeysThatStandTwice) {
  const auto second = [](const std::string& json) -> long {
    const auto at = duplicate_key(json);
    return at ? static_cast<long>(*at) : -1;
  };
  EXPECT_EQ(second(R"({"a": 1, "a": 2})"), 9);
  EXPECT_EQ(second(R"({"a": {"b": 1}, "b": [1, {"b": 1}, {"b": "a"}], "c": "b"})"), -1);
  EXPECT_EQ(second(R"([{"a": 1}, {"a": 1, "b": [], "a": 1}])"), 29);
  EXPECT_EQ(second(R"({"x": {"c": [{"d": 0, "e": 0, "d": 0}]}})"), 30);
  EXPECT_EQ(second(R"({"a": 1, "\u0061": 2})"), 9) << "the same key, written otherwise";
  EXPECT_EQ(second(R"({"a\"": 1, "a": ",\"a\":", "b": "{}"})"), -1);
  EXPECT_EQ(second("[]"), -1);
  EXPECT_EQ(second("3"), -1);
}

}  // namespace
}  // namespace accdec
