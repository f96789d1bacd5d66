#include <gtest/gtest.h>

#include <accdec/files/suggestion.hpp>

namespace accdec {
namespace {

TEST(EditDistance, CountsSingleEditsAndSwaps) {
  EXPECT_EQ(edit_distance("", ""), 0);
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);  // the textbook example
  EXPECT_EQ(edit_distance("ca", "ac"), 1);
  EXPECT_EQ(edit_distance("ca", "abc"), 3);  // optimal string alignment, not the unrestricted distance (2)
  EXPECT_EQ(edit_distance("weight", "wieght"), 1);
}

TEST(Suggestion, NearestKey) {
  constexpr std::string_view keys[] = {"error_max_um", "speed_min_mm_s", "delay_samples",
                                       "weight",       "feed_in_mm_min", "feed_out_mm_min"};
  EXPECT_EQ(nearest("error_max_mm", keys), "error_max_um");
  EXPECT_EQ(nearest("error_max_m", keys), "error_max_um");
  EXPECT_EQ(nearest("error_max", keys), "error_max_um");
  EXPECT_EQ(nearest("feed_out_m_min", keys), "feed_out_mm_min");
  EXPECT_EQ(nearest("Feed-In", keys), "feed_in_mm_min");
  EXPECT_EQ(nearest("speed_min_m_s", keys), "speed_min_mm_s");
  EXPECT_EQ(nearest("colour", keys), "");
  EXPECT_EQ(nearest("", keys), "");
  EXPECT_EQ(suggest("weigth", keys), "did you mean `weight`?");
  constexpr std::string_view two[] = {"a", "b"};
  EXPECT_EQ(suggest("something", two), "known here: a, b");
}

}  // namespace
}  // namespace accdec
