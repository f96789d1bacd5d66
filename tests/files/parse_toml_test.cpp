#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files.hpp>
#include <accdec/files/parse_toml.hpp>

namespace accdec {
namespace {

std::string times(std::size_t n, const std::string& part) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) text += part;
  return text;
}

/// "" if the text is read, otherwise "line:column: message".
std::string refused(const std::string& text) {
  try {
    toml_input::parse_toml(text, "f");
    return "";
  } catch (const InputError& error) {
    return std::to_string(error.line()) + ":" + std::to_string(error.column()) + ": " + error.message();
  }
}

TEST(ParseToml, RefusesNestingThatWouldOverflowTheStack) {
  const auto is_too_deep = ::testing::EndsWith("nest more than 64 deep; no key of accdec does");
  EXPECT_THAT(refused(times(50'000, "a.") + "a = 1\n"), is_too_deep);
  EXPECT_THAT(refused("[" + times(50'000, "a.") + "a]\n"), is_too_deep);
  EXPECT_THAT(refused("[[" + times(50'000, "a . ") + "a]]\n"), is_too_deep);
  EXPECT_THAT(refused(times(50'000, "'a'.\"b\".") + "a = 1\n"), is_too_deep);
  EXPECT_THAT(refused("a = " + times(50'000, "[") + times(50'000, "]") + "\n"), is_too_deep);
  EXPECT_THAT(refused("a = " + times(50'000, "{a=") + "1" + times(50'000, "}") + "\n"), is_too_deep);
  EXPECT_THAT(refused("a = " + times(50'000, "[{a.a=") + "1"), is_too_deep);
  EXPECT_THAT(refused("b = \"\\\"\"\n  " + times(64, "a.") + "a = 1\n"), ::testing::StartsWith("2:130: "));
}

TEST(ParseToml, CountsNothingInStringsAndComments) {
  const std::string dots(1000, '.'), brackets(1000, '[');
  for (const std::string& text : {dots, brackets}) {
    EXPECT_EQ(refused("# " + text + "\na = 1 # " + text + "\n"), "");
    EXPECT_EQ(refused("a = \"\\\"" + text + "\"\nb = '" + text + "\\'\n"), "");
    EXPECT_EQ(refused("a = \"\"\"\n\"" + text + "\"\"\"\"\"\nb = '''" + text + "'''''\n"), "");
  }
  EXPECT_EQ(refused("a = [" + times(1000, "1.5, ") + "2.5]\n" + times(63, "b.") + "b = 1\n"), "");
  EXPECT_EQ(refused("a = " + times(64, "[") + times(64, "]") + "\n"), "");
}

// Such a number would be read as 0, which often means something else.
TEST(ParseToml, RefusesNumbersThatReadAsZero) {
  EXPECT_THAT(refused("a = 1\nb = 1e-400\n"), ::testing::StartsWith("2:5: the number is too small"));
  EXPECT_THAT(refused("[t]\nb = [0.0, 0e-400, +0.003E-999]\n"), ::testing::StartsWith("2:19: "));
  EXPECT_EQ(refused("a = 0.0\nb = [0e0, -0.0, 0e5, 1e-300]\nc = {d = 0.0_0e9}\n"), "");
}

TEST(ParseToml, RefusesIntegersThatNoDoubleHolds) {
  EXPECT_THAT(refused("b = [1, 9007199254740993]\n"), ::testing::StartsWith("1:9: the integer has more digits"));
  EXPECT_THAT(refused("[t]\nb = -9223372036854775807\n"), ::testing::StartsWith("2:5: the integer has more digits"));
  EXPECT_EQ(refused("a = 9007199254740992\nb = -9007199254740992\n"), "");
}

}  // namespace
}  // namespace accdec
