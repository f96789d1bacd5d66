#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "support/study_command.hpp"

// Tests the content of a study's page; tests/pages tests how it behaves in a browser.

namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

using accdec::testing::content;
using accdec::testing::StudyCommand;
using accdec::testing::write;

/// The numbers that a figure of a page has for the pointer.
nlohmann::json panel_of(const std::string& html, const std::string& figure) {
  const std::string open = "<script type=\"application/json\">";
  const std::size_t begin = html.find(open, html.find(fmt::format("<figure id=\"{}\">", figure))) + open.size();
  return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin)).at("panels").at(0);
}

TEST_F(StudyCommand, ThePageHasTheBaseTasksLimitsAndSaysWhatIsVaried) {
  study(3);
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  const std::string html = content(home_ / "out/report.html");
  EXPECT_THAT(html, ContainsRegex("<td class=\"n\"[^>]*>8000</td><td class=\"n\"[^>]*>800000</td>"));
  EXPECT_THAT(html, ContainsRegex("<td[^>]*>A</td><td[^>]*>varied \\(angle\\)</td>"));
  EXPECT_THAT(html, HasSubstr("delays: 9 of 12 points have an answer"));
  EXPECT_LT(html.find("have an answer"), html.find("<figure")) << "the answer leads";
  EXPECT_THAT(html, HasSubstr("<table id=\"rows\" class=\"sorts\">"));
  const nlohmann::json panel = panel_of(html, "times");
  ASSERT_EQ(panel.at("series").size(), 2u);
  // Tolerances of a line, to the bit: 1 to 300, even in the logarithm.
  EXPECT_EQ(panel.at("series")[0].at("x").front(), 1.0);
  EXPECT_EQ(panel.at("series")[0].at("x").back(), 300.0);
}

TEST_F(StudyCommand, LongLinesAndFineMapsAreDrawnWithAsManyPointsAsCanBeSeen) {
  write(home_ / "study.toml", R"(task = "task.toml"
compute = ["given"]
[[vary]]
name = "angle"
key = "corner.A.angle_deg"
range = { from = 20, to = 170, count = 8501 }
[[vary]]
name = "feed"
key = "corner.A.feed_in_mm_min"
values = [3000, 6000]
[[figure]]
name = "line"
x = "angle"
y = "given.error_um"
where = { feed = 6000 }
[[figure]]
name = "map"
kind = "heat"
x = "angle"
y = "feed"
z = "given.error_um"
)");
  ASSERT_EQ(run("study study.toml --out out").exit_code, 0);
  const std::string html = content(home_ / "out/report.html");
  const nlohmann::json line = panel_of(html, "line");
  const auto y = line.at("series")[0].at("y").get<std::vector<double>>();
  EXPECT_EQ(y.size(), 8000u);
  // The error falls from the sharpest to the flattest corner: both ends must be there, as the CSV has them.
  const std::string csv = content(home_ / "out/rows.csv");
  EXPECT_THAT(csv, HasSubstr(fmt::format(",{},", *std::max_element(y.begin(), y.end()))));
  EXPECT_EQ(line.at("series")[0].at("x").front(), 20.0);
  EXPECT_EQ(line.at("series")[0].at("x").back(), 170.0);
  EXPECT_EQ(y.front(), *std::max_element(y.begin(), y.end()));
  EXPECT_EQ(y.back(), *std::min_element(y.begin(), y.end()));
  const nlohmann::json heat = panel_of(html, "map").at("heat");
  EXPECT_EQ(heat.at("x").size(), 387u) << "every 22nd of 8501";
  EXPECT_EQ(heat.at("y").size(), 2u);
  EXPECT_THAT(html, HasSubstr("387 of 8501 values of x"));
  EXPECT_THAT(html, HasSubstr("The first 1000 of 17002 rows"));
}

}  // namespace
