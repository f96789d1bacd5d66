#include <cmath>
#include <numbers>

#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_drawings.hpp>

namespace accdec::paper {
namespace {

const char* const opening_time_label = "time / ms";
const char* const opening_speed_label = "velocity / mm/s";

Drawing draw1() {
  FigureData data = figure1();
  std::vector<Panel> panels{
      panel_of(data, "interpolator: the programmed feed", "t_ms", opening_time_label, opening_speed_label,
               {{"interpolator_mm_s", "command"}}),
      panel_of(data, "Acc/Dec processor, to the servo system", "t_ms", opening_time_label, opening_speed_label,
               {{"linear_mm_s", "linear, 41 taps"}, {"fir_mm_s", "Blackman FIR, 41 taps"}})};
  for (Panel& panel : panels) panel.y.min = 0.0, panel.y.max = 450.0;
  return make_drawing("fig01", std::move(data), "Fig. 1: the command between interpolator, Acc/Dec and servo",
                      std::move(panels), 1);
}

Drawing draw2() {
  FigureData data = figure2();
  std::vector<Panel> panels{panel_of(data, "velocity", "t_ms", opening_time_label, opening_speed_label,
                                     {{"before_mm_s", "before"}, {"after_mm_s", "after linear Acc/Dec"}}),
                            panel_of(data, "way from A", "t_ms", opening_time_label, "way / mm",
                                     {{"way_before_mm", "before"}, {"way_after_mm", "after linear Acc/Dec"}})};
  for (Panel& panel : panels) panel.y.min = 0.0;
  return make_drawing("fig02", std::move(data), "Fig. 2: a leg from A to B before and after linear Acc/Dec",
                      std::move(panels), 1);
}

Drawing draw3() {
  FigureData data = figure3();
  std::vector<Panel> panels;
  for (const char* axis : {"x", "y"}) {
    const std::string name = axis;
    panels.push_back(panel_of(data, "along " + name, "t_ms", "time from the corner command / ms", opening_speed_label,
                              {{name + "_before_mm_s", "before"}, {name + "_after_mm_s", "after linear Acc/Dec"}}));
  }
  return make_drawing("fig03", std::move(data), "Fig. 3: blended mode from A through B to C, θ = 95°",
                      std::move(panels), 1);
}

/// The path near the corner with the programmed legs and the circle of the corner error around the corner.
Panel path_panel(const FigureData& data, const std::string& title, const std::string& first, const std::string& second,
                 const Series& legs) {
  Panel panel = panel_of(data, title, first + "_mm", first + " / mm", second + " / mm", {{second + "_mm", "path"}});
  panel.series.push_back(legs);
  double nearest = INFINITY;
  for (std::size_t i = 0; i < data["k"].size(); ++i) {
    nearest = std::min(nearest, std::hypot(data[first + "_mm"][i], data[second + "_mm"][i]));
  }
  panel.circles.push_back({0.0, 0.0, nearest, "corner error ε"});
  panel.x.min.reset(), panel.x.max.reset();
  panel.equal_aspect = true;
  return panel;
}

Drawing draw4() {
  FigureData data = figure4();
  constexpr double reach = 9.0;  // mm
  const double in = std::numbers::pi / 3.0, out = in - (std::numbers::pi - angle), half = 0.5 * angle;
  const Series in_xy{"programmed legs",
                     {-reach * std::cos(in), 0.0, reach * std::cos(out)},
                     {-reach * std::sin(in), 0.0, reach * std::sin(out)},
                     Mark::line,
                     5};
  const Series in_ab{"programmed legs",
                     {-reach * std::sin(half), 0.0, reach * std::sin(half)},
                     {reach * std::cos(half), 0.0, reach * std::cos(half)},
                     Mark::line,
                     5};
  std::vector<Panel> panels{path_panel(data, "(a) corner error, x-y frame", "x", "y", in_xy),
                            path_panel(data, "(b) a-b frame: b halves the angle", "a", "b", in_ab)};
  Drawing drawing = make_drawing("fig04", std::move(data),
                                 "Fig. 4: the corner error is the smallest distance of the path from the corner",
                                 std::move(panels), 1);
  drawing.figure.panel_width = 640;
  drawing.figure.panel_height = 420;
  return drawing;
}

}  // namespace

std::vector<Drawing> opening_drawings() {
  return {draw1(), draw2(), draw3(), draw4()};
}

}  // namespace accdec::paper
