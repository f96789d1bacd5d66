#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/figure_layout.hpp>

namespace accdec {
namespace {

using ::testing::HasSubstr;

/// The place where a text of the drawing begins, px.
std::pair<double, double> place_of(const std::string& svg, const std::string& text) {
  const std::size_t at = svg.find(">" + text + "</");
  EXPECT_NE(at, std::string::npos) << text;
  if (at == std::string::npos) return {NAN, NAN};
  const std::size_t begin = svg.rfind("translate(", at) + 10;
  return {std::stod(svg.substr(begin)), std::stod(svg.substr(svg.find(',', begin) + 1))};
}

TEST(Figure, LegendsOfManyLongLabelsStandBesideTheDataInOneColumn) {
  Figure figure;
  figure.columns = 2;
  figure.panel_width = 640;
  figure.panel_height = 380;
  figure.panels.resize(2);
  const auto label = [](int i) { return "a solver with an option of limited memory " + std::to_string(100 + i); };
  for (int i = 0; i < 43; ++i) {
    figure.panels[0].series.push_back({label(i), {0, 1}, {0, 1}, Mark::marked_line, i});
  }
  figure.panels[1].series.push_back({"short", {0, 1}, {0, 1}, Mark::marked_line, 0});
  const PageLayout page = layout(figure);
  const PanelLayout &one = page.panels[0], &two = page.panels[1];
  const std::string svg = render_svg(figure);
  const auto first = place_of(svg, label(0));
  double above = 0.0;
  for (int i = 0; i < 43; ++i) {
    const auto [x, y] = place_of(svg, label(i));
    EXPECT_NEAR(x, first.first, 0.1) << "one column";
    EXPECT_GE(y, above + 11.5) << "lines apart at 12 px letters";
    above = y;
  }
  EXPECT_GT(first.first, one.plot_left + one.plot_width);
  EXPECT_LE(first.first + text_width(label(0)), two.x) << "ends before the next panel";
  EXPECT_LE(above, one.y + one.height) << "ends with the panel";
  EXPECT_GE(one.plot_width, 300.0);
  EXPECT_DOUBLE_EQ(two.width, 640.0) << "only what needs the room grows";
}

TEST(Figure, ALongLabelOfALegendIsWrappedSoThatThePlotKeepsItsWidth) {
  const std::string label = "two averages (trapezoidal acceleration, the industry's S-curve)";
  Figure figure;
  figure.panel_width = 760;
  figure.panel_height = 430;
  figure.panels.resize(1);
  figure.panels[0].series.push_back({"designed", {0, 1}, {0, 1}, Mark::line_points, 0});
  figure.panels[0].series.push_back({label, {0, 1}, {1, 0}, Mark::line_points, 1});
  figure.panels[0].series.push_back({"last", {0, 0.5}, {1, 1}, Mark::line_points, 2});
  const PageLayout page = layout(figure);
  EXPECT_DOUBLE_EQ(page.width, 760.0);
  EXPECT_GE(page.panels[0].plot_width, 0.55 * page.width);
  const std::string svg = render_svg(figure);
  // Every word of the label, in its order, in lines between those of its neighbours.
  const std::vector<std::string> lines = legend_lines(label, page.panels[0].legend_line);
  ASSERT_GE(lines.size(), 2U);
  std::string all;
  double above = place_of(svg, "designed").second;
  for (const std::string& line : lines) {
    all += (all.empty() ? "" : " ") + line;
    const auto [x, y] = place_of(svg, line);
    EXPECT_NEAR(x, place_of(svg, "designed").first, 0.1);
    EXPECT_LE(x + text_width(line), page.width);
    EXPECT_GE(y, above + 11.5);
    above = y;
  }
  EXPECT_EQ(all, label);
  EXPECT_GE(place_of(svg, "last").second, above + 11.5);
}

// Lines that end at one height: their labels stand below each other around it, in the order of the lines.
TEST(Figure, FewLabelsStandAtTheEndsOfTheirLines) {
  Figure figure;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.y.min = 0.0, panel.y.max = 1.0;
  const std::vector<std::pair<std::string, double>> lines{{"low", 0.0}, {"high", 1.0}, {"here", 0.5}, {"there", 0.5}};
  for (const auto& [label, y] : lines) panel.series.push_back({label, {0, 1}, {0.2, y}, Mark::line, 0});
  ASSERT_EQ(legend_kind(figure, panel), LegendKind::ends);
  const PageLayout page = layout(figure);
  const PanelLayout& place = page.panels[0];
  const std::string svg = render_svg(figure);
  double above = 0.0, here = 0.0;
  for (const char* label : {"high", "here", "there", "low"}) {
    const auto [x, y] = place_of(svg, label);
    EXPECT_GT(x, place.plot_left + place.plot_width);
    EXPECT_LE(x + text_width(label), page.width);
    EXPECT_GE(y, above + 12.0) << label;
    EXPECT_LE(y, place.plot_top + place.plot_height + 6.0) << label;
    above = y, here += std::string_view(label).ends_with("here") ? 0.5 * y : 0.0;
  }
  EXPECT_NEAR(here - 4.5, place.plot_top + 0.5 * place.plot_height, 2.0) << "letters of 12 px stand on their line";
  panel.series[0].x[1] = 0.5;
  EXPECT_EQ(legend_kind(figure, panel), LegendKind::column) << "one line ends elsewhere";
}

TEST(Figure, ALabelAloneIsATitleUnlessItIsThereAlready) {
  Figure figure;
  figure.title = "Two averages: excess";
  figure.panels.resize(1);
  figure.panels[0].series.push_back({"two averages", {0, 1}, {0, 1}, Mark::points, 0});
  EXPECT_EQ(panel_title(figure, figure.panels[0]), "");
  EXPECT_DOUBLE_EQ(layout(figure).panels[0].plot_width, figure.panel_width - 70 - 18) << "no room for a legend";
  figure.panels[0].series[0].label = "one pole";
  figure.panels[0].title = "time";
  EXPECT_EQ(panel_title(figure, figure.panels[0]), "time: one pole");
  figure.panels[0].series[0].label = "x";
  EXPECT_EQ(panel_title(figure, figure.panels[0]), "time: x") << "a letter of another word is not there";
  figure.panels[0].limits.push_back({0.5, ""});
  EXPECT_EQ(legend_kind(figure, figure.panels[0]), LegendKind::column) << "which line has the label?";
}

TEST(Figure, OneLegendNamesEachLabelOnceAboveAllPanels) {
  Figure figure;
  figure.columns = 2, figure.one_legend = true;
  figure.panels.resize(2);
  for (Panel& panel : figure.panels) {
    panel.series.push_back({"designed", {0, 1}, {0, 1}, Mark::line, 1, true});
    panel.series.push_back({"dashed", {0, 1}, {1, 0}, Mark::line, 1, true, 1});
  }
  figure.panels[1].limits.push_back({0.5, "limit"});
  for (int i = 0; i < 30; ++i) figure.panels[1].series.push_back({fmt::format("label {}", i), {0, 1}, {0, 1}});
  const PageLayout page = layout(figure);
  ASSERT_EQ(page.legend.size(), 33U);
  EXPECT_GT(page.legend.back().y, page.legend.front().y) << "in rows";
  for (const LegendPlace& place : page.legend) {
    // Pages show each column by itself on a phone.
    const double column = place.x < 0.5 * page.width ? 0.0 : 0.5 * page.width;
    EXPECT_GE(place.x, column);
    EXPECT_LE(place.x + legend_sample + text_width(place.label), column + 0.5 * page.width);
    EXPECT_LT(place.y, page.panels[0].y);
  }
  EXPECT_DOUBLE_EQ(page.panels[0].plot_width, page.panels[1].plot_width);
  // Its samples have the dashes of the lines.
  const std::string svg = render_svg(figure);
  const std::string sample = fmt::format("M{:.2f},{:.2f}", page.legend[1].x, page.legend[1].y);
  const std::size_t at = svg.find(sample);
  ASSERT_NE(at, std::string::npos) << sample;
  EXPECT_NE(svg.substr(svg.rfind("<path", at), at - svg.rfind("<path", at)).find("dasharray"), std::string::npos);
}

TEST(Figure, ALabelLongerThanALineIsNotCut) {
  const std::string label = "ipopt-lbfgs, mu_strategy monotone, nlp_scaling_method none, nlp_scaling_max_gradient 100";
  ASSERT_GT(text_width(label), 420.0);
  std::string all;
  for (const std::string& line : legend_lines(label, 420.0)) all += (all.empty() ? "" : " ") + line;
  EXPECT_EQ(all, label);
}

TEST(Figure, PanelsWithOneQuantityBelowEachOtherAreInLine) {
  Figure figure;
  figure.columns = 2;
  figure.panels.resize(6);
  for (Panel& panel : figure.panels) {
    panel.x.label = "time / ms";
    panel.series.push_back({"", {0, 1}, {0, 1}, Mark::line, 0});
  }
  figure.panels[0].x.label = "x / mm";
  figure.panels[2].series[0].label = "a label";
  figure.panels[4].series[0].y = {0, 1000000};
  const PageLayout page = layout(figure);
  EXPECT_DOUBLE_EQ(page.panels[2].plot_left, page.panels[4].plot_left);
  EXPECT_DOUBLE_EQ(page.panels[2].plot_width, page.panels[4].plot_width);
  EXPECT_GT(page.panels[0].plot_width, page.panels[2].plot_width) << "another quantity";
  EXPECT_GT(page.panels[1].plot_width, page.panels[2].plot_width) << "another column";
}

TEST(GnuplotScript, NamesStandInPlaceOfNumbers) {
  Figure figure;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.series.push_back({"", {1, 2}, {1, 2}, Mark::points, 0});
  const double plain = layout(figure).panels[0].plot_left;
  panel.y.names = {"acceleration-jerk", "it's"};
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("acceleration-jerk"));
  EXPECT_GT(layout(figure).panels[0].plot_left, plain + 50.0);  // room for 17 letters
}

TEST(Layout, APanelAloneInItsRowFillsIt) {
  Figure figure;
  figure.columns = 2;
  figure.panels.resize(3);
  const PageLayout page = layout(figure);
  EXPECT_DOUBLE_EQ(page.panels[2].width, page.width);
  EXPECT_DOUBLE_EQ(page.panels[1].width, 0.5 * page.width);
}

TEST(Layout, ATallPanelMakesItsRowTaller) {
  Figure figure;
  figure.columns = 2;
  figure.panels.resize(4);
  figure.panels[1].taller = 1.5;
  const PageLayout page = layout(figure);
  EXPECT_DOUBLE_EQ(page.panels[0].height, 1.5 * figure.panel_height);
  EXPECT_DOUBLE_EQ(page.panels[2].height, figure.panel_height);
}

}  // namespace
}  // namespace accdec
