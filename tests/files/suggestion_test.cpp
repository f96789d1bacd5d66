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
  EXPECT_EQ(suggest("error_max_mm", keys), "did you mean `error_max_um`? Its number is in um, not in mm");
  EXPECT_EQ(suggest("eror_max_um", keys), "did you mean `error_max_um`?");
  constexpr std::string_view axis[] = {"velocity_max_mm_s", "acceleration_max_mm_s2", "jerk_max_mm_s3"};
  EXPECT_EQ(suggest("accel_max_mm_s2", axis), "did you mean `acceleration_max_mm_s2`?");
  EXPECT_EQ(suggest("vel_max_m_s", axis), "did you mean `velocity_max_mm_s`? Its number is in mm/s, not in m/s");
  EXPECT_EQ(suggest("acceleration_max_mm_min2", axis),
            "did you mean `acceleration_max_mm_s2`? Its number is in mm/s^2, not in mm/min^2");
  EXPECT_EQ(nearest("acc_mm_s2", axis), "") << "an acceleration, but which?";
  constexpr std::string_view two[] = {"a", "b"};
  EXPECT_EQ(suggest("something", two), "known here: a, b");
}

}  // namespace
}  // namespace accdec
