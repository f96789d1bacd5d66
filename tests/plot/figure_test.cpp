#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <accdec/files/process.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/figure_layout.hpp>

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Figure line_figure(const std::string& title) {
  Panel panel;
  panel.title = title;
  panel.x.label = title;
  panel.series.push_back({title, {0, 1, 2}, {0, 1, 4}, Mark::line_points, 1});
  panel.limits.push_back({3.0, title});
  panel.circles.push_back({1, 1, 0.5, title});
  panel.bands.push_back({0.5, 0.7, title});
  Figure figure;
  figure.title = title;
  figure.panels = {panel};
  return figure;
}

/// rsvg-convert reads strict XML only: a drawing it turns into a PNG is well-formed.
void expect_well_formed(const std::string& svg) {
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_EQ(convert_svg(svg, "png").substr(1, 3), "PNG");
}

TEST(Figure, SameFigureSameBytes) {
  const std::string svg = render_svg(line_figure("plain"));
  expect_well_formed(svg);
  EXPECT_EQ(svg, render_svg(line_figure("plain")));
}

TEST(Figure, DrawingsAndCurvesAreNamedByTheirTitlesOnly) {
  Figure figure = line_figure("of <one> curve");
  figure.panels[0].series.push_back({"", {0, 1}, {1, 0}, Mark::line, 2});
  const std::string svg = render_svg(figure);
  EXPECT_THAT(svg, HasSubstr("<title>of &lt;one&gt; curve</title>"));
  EXPECT_THAT(svg, Not(HasSubstr("<title>Gnuplot")));
  EXPECT_THAT(svg, Not(AnyOf(HasSubstr("gnuplot"), HasSubstr("GNUPLOT"))));
  expect_well_formed(svg);
  figure.title.clear();
  EXPECT_THAT(render_svg(figure), Not(HasSubstr("<title>Gnuplot")));
}

TEST(Figure, TitlesAreDrawnAndNeverExecuted) {
  const auto touched = std::filesystem::temp_directory_path() / ("accdec-touched-" + std::to_string(::getpid()));
  const std::string touch = "touch " + touched.string();
  for (const std::string& title :
       {std::string("it's 'quoted'"), std::string("\"double\""), std::string("back\\slash \\n"), "`" + touch + "`",
        "'; system('" + touch + "'); '", "line\nsystem('" + touch + "')\n",
        "cr\r\nEND_OF_DATA\nsystem('" + touch + "')", "$(" + touch + ")", "@" + touch, std::string("a_b^c {d} %g"),
        std::string("<b>&amp;"), std::string("<![CDATA[ ]]> <!-- ]]]>>"), std::string("\xef\xbf\xbe\xef\xbf\xbf"),
        std::string("µ θ ≤"), std::string("bad \xff\xc0\x80 utf-8"), std::string("zero \0 byte", 11),
        std::string(300, 'x')}) {
    const std::string svg = render_svg(line_figure(title));
    expect_well_formed(svg);
    EXPECT_FALSE(std::filesystem::exists(touched)) << title;
  }
  EXPECT_THAT(render_svg(line_figure("`date` 'x' \\y")), HasSubstr("`date` 'x' \\y"));
  EXPECT_THAT(render_svg(line_figure("a < b & c")), HasSubstr("a &lt; b &amp; c"));
}

TEST(Figure, CleanTitleIsOneLineOfUtf8) {
  EXPECT_EQ(clean_title("a\nb\tc"), "a b c");
  EXPECT_EQ(clean_title("µm ≤ 𝛆"), "µm ≤ 𝛆");
  EXPECT_EQ(clean_title("\xc0\x80|\xed\xa0\x80|\xff"), "??|???|?");
  EXPECT_EQ(clean_title("cut \xe2\x89"), "cut ??");
}

