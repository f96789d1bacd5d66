#include <accdec/io/figure.hpp>

#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include <gmock/gmock.h>

#include <accdec/io/process.hpp>

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

TEST(Figure, TitlesAreDrawnAndNeverExecuted) {
  const auto touched = std::filesystem::temp_directory_path() / ("accdec-touched-" + std::to_string(::getpid()));
  const std::string touch = "touch " + touched.string();
  for (const std::string& title :
       {std::string("it's 'quoted'"), std::string("\"double\""), std::string("back\\slash \\n"), "`" + touch + "`", "'; system('" + touch + "'); '",
        "line\nsystem('" + touch + "')\n", "cr\r\nEND_OF_DATA\nsystem('" + touch + "')", "$(" + touch + ")", "@" + touch, std::string("a_b^c {d} %g"),
        std::string("<b>&amp;"), std::string("<![CDATA[ ]]> <!-- ]]]>>"), std::string("\xef\xbf\xbe\xef\xbf\xbf"), std::string("µ θ ≤"), std::string("bad \xff\xc0\x80 utf-8"), std::string("zero \0 byte", 11), std::string(300, 'x')}) {
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

TEST(Figure, SixteenMarkedLinesDifferWithoutColour) {
  const auto sample = [](const std::string& script, int style) {
    const std::size_t end = script.find(" title \"style " + std::to_string(style) + "\""), begin = script.rfind("linespoints", end);
    const std::string with = script.substr(begin, end - begin);
    return with.substr(with.find(" lw "));  // after the colour: width, dash and symbol
  };
  Figure figure;
  figure.panels.resize(1);
  for (int style = 0; style < 16; ++style) figure.panels[0].series.push_back({"style " + std::to_string(style), {0, 1, 1, 2}, {0, 0, 1, 1}, Mark::marked_line, style});
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

}  // namespace
}  // namespace accdec
