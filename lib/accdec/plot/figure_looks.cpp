#include <algorithm>

#include <fmt/format.h>

#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/figure_looks.hpp>

namespace accdec {

using namespace figure_style;

std::size_t style_index(int style) {
  return static_cast<std::size_t>(std::max(style, 0));
}

const char* colour_of(const Series& s) {
  return colours[style_index(s.style) % colours.size()];
}
int symbol_of(const Series& s) {
  return points[style_index(s.style) % points.size()];
}

std::string line_of(const Series& s) {
  const std::size_t i = style_index(s.style);
  return fmt::format("lc rgb '{}' lw {} dt {}", colour_of(s), widths[i / dashes.size() % widths.size()],
                     dashes[(s.solid ? style_index(s.dash) : i) % dashes.size()]);
}

std::string limit_line() {
  return fmt::format("lc rgb '{}' lw 1.3 dt (7,5)", limit_colour);
}
std::string circle_line() {
  return fmt::format("lc rgb '{}' lw 1.3 dt (4,3)", circle_colour);
}
std::string band_line(const char* colour) {
  return fmt::format("lc rgb '{}' lw 9 dt solid", colour);
}

LegendSample sample_of(const Figure& figure, const std::string& label) {
  const auto named = [&](const auto& item) { return legend_label(item.label) == label; };
  for (const Panel& panel : figure.panels) {
    if (const auto s = std::ranges::find_if(panel.series, named); s != panel.series.end()) {
      const std::string point = fmt::format("lc rgb '{}' pt {} ps 0.6", colour_of(*s), symbol_of(*s));
      switch (s->mark) {
        case Mark::points: return {"", point};
        case Mark::line_points:
        case Mark::marked_line: return {line_of(*s), point};
        case Mark::bars: return {band_line(colour_of(*s)), ""};
        case Mark::impulses: return {fmt::format("lc rgb '{}' lw 1.5 dt solid", colour_of(*s)), ""};
        default: return {line_of(*s), ""};
      }
    }
    if (std::ranges::any_of(panel.limits, named)) return {limit_line(), ""};
    if (const auto c = std::ranges::find_if(panel.circles, named); c != panel.circles.end())
      return {c->disc ? band_line(disc_colour) : circle_line(), ""};
    if (std::ranges::any_of(panel.bands, named)) return {band_line(), ""};
  }
  return {};
}

}  // namespace accdec