TEST(Figure, LongTitlesAreWrappedAndLongLabelsShortened) {
  const std::string words = "many words of a title that goes on and on and on for ever, ";
  Figure figure = line_figure("label");
  figure.title = words + words + words;
  const PageLayout page = layout(figure);
  EXPECT_GE(page.title.size(), 3U);
  for (const std::string& one : page.title) EXPECT_LE(text_width(one) * 15.0 / 12.0, page.width);
  EXPECT_THAT(render_svg(figure), HasSubstr(">" + page.title[1] + "<"));
  const std::string cut = shortened(std::string(300, 'x') + "end", 200.0);
  EXPECT_LE(text_width(cut), 200.0);
  EXPECT_THAT(cut, ::testing::StartsWith("xxx"));
  EXPECT_THAT(cut, ::testing::EndsWith("end"));
  EXPECT_THAT(cut, HasSubstr("…"));
  EXPECT_EQ(shortened("short", 200.0), "short");
  EXPECT_THAT(wrapped("a bc  d", 1000.0), ::testing::ElementsAre("a bc  d"));
  EXPECT_THAT(wrapped("iiii iiii", 20.0), ::testing::ElementsAre("iiii", "iiii"));
  EXPECT_THAT(wrapped("iiiiiiii", 16.0), ::testing::ElementsAre("iiii", "iiii"));
}

TEST(Figure, LabelsOfLogarithmicAxesDoNotMeet) {
  EXPECT_THAT(log_ticks(1.0, 1e4, 400.0, 0.0), ::testing::IsEmpty()) << "gnuplot's own, 100 px apart, do";
  for (const auto& [low, high, pixels] :
       {std::tuple{1e-2, 1e4, 170.0}, std::tuple{1e-9, 1e9, 300.0}, std::tuple{1e-3, 1e6, 300.0}}) {
    const std::vector<Tick> ticks = log_ticks(low, high, pixels, 0.0);
    double before = -INFINITY;
    int labels = 0;
    for (const Tick& tick : ticks) {
      if (tick.label.empty()) continue;
      const double middle = pixels * std::log(tick.value / low) / std::log(high / low),
                   half = 0.5 * text_width(tick.label);
      EXPECT_GT(middle - half, before);
      before = middle + half;
      ++labels;
    }
    EXPECT_GE(labels, 2);
  }
  // Less than a decade has no power of ten to label.
  const auto narrow = log_ticks(2.0, 8.0, 300.0, 0.0);
  ASSERT_EQ(narrow.size(), 2U);
  EXPECT_EQ(narrow[0].label + narrow[1].label, "25");
  // Small and large numbers are powers of ten, all of them.
  for (const auto& [low, high] : {std::pair{4e-5, 3e-4}, std::pair{2e5, 1.5e6}}) {
    const auto ticks = log_ticks(low, high, 300.0, 0.0);
    ASSERT_GE(ticks.size(), 2U);
    for (const Tick& tick : ticks) EXPECT_NE(tick.label.find("10"), std::string::npos) << tick.label;
  }
}

TEST(Figure, NumbersOfAnAxisHaveOneNotation) {
  Figure figure;
  figure.panels.resize(1);
  figure.panels[0].series.push_back({"", {0, 1}, {-1e6, 1e6}, Mark::line, 0});
  const std::string svg = render_svg(figure);
  EXPECT_THAT(svg, HasSubstr(">500000<"));
  EXPECT_THAT(svg, HasSubstr(">1000000<"));
  EXPECT_THAT(svg, Not(HasSubstr("e+06")));
}

TEST(Figure, DrawsHeatMapsLogAxesAndEmptyPanels) {
  Figure figure = line_figure("log");
  figure.panels[0].y.log = true;
  Panel heat;
  heat.heat_map = HeatMap{{0, 1, 2}, {0, 1}, {1, 2, 3, 4, 5, 6}, "value"};
  figure.panels.push_back(heat);
  figure.panels.push_back({});
  Panel flat;
  flat.series.push_back({"flat", {0, 1}, {2, 2}, Mark::steps, 2});
  flat.equal_aspect = true;
  figure.panels.push_back(flat);
  figure.columns = 2;
  expect_well_formed(render_svg(figure));
}

