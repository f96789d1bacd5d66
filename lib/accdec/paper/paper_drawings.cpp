#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_drawings.hpp>

namespace accdec::paper {

Panel panel_of(const FigureData& data, const std::string& title, const std::string& x_column,
               const std::string& x_label, const std::string& y_label, const std::vector<Curve>& curves) {
  Panel panel;
  panel.title = title;
  panel.x.label = x_label;
  panel.y.label = y_label;
  for (const Curve& curve : curves) {
    panel.series.push_back(
        {curve.label, data[x_column], data[curve.column], Mark::line, static_cast<int>(panel.series.size())});
  }
  panel.x.min = *std::min_element(data[x_column].begin(), data[x_column].end());
  panel.x.max = *std::max_element(data[x_column].begin(), data[x_column].end());
  return panel;
}

Drawing make_drawing(const std::string& name, FigureData data, const std::string& title, std::vector<Panel> panels,
                     int columns) {
  Drawing drawing{name, {std::move(data)}, {}};
  drawing.figure.title = title;
  drawing.figure.panels = std::move(panels);
  drawing.figure.columns = columns;
  return drawing;
}

namespace {

const char* const time_label = "time from the corner command / ms";
const char* const speed_label = "velocity / mm/s";

std::vector<Panel> component_panels(const FigureData& data, const std::string& suffix, const std::string& note) {
  const auto name = [&](const char* base) { return base + suffix + "_mm_s"; };
  return {panel_of(data, "along a" + note, "t_ms", time_label, speed_label,
                   {{name("va"), "sum"}, {name("v1a"), "leg 1"}, {name("v2a"), "leg 2"}}),
          panel_of(data, "along b" + note, "t_ms", time_label, speed_label,
                   {{name("vb"), "sum"}, {name("v1b"), "leg 1"}, {name("v2b"), "leg 2"}})};
}

Drawing draw9() {
  FigureData data = figure9();
  std::vector<Curve> curves;
  for (const char* c : {"10", "5", "3", "2", "1.5", "1"})
    curves.push_back({fmt::format("error_c{}_um", c), fmt::format("c = {}", c)});
  Panel panel = panel_of(data, "", "dT_ms", "command delay dT / ms", "corner error / BLU (1 BLU = 1 µm)", curves);
  panel.y.min = 0.0;
  Drawing drawing = make_drawing("fig09", std::move(data),
                                 "Fig. 9: corner error of linear Acc/Dec, v₁ = 4·10⁵ BLU/s, θ = 95°", {panel}, 1);
  drawing.figure.panel_height = 380;
  return drawing;
}

Drawing draw11() {
  FigureData data = figure11();
  HeatMap map;
  map.label = "E / ms";
  map.values = data["E_ms"];
  for (std::size_t i = 0; i < data["c"].size(); ++i) {
    if (i == 0 || data["c"][i] != data["c"][i - 1]) map.y.push_back(data["c"][i]);
    if (data["c"][i] == data["c"][0]) map.x.push_back(data["dT_samples"][i]);
  }
  Panel surface;
  surface.title = "over delay and speed factor";
  surface.x.label = "delay dT / T";
  surface.y.label = "speed factor c = v₂/v₁";
  surface.heat_map = map;
  Panel curves;
  curves.title = "over delay";
  curves.x.label = "delay dT / T";
  curves.y.label = "E = ε/v₁ / ms";
  curves.y.min = 0.0;
  int style = 0;
  for (const double c : {5.0, 3.0, 2.0, 1.0}) {
    Series series{fmt::format("c = {:g}", c), {}, {}, Mark::line, style++};
    for (std::size_t i = 0; i < data["c"].size(); ++i) {
      if (data["c"][i] != c) continue;
      series.x.push_back(data["dT_samples"][i]);
      series.y.push_back(data["E_ms"][i]);
    }
    curves.series.push_back(series);
  }
  Drawing drawing =
      make_drawing("fig11", std::move(data), "Fig. 11: normalised corner error of FIR Acc/Dec, N = 40, θ = 95°",
                   {surface, curves}, 2);
  drawing.figure.panel_width = 520;
  drawing.figure.panel_height = 360;
  return drawing;
}

Drawing draw12() {
  FigureData paths = figure12_paths(), errors = figure12_errors();
  const std::string quintic = shape_title(Shape::s_curve);
  Panel path;
  path.title = "paths in the a-b frame; corner at (0, 0)";
  path.x.label = "a / mm";
  path.y.label = "b / mm";
  const std::vector<Curve> curves{{"linear_d0", "1 linear"},
                                  {"scurve_d0", "2 " + quintic},
                                  {"fir_d0", "3 Blackman FIR"},
                                  {"linear_d12", "4 linear, dT = 12 T"},
                                  {"scurve_d4", "5 " + quintic + ", dT = 4 T"}};
  const double reach = 1.3, slope = std::cos(0.5 * angle) / std::sin(0.5 * angle);
  for (const Curve& curve : curves) {
    path.series.push_back({curve.label, paths[curve.column + "_a_mm"], paths[curve.column + "_b_mm"], Mark::line,
                           static_cast<int>(path.series.size())});
  }
  path.series.push_back(
      {"programmed corner", {-reach, 0.0, reach}, {reach * slope, 0.0, reach * slope}, Mark::line, 5});
  path.circles.push_back({0.0, 0.0, figure12_error(Processor::fir, 0) * 1e3, "error of the FIR"});
  path.x.min = -0.95, path.x.max = 0.95, path.y.min = -0.45, path.y.max = 1.25;
  path.equal_aspect = true;
  Panel error =
      panel_of(errors, "error at samples over the delay", "delay_samples", "delay dT / T", "corner error / µm",
               {{"linear_um", "linear"}, {"scurve_um", quintic}, {"fir_um", "Blackman FIR"}});
  error.limits.push_back({figure12_error(Processor::fir, 0) * 1e6, "FIR without delay"});
  error.series.push_back({"linear: 12 T printed, 14 T needed",
                          {12.0, 14.0},
                          {figure12_error(Processor::linear, 12) * 1e6, figure12_error(Processor::linear, 14) * 1e6},
                          Mark::points,
                          1});
  error.series.push_back({quintic + ": 4 T", {4.0}, {figure12_error(Processor::s_curve, 4) * 1e6}, Mark::points, 2});
  error.x.max = 24.0, error.y.min = 0.0;
  Drawing drawing = make_drawing("fig12", std::move(paths),
                                 "Fig. 12: Acc/Dec processors at v₁ = 100 mm/s, c = 2, θ = 95°", {path, error}, 1);
  drawing.data.push_back(std::move(errors));
  drawing.figure.panel_width = 760;
  drawing.figure.panel_height = 420;
  return drawing;
}

}  // namespace

std::vector<Drawing> drawings() {
  std::vector<Drawing> all = opening_drawings();
  FigureData d5 = figure5(), d6 = figure6(), d7 = figure7(), d8 = figure8(), d10 = figure10();
  const std::string feed = "v₁ = v₂ = 4·10⁵ BLU/s, θ = 95°";
  Panel p5 = panel_of(d5, "", "t_ms", time_label, speed_label, {{"va_mm_s", "v_a"}, {"vb_mm_s", "v_b"}});
  all.push_back(make_drawing("fig05", std::move(d5), "Fig. 5: blend in the a-b frame, " + feed, {p5}, 1));
  const auto speeds = [&](const char* title, const char* d) {
    const auto name = [&](const char* base) { return fmt::format("{}_d{}_mm_s", base, d); };
    Panel panel = panel_of(d6, title, "t_ms", time_label, "speed / mm/s",
                           {{name("v"), "along the path"}, {name("v1"), "leg 1"}, {name("v2"), "leg 2"}});
    panel.y.min = 0.0;
    return panel;
  };
  const std::vector<Panel> p6{speeds("(a) no delay", "0"), speeds("(b) delay dT = 10 T", "10")};
  all.push_back(make_drawing("fig06", std::move(d6), "Fig. 6: speed after linear Acc/Dec, " + feed, p6, 1));
  std::vector<Panel> p7 = component_panels(d7, "", ""), p8 = component_panels(d8, "", "");
  all.push_back(make_drawing("fig07", std::move(d7), "Fig. 7: components, linear Acc/Dec, " + feed, p7, 1));
  all.push_back(make_drawing("fig08", std::move(d8), "Fig. 8: components, linear, dT = 10 T, " + feed, p8, 1));
  all.push_back(draw9());
  std::vector<Panel> p10 = component_panels(d10, "_d0", ", no delay");
  const std::vector<Panel> delayed = component_panels(d10, "_d10", ", dT = 10 T");
  p10.insert(p10.begin() + 1, delayed[0]);
  p10.push_back(delayed[1]);
  all.push_back(make_drawing("fig10", std::move(d10), "Fig. 10: components, FIR Acc/Dec, " + feed, p10, 2));
  all.push_back(draw11());
  all.push_back(draw12());
  return all;
}

std::string to_csv(const FigureData& data) {
  std::string text;
  for (const Column& column : data.columns) text += fmt::format("{}{}", text.empty() ? "" : ",", column.name);
  text += '\n';
  for (std::size_t row = 0; row < data.columns.front().values.size(); ++row) {
    for (std::size_t i = 0; i < data.columns.size(); ++i) {
      std::string cell = fmt::format("{:.6f}", data.columns[i].values[row]);
      if (cell.find('.') != std::string::npos) {
        cell.erase(cell.find_last_not_of('0') + 1);
        if (cell.back() == '.') cell.pop_back();
      }
      text += fmt::format("{}{}", i == 0 ? "" : ",", cell == "-0" ? "0" : cell);
    }
    text += '\n';
  }
  return text;
}

}  // namespace accdec::paper
