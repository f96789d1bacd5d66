#include <string>

#include <gtest/gtest.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/files/shown_text.hpp>

#include "support/run.hpp"

namespace accdec {
namespace {

TEST(ShownText, HoldsNoControlCharacters) {
  EXPECT_EQ(printable("a\x1b[31m\x07\rb\x7f"), "a\\x1b[31m\\x07\\x0db\\x7f");
  EXPECT_EQ(printable("C1: \xC2\x9B"
                      "31m, \xC2\xB5m"),
            "C1: \\xc2\\x9b31m, \xC2\xB5m");
  // U+202E, U+2068 and U+FEFF; beside them, U+2014 is an ordinary dash.
  EXPECT_EQ(printable("a\xE2\x80\xAE"
                      "b\xE2\x81\xA8\xEF\xBB\xBF, \xE2\x80\x94"),
            "a\\xe2\\x80\\xaeb\\xe2\\x81\\xa8\\xef\\xbb\\xbf, \xE2\x80\x94");
  EXPECT_EQ(printable("cut \xE2\x80"), "cut \xE2\x80");
  EXPECT_EQ(printable("two\n\tlines, \xC3\xA4"), "two\n\tlines, \xC3\xA4");
}

// A shell gives back what was quoted.
TEST(ShownText, AShellReadsQuotedArguments) {
  EXPECT_EQ(shell_quoted("problems/corner/a-1.toml"), "problems/corner/a-1.toml");
  for (const std::string argument : {"", "two words", "it's", "$(rm x); `y` \"z\" \\ & * ? !", "\x1b[31m'\\\n",
                                     "\xC2\x9B", "\xE2\x80\xAE x", "~/x", "\xC3\xA4 b"}) {
    const TemporaryFolder folder;
    test_support::wait_for(test_support::start_shell("exec bash -c " + quoted("printf %s " + shell_quoted(argument)),
                                                     folder.path("out"), folder.path("err")));
    EXPECT_EQ(folder.read("out"), argument);
    EXPECT_EQ(folder.read("err"), "");
  }
}

// A number above a limit does not look like the limit.
TEST(ShownText, NumbersAboveALimitLookSo) {
  EXPECT_EQ(shown_above(2.04, 2.0), "2.04");
  EXPECT_EQ(shown_above(2.4, 2.0), "2.4");
  EXPECT_EQ(shown_above(1234.0, 60.0), "1.2e+03");
  EXPECT_EQ(shown_above(60.000001, 60.0), "60.000001");
  EXPECT_EQ(shown_above(2.0 + 4e-16, 2.0), "2.0000000000000004");
}

// A spreadsheet takes a field that begins so for a formula.
TEST(CsvField, NamesAreNoFormulas) {
  EXPECT_EQ(csv_field("=1+1"), "'=1+1");
  EXPECT_EQ(csv_field("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(csv_field("+x"), "'+x");
  EXPECT_EQ(csv_field("-x,y"), "\"'-x,y\"");
  EXPECT_EQ(csv_field("-1.5e-3"), "-1.5e-3");
  EXPECT_EQ(csv_field("+2"), "+2");
  EXPECT_EQ(csv_field("a=b"), "a=b");
}

}  // namespace
}  // namespace accdec