TEST(Figure, CellsOfAHeatMapReachHalfWayToTheirNeighbours) {
  EXPECT_THAT(cell_edges({1, 2, 5, 9}, false), ::testing::ElementsAre(0.5, 1.5, 3.5, 7, 11));
  EXPECT_THAT(cell_edges({1, 100, 1e6}, true),
              ::testing::Pointwise(::testing::DoubleNear(1e-5), {0.1, 10.0, 1e4, 1e8}));
  EXPECT_THAT(cell_edges({4}, false), ::testing::ElementsAre(2, 6));
  // Cells fill the plot: uneven values, logarithmic or not.
  for (const bool log : {false, true}) {
    Figure figure;
    figure.panels.resize(1);
    figure.panels[0].y.log = log;
    figure.panels[0].heat_map = HeatMap{{0, 1}, {5, 10, 20, 50, 400}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, ""};
    const std::string script = gnuplot_script(figure);
    const auto edges = cell_edges({5, 10, 20, 50, 400}, log);
    EXPECT_THAT(script, HasSubstr(fmt::format("set yrange [{:.10g}:{:.10g}] noextend", edges.front(), edges.back())));
    EXPECT_THAT(script, HasSubstr(fmt::format("\n1 50 0.5 1.5 {:.10g} {:.10g} 8\n", edges[3], edges[4])));
    expect_well_formed(render_svg(figure));
  }
}

TEST(Figure, ColoursOfAHeatMapDarkenAndBeginOffThePaper) {
  const std::string script = [] {
    Figure figure;
    figure.panels.resize(1);
    figure.panels[0].heat_map = HeatMap{{0, 1}, {0, 1}, {1, 2, 3, 4}, ""};
    return gnuplot_script(figure);
  }();
  // Relative luminance by Rec. 709 of the palette's colours; between them it is linear in the components, which all
  // fall.
  const auto component = [](const std::string& hex) { return std::pow(std::stoi(hex, nullptr, 16) / 255.0, 2.2); };
  double before = 0.65;  // paper has 1
  for (std::size_t at = script.find("set palette");
       (at = script.find('#', at + 1)) < script.find('\n', script.find("set palette"));) {
    const double luminance = 0.2126 * component(script.substr(at + 1, 2)) +
                             0.7152 * component(script.substr(at + 3, 2)) +
                             0.0722 * component(script.substr(at + 5, 2));
    EXPECT_LT(luminance, before);
    before = luminance - 0.1;
  }
  EXPECT_LT(before, 0.0);
}

TEST(Figure, SaysWhenThereIsNothingToDraw) {
  Figure figure;
  figure.panels.resize(2);
  figure.panels[0].y.log = true;
  figure.panels[0].series.push_back({"zeros", {0, 1}, {0, -1}, Mark::line, 0});
  figure.panels[1].series.push_back({"one", {0, 1}, {0, 1}, Mark::line, 0});
  EXPECT_FALSE(has_data(figure.panels[0]));
  EXPECT_TRUE(has_data(figure.panels[1]));
  const std::string svg = render_svg(figure), words = ">no data<";
  const std::size_t at = svg.find(words);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(svg.find(words, at + 1), std::string::npos) << "in one panel only";
  Panel heat;
  heat.heat_map = HeatMap{{1, 2}, {1, 2}, {NAN, NAN, NAN, NAN}, ""};
  EXPECT_FALSE(has_data(heat));
  figure.panels = {heat};
  EXPECT_THAT(render_svg(figure), HasSubstr(words));
}

TEST(Figure, SixteenMarkedLinesDifferWithoutColour) {
  const auto sample = [](const std::string& script, int style) {
    const std::size_t end = script.find(" title \"style " + std::to_string(style) + "\""),
                      begin = script.rfind("linespoints", end);
    const std::string with = script.substr(begin, end - begin);
    return with.substr(with.find(" lw "));  // after the colour: width, dash and symbol
  };
  Figure figure;
  figure.panels.resize(1);
  for (int style = 0; style < 16; ++style)
    figure.panels[0].series.push_back(
        {"style " + std::to_string(style), {0, 1, 1, 2}, {0, 0, 1, 1}, Mark::marked_line, style});
  const std::string script = gnuplot_script(figure);
  std::set<std::string> seen;
  for (int style = 0; style < 16; ++style) seen.insert(sample(script, style));
  EXPECT_EQ(seen.size(), 16U);
  expect_well_formed(render_svg(figure));
}

