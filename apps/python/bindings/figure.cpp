#include <string>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/plot_result.hpp>

#include "bindings.hpp"

namespace accdec::python {
namespace {

const char* name_of(Mark mark) {
  switch (mark) {
    case Mark::line: return "line";
    case Mark::points: return "points";
    case Mark::line_points: return "line_points";
    case Mark::steps: return "steps";
    case Mark::impulses: return "impulses";
    case Mark::bars: return "bars";
    case Mark::marked_line: return "marked_line";
  }
  return "line";
}

py::array_t<double> array(const std::vector<double>& v) {
  return py::array_t<double>(static_cast<py::ssize_t>(v.size()), v.data());
}

py::dict scale(const Scale& s) {
  return py::dict(py::arg("label") = s.label, py::arg("log") = s.log, py::arg("min") = s.min, py::arg("max") = s.max);
}

py::dict series(const Series& s) {
  return py::dict(py::arg("label") = s.label, py::arg("x") = array(s.x), py::arg("y") = array(s.y),
                  py::arg("mark") = name_of(s.mark), py::arg("style") = s.style, py::arg("solid") = s.solid);
}

py::object heat_map(const Panel& panel) {
  if (!panel.heat_map) return py::none();
  const HeatMap& m = *panel.heat_map;
  return py::dict(py::arg("x") = array(m.x), py::arg("y") = array(m.y), py::arg("values") = array(m.values),
                  py::arg("label") = m.label);
}

py::object coloured(const Panel& panel) {
  if (!panel.coloured) return py::none();
  const ColouredLines& c = *panel.coloured;
  const py::list pieces =
      list_of(c.pieces, [](const ColouredLines::Piece& p) { return py::make_tuple(array(p.x), array(p.y), p.value); });
  return py::dict(py::arg("pieces") = pieces, py::arg("low") = c.low, py::arg("high") = c.high,
                  py::arg("line_width") = c.line_width, py::arg("label") = c.label);
}

py::dict panel_dict(const Panel& p) {
  return py::dict(
      py::arg("title") = p.title, py::arg("x") = scale(p.x), py::arg("y") = scale(p.y),
      py::arg("series") = list_of(p.series, series),
      py::arg("limits") = list_of(p.limits, [](const LimitLine& l) { return py::make_tuple(l.y, l.label); }),
      py::arg("bands") = list_of(p.bands, [](const Band& b) { return py::make_tuple(b.from, b.to, b.label); }),
      py::arg("circles") =
          list_of(p.circles, [](const Circle& c) { return py::make_tuple(c.x, c.y, c.radius, c.label); }),
      py::arg("heat_map") = heat_map(p), py::arg("coloured") = coloured(p), py::arg("equal_aspect") = p.equal_aspect,
      py::arg("has_data") = has_data(p));
}

py::dict style() {
  namespace s = figure_style;
  return py::dict(py::arg("colours") = s::colours, py::arg("dashes") = s::dashes, py::arg("points") = s::points,
                  py::arg("widths") = s::widths, py::arg("limit") = s::limit_colour,
                  py::arg("circle") = s::circle_colour, py::arg("band") = s::band_colour,
                  py::arg("heat") = s::heat_palette, py::arg("signed") = s::signed_palette,
                  py::arg("lines") = s::line_palette);
}

}  // namespace

py::dict figure_dict(const Figure& f) {
  return py::dict(py::arg("title") = f.title, py::arg("panels") = list_of(f.panels, panel_dict),
                  py::arg("columns") = f.columns, py::arg("panel_width") = f.panel_width,
                  py::arg("panel_height") = f.panel_height);
}

void bind_figure(py::module_& module) {
  module.def(
      "result_figure",
      [](const std::shared_ptr<DesignResult>& result, const std::string& corner) {
        return figure_dict(plot_result(*result, corner));
      },
      py::arg("result"), py::arg("corner"));
  module.def("figure_style", &style);
}

}  // namespace accdec::python
