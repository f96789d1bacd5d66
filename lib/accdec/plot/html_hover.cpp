#include <cmath>

#include <nlohmann/json.hpp>

#include <accdec/plot/figure_frame.hpp>
#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/html_parts.hpp>

namespace accdec {
namespace {

using nlohmann::json;

std::size_t points_of(const Figure& figure) {
  std::size_t count = 0;
  for (const Panel& panel : figure.panels) {
    for (const Series& s : panel.series) count += s.x.size();
    if (panel.heat_map) count += panel.heat_map->values.size();
    if (!panel.coloured) continue;
    for (const auto& piece : panel.coloured->pieces) count += piece.x.size();
  }
  return count;
}

json scale_json(const Scale& scale, const std::string& label, const AxisRange& range) {
  return {{"label", clean_title(label)}, {"log", scale.log}, {"from", range.low}, {"to", range.high}};
}

/// The quantity on the y axis: its label, or else the beginning of the title.
std::string quantity_of(const Panel& panel) {
  return panel.y.label.empty() ? panel.title.substr(0, panel.title.find_first_of(":,;")) : panel.y.label;
}

/// The part of the page's legend above each column of panels.
json legend_boxes(const PageLayout& page, int columns) {
  json boxes = json::array();
  if (page.legend.empty()) return boxes;
  const double wide = page.width / columns, top = page.legend.front().y - 0.5 * legend_row;
  for (int i = 0; i < columns; ++i)
    boxes.push_back({i * wide, top, wide, page.legend.back().y + 0.5 * legend_row - top});
  return boxes;
}

json panel_json(const Panel& panel, const PanelLayout& place) {
  const auto [x, y] = panel_frame(panel, place.plot_width, place.plot_height);
  json out = {{"left", place.plot_left},
              {"top", place.plot_top},
              {"width", place.plot_width},
              {"height", place.plot_height},
              {"x", scale_json(panel.x, panel.x.label, x)},
              {"y", scale_json(panel.y, quantity_of(panel), y)},
              {"series", json::array()}};
  for (const Series& s : panel.series)
    out["series"].push_back({{"label", clean_title(s.label)}, {"x", s.x}, {"y", s.y}});
  if (panel.coloured) {
    for (const auto& piece : panel.coloured->pieces)
      out["series"].push_back(
          {{"label", clean_title(panel.coloured->label)}, {"x", piece.x}, {"y", piece.y}, {"value", piece.value}});
  }
  if (panel.heat_map) {
    out["heat"] = {{"label", clean_title(panel.heat_map->label)},
                   {"x", panel.heat_map->x},
                   {"y", panel.heat_map->y},
                   {"values", panel.heat_map->values}};
  }
  return out;
}

}  // namespace

std::string hover_json(const Figure& figure) {
  const PageLayout page = layout(figure);
  json out = {
      {"title", clean_title(figure.title)}, {"panels", json::array()}, {"boxes", legend_boxes(page, figure.columns)}};
  const bool told = points_of(figure) <= most_hover_points;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const PanelLayout& place = page.panels[i];
    out["boxes"].push_back({place.x, place.y, place.width, place.height});
    if (told) out["panels"].push_back(panel_json(figure.panels[i], place));
  }
  const std::string text = out.dump(-1, ' ', false, json::error_handler_t::replace);
  std::string safe;  // nothing in it may end the script element
  for (const char c : text) c == '<' ? safe += "\\u003c" : safe += c;
  return safe;
}

}  // namespace accdec