TEST(Figure, SymbolsOfAMarkedLineAreOnIt) {
  // y = log10(x) on a logarithmic axis is straight, so the symbols must have that y though the line has but two points.
  Figure figure;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.x = {"x", true, 1.0, 1000.0};
  panel.series.push_back({"", {1, 1000}, {0, 3}, Mark::marked_line, 3});
  std::istringstream script(gnuplot_script(figure));
  std::string line;
  while (std::getline(script, line) && line.find("$d2 <<") == std::string::npos) {
  }
  int symbols = 0;
  double x = 0.0, y = 0.0, before = 0.0;
  while (script >> x >> y) {
    EXPECT_NEAR(y, std::log10(x), 1e-8);
    if (symbols++ > 0) {
      EXPECT_NEAR(y - before, 0.5, 1e-8) << "six over three decades";
    }
    before = y;
  }
  EXPECT_EQ(symbols, 6);
}

TEST(Figure, RefusesWhatCannotBeDrawn) {
  Figure figure;
  EXPECT_THROW(gnuplot_script(figure), std::invalid_argument);
  figure = line_figure("t");
  figure.panels[0].series[0].y.pop_back();
  EXPECT_THROW(gnuplot_script(figure), std::invalid_argument);
  figure = line_figure("t");
  figure.panels[0].heat_map = HeatMap{{0, 1}, {0, 1}, {1, 2, 3}, ""};
  EXPECT_THROW(gnuplot_script(figure), std::invalid_argument);
}

TEST(Figure, FormatsByExtension) {
  EXPECT_EQ(figure_format("a/b.svg"), "svg");
  EXPECT_EQ(figure_format("x.html"), "html");
  for (const char* bad : {"x.gif", "svg", "x", "-", "x.SVGZ"}) {
    try {
      figure_format(bad);
      FAIL() << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(".svg, .png, .pdf or .html"));
    }
  }
  const std::string svg = render_svg(line_figure("a <title>"));
  EXPECT_EQ(convert_svg(svg, "pdf").substr(0, 5), "%PDF-");
  const std::string html = convert_svg(svg, "html", "a <title>");
  EXPECT_THAT(html, HasSubstr("<title>a &lt;title&gt;</title>"));
  EXPECT_THAT(html, HasSubstr("<svg"));
  EXPECT_THAT(html, Not(HasSubstr("<?xml")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
}

TEST(Process, NamesThePackageOfAMissingProgram) {
  try {
    run_process({"accdec-no-such-program"}, "", "some-package");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("not installed (Debian package some-package)"));
  }
}

TEST(Process, FeedsMoreThanAPipeHoldsAndReportsExitCodes) {
  const std::string much(1 << 20, 'x');
  EXPECT_EQ(run_process({"cat"}, much, "coreutils").output, much);
  EXPECT_EQ(run_process({"false"}, much, "coreutils").exit_code, 1);
}

TEST(GnuplotScript, ValuesOfBothSignsGetAPaletteAroundZero) {
  Figure figure;
  figure.panels.resize(1);
  figure.panels[0].heat_map = HeatMap{{0, 1}, {0, 1}, {-1, 2, 3, NAN}, ""};
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("set cbrange [-3:3]"));
  figure.panels[0].heat_map = HeatMap{{0, 1}, {0, 1}, {0, 2, 3, NAN}, ""};
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("set cbrange [*:*]"));
  figure.panels[0].heat_map->with_sign = true;
  EXPECT_THAT(gnuplot_script(figure), HasSubstr("set cbrange [-3:3]"));
}

}  // namespace
}  // namespace accdec
