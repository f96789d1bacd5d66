#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files/file_kind.hpp>

namespace accdec {
namespace {

using ::testing::HasSubstr;

TEST(WrongKind, IsNamedAsWhatItSeemsToBe) {
  EXPECT_EQ(wrong_kind("# a comment\n[[corner]]\nangle_deg = 90\n", InputKind::task), "");
  EXPECT_THAT(wrong_kind("[[vary]]\n", InputKind::task), HasSubstr("seems to be a study"));
  EXPECT_THAT(wrong_kind("{\"schema\": \"accdec.result/1\"}", InputKind::task), HasSubstr("seems to be a result"));
  EXPECT_THAT(wrong_kind("%\nG1 X1\n", InputKind::task), HasSubstr("`accdec explore` take with --task"));
  EXPECT_THAT(wrong_kind("<svg>", InputKind::task), HasSubstr("a page or a figure"));
}

// Whatever is shorter than the words that are looked for; the address sanitizer watches.
TEST(WrongKind, ReadsNothingBehindTheEnd) {
  const std::string text = "[[problem]]";
  for (std::size_t n = 0; n < text.size(); ++n) {
    const std::string part = text.substr(0, n);
    EXPECT_EQ(wrong_kind(part, InputKind::suite), "") << part;
    EXPECT_EQ(wrong_kind("c" + part, InputKind::study), "") << part;
  }
}

}  // namespace
}  // namespace accdec
