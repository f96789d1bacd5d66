#include <algorithm>
#include <numbers>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/comparison/suite_file.hpp>

#include "compare_command.hpp"
#include "support/paths.hpp"

// Problems drawn at random: [[hypercube]] of a suite.

namespace accdec {
namespace {

using ::testing::HasSubstr;

/// The cell of every value in a range cut into as many cells as there are values.
std::set<int> cells(const std::vector<double>& values, double low, double high) {
  std::set<int> found;
  for (const double v : values)
    found.insert(static_cast<int>((v - low) / (high - low) * static_cast<double>(values.size()) * (1.0 - 1e-9)));
  return found;
}

TEST(Hypercube, BenchmarkHasFiveHundredDesignsOfEveryKind) {
  const std::string path = test_support::source_folder() + "/problems/suite/benchmark-500.toml";
  const Suite suite = read_suite(path);
  std::set<std::string> names, identities, families;
  std::set<std::size_t> corners;
  int equal = 0, smallest_speed = 0, modes = 0, jerk = 0, force = 0, power = 0, regeneration = 0;
  double least_angle = 4.0, most_angle = 0.0;
  for (const auto& c : suite.cases) {
    names.insert(c.name);
    families.insert(c.family);
    identities.insert(c.identity);
    corners.insert(c.task.corners.size());
    const TaskCorner& corner = c.task.corners.front();
    const double angle = std::get<PlanarLegs>(corner.legs()).angle;
    least_angle = std::min(least_angle, angle);
    most_angle = std::max(most_angle, angle);
    equal += corner.geometry().feed_in == corner.geometry().feed_out ? 1 : 0;
    smallest_speed += corner.speed_min > 0.0 ? 1 : 0;
    const Axis& axis = c.task.machine.axes.front();
    modes += c.task.machine.modes.empty() ? 0 : 1;
    jerk += axis.jerk_max < unlimited ? 1 : 0;
    force += axis.force_max < unlimited ? 1 : 0;
    power += axis.power_max < unlimited ? 1 : 0;
    regeneration += axis.regeneration_max < unlimited ? 1 : 0;
    EXPECT_EQ(c.question, comparison::Question::design);
    EXPECT_LE(c.order, 200) << c.name << ": such a choice is not written down";
  }
  EXPECT_EQ(suite.cases.size(), 500u);
  EXPECT_EQ(names.size(), 500u);
  EXPECT_EQ(identities.size(), 500u);
  EXPECT_EQ(families.size(), 10u);
  EXPECT_THAT(corners, ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  for (const int kind : {equal, 500 - equal, smallest_speed, modes, jerk, force, power, regeneration})
    EXPECT_GE(kind, 40);
  EXPECT_LT(least_angle, 0.4);
  EXPECT_GT(most_angle, 2.9);
  EXPECT_EQ(read_suite(path).hash, suite.hash) << "drawn twice, the same";
}

class HypercubeSuite : public testing::CompareCommand {
 protected:
  Suite drawn(const std::string& more, const std::string& ranges, int count = 20) {
    testing::write(home_ / "drawn.toml",
                   fmt::format("solvers = [\"exact\"]\n[[hypercube]]\nname = \"h\"\ntask = \"task.toml\"\n"
                               "formulation = \"design\"\ncount = {}\n{}\n[hypercube.ranges]\n{}\n",
                               count, more, ranges));
    return read_suite((home_ / "drawn.toml").string());
  }
};

TEST_F(HypercubeSuite, MarginIsNoFormulationOfHypercubes) {
  drawn("", "\"corner.*.angle_deg\" = [20, 170]");
  std::string text = testing::content(home_ / "drawn.toml");
  text.replace(text.find("\"design\""), 8, "\"margin\"");
  testing::write(home_ / "drawn.toml", text);
  EXPECT_THAT(run("compare drawn.toml --out none").output,
              ::testing::HasSubstr("unknown formulation of a hypercube \"margin\"; known are delay, design"));
}

TEST_F(HypercubeSuite, EveryCellIsUsedOnceByEachCornerByItself) {
  const int count = 20;
  const Suite suite = drawn("corners = 3\nseed = 3\nexpected = \"feasible\"\norder_factor = [1, 3]",
                            "\"corner.*.angle_deg\" = [20, 170]\n\"axis.*.jerk_max_mm_s3\" = [100000, 1000000]", count);
  ASSERT_EQ(suite.cases.size(), static_cast<std::size_t>(count));
  std::vector<double> jerk;
  std::vector<std::vector<double>> angles(3);
  for (const auto& c : suite.cases) {
    EXPECT_EQ(c.expected, comparison::Expected::feasible);
    EXPECT_EQ(c.family, "h");
    jerk.push_back(1e3 * c.task.machine.axes.front().jerk_max);
    ASSERT_EQ(c.task.corners.size(), 3u);
    for (std::size_t j = 0; j < 3; ++j)
      angles[j].push_back(std::get<PlanarLegs>(c.task.corners[j].legs()).angle * 180.0 / std::numbers::pi);
  }
  EXPECT_EQ(cells(jerk, 1e5, 1e6).size(), static_cast<std::size_t>(count));
  for (const auto& of_corner : angles) EXPECT_EQ(cells(of_corner, 20.0, 170.0).size(), static_cast<std::size_t>(count));
  EXPECT_NE(angles[0], angles[1]);
  // Another seed draws others.
  EXPECT_NE(drawn("corners = 3\nseed = 4", "\"corner.*.angle_deg\" = [20, 170]").hash,
            drawn("corners = 3\nseed = 5", "\"corner.*.angle_deg\" = [20, 170]").hash);
}

TEST_F(HypercubeSuite, WrongTablesAreRefusedAtTheirPlace) {
  const auto refused = [&](const std::string& more, const std::string& ranges) {
    try {
      drawn(more, ranges, 3);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused("", "\"corner.*.angle_deg\" = [170, 20]"), HasSubstr("drawn.toml:9:24: range"));
  EXPECT_THAT(refused("", "\"corner.*.angle_deg\" = 90"), HasSubstr("must be two numbers, the lower first"));
  EXPECT_THAT(refused("", "\"corner.*.angle_deg\" = [1, nan]"), HasSubstr("must be two numbers"));
  EXPECT_THAT(refused("", "\"corner.*.angel_deg\" = [20, 90]"), HasSubstr("angle_deg"));
  EXPECT_THAT(refused("", "\"corner.*.angle_deg\" = [90, 700]"), HasSubstr("problem \"h 00"));
  EXPECT_THAT(refused("corners = [3, 1]", "\"corner.*.angle_deg\" = [20, 90]"),
              HasSubstr("`corners` needs one number"));
  EXPECT_THAT(refused("order_factor = [1, 2, 3]", "\"corner.*.angle_deg\" = [20, 90]"), HasSubstr("order_factor"));
  EXPECT_THAT(refused("corners = 0", "\"corner.*.angle_deg\" = [20, 90]"), HasSubstr("corners"));
  testing::write(home_ / "none.toml", "solvers = [\"exact\"]\n");
  EXPECT_THROW(read_suite((home_ / "none.toml").string()), InputError);
}

}  // namespace
}  // namespace accdec
