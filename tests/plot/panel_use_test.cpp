#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/plot/figure_frame.hpp>
#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>

#include "support/paths.hpp"

namespace accdec {
namespace {

/// How much of a panel's width and height lies between the first and the last thing drawn in it, 0 to 1.
class Use {
 public:
  Use(const Panel& panel, const PanelLayout& place)
      : panel_(panel), frame_(panel_frame(panel, place.plot_width, place.plot_height)) {
    for (const Series& series : panel.series) add(series);
    for (const Circle& circle : panel.circles) {
      for (int i = 0; i < 360; ++i)
        see(part(circle.x + circle.radius * std::cos(i), circle.y + circle.radius * std::sin(i)));
    }
  }
  double width() const { return x_.high - x_.low; }
  double height() const { return y_.high - y_.low; }

 private:
  using Point = std::array<double, 2>;

  static double along(const Scale& scale, const AxisRange& range, double value) {
    const auto at = [&](double v) { return scale.log ? std::log(v) : v; };
    return (at(value) - at(range.low)) / (at(range.high) - at(range.low));
  }
  Point part(double x, double y) const { return {along(panel_.x, frame_.first, x), along(panel_.y, frame_.second, y)}; }
  void see(const Point& at) {
    constexpr double rounding = 1e-9;
    const auto inside = [](double v) { return v >= -rounding && v <= 1.0 + rounding; };
    if (inside(at[0]) && inside(at[1])) x_.add(at[0]), y_.add(at[1]);
  }
  /// Lines that leave the panel are seen as far as they are inside it.
  void add(const Series& series) {
    const bool from_axis = series.mark == Mark::impulses || series.mark == Mark::bars;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const Point here = part(series.x[i], series.y[i]);
      see(here);
      if (from_axis) see(part(series.x[i], 0.0));
      if (i == 0 || from_axis || series.mark == Mark::points) continue;
      const Point before = part(series.x[i - 1], series.y[i - 1]);
      constexpr int pieces = 100;
      for (int k = 1; k < pieces; ++k) {
        const double t = static_cast<double>(k) / pieces;
        see({before[0] + t * (here[0] - before[0]), before[1] + t * (here[1] - before[1])});
      }
    }
  }

  const Panel& panel_;
  std::pair<AxisRange, AxisRange> frame_;
  AxisRange x_, y_;
};

std::vector<std::filesystem::path> shipped_tasks() {
  std::vector<std::filesystem::path> found;
  for (const char* folder : {"corner", "machine", "settings", "paper"}) {
    const auto root = std::filesystem::path(test_support::source_folder()) / "problems" / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root))
      if (entry.path().extension() == ".toml") found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

TEST(PanelUse, NoPanelOfAShippedTaskHasAnEmptyHalf) {
  int figures = 0;
  for (const std::filesystem::path& path : shipped_tasks()) {
    const Task task = read_task(path.string(), {.response = Considered::all});
    if (task.corners.empty()) continue;
    const DesignResult result = design_task(task);
    if (!result.filter) continue;
    for (const TaskCorner& corner : task.corners) {
      const Figure figure = plot_result(result, corner.name);
      const PageLayout page = layout(figure);
      ++figures;
      for (std::size_t i = 0; i < figure.panels.size(); ++i) {
        const Use use(figure.panels[i], page.panels[i]);
        EXPECT_GT(use.width(), 0.5) << path << ": " << figure.panels[i].title;
        EXPECT_GT(use.height(), 0.5) << path << ": " << figure.panels[i].title;
      }
    }
  }
  EXPECT_GE(figures, 30);
}

TEST(PanelUse, AFlatPathIsStretchedAndSaysHowMuch) {
  // 175 degrees: 200 um of tolerance lie beside legs of more than a millimetre.
  const Task task = read_task(test_support::source_folder() + "/problems/corner/flat-angle.toml");
  const Figure figure = plot_result(design_task(task));
  const Panel& path = figure.panels[0];
  EXPECT_GT(path.stretch, 1.0);
  EXPECT_EQ(path.y.label, fmt::format("y / µm, drawn {:g} times as long", path.stretch));
  const PanelLayout place = layout(figure).panels[0];
  const auto [x, y] = panel_frame(path, place.plot_width, place.plot_height);
  const double across = place.plot_width / (x.high - x.low), up = place.plot_height / (y.high - y.low);  // px a unit
  EXPECT_NEAR(up / across, path.stretch, 1e-9);
}

TEST(PanelUse, NamesOfLimitsStandOnTheirLinesAndBesideEachOther) {
  Panel panel;
  panel.y.min = 0.0, panel.y.max = 100.0;
  panel.limits = {{80.0, "", "far"}, {50.0, "", "low"}, {52.0, "", "near"}, {30.0, "limit", ""}};
  const std::vector<LegendPlace> names = limit_name_places(panel, 500.0, 0.0, 200.0);  // 2 px a unit
  ASSERT_EQ(names.size(), 3U);
  EXPECT_EQ(names[0].label, "low");
  EXPECT_LT(names[0].y, 100.0) << "above its line";
  EXPECT_GT(names[0].y, 88.0);
  EXPECT_EQ(names[1].label, "near");
  EXPECT_DOUBLE_EQ(names[0].y - names[1].y, 4.0);
  EXPECT_LE(names[1].x + text_width("low"), names[0].x);
  EXPECT_EQ(names[2].label, "far");
  EXPECT_DOUBLE_EQ(names[2].x, names[0].x);
}

}  // namespace
}  // namespace accdec
