#include <algorithm>

#include <accdec/plot/figure_frame.hpp>
#include <accdec/plot/figure_layout.hpp>

namespace accdec {

void AxisRange::add(double x) {
  if (!std::isfinite(x)) return;
  low = std::min(low, x);
  high = std::max(high, x);
}

namespace {

/// Ranges of the data with a small margin, or as given.
std::pair<AxisRange, AxisRange> ranges(const Panel& panel) {
  AxisRange x, y;
  for (const Series& s : panel.series) {
    for (const double v : s.x) x.add(v);
    for (const double v : s.y) y.add(v);
  }
  for (const Circle& c : panel.circles) {
    x.add(c.x - c.radius), x.add(c.x + c.radius);
    y.add(c.y - c.radius), y.add(c.y + c.radius);
  }
  for (const LimitLine& limit : panel.limits) y.add(limit.y);
  if (panel.coloured) {
    for (const ColouredLines::Piece& piece : panel.coloured->pieces) {
      for (const double v : piece.x) x.add(v);
      for (const double v : piece.y) y.add(v);
    }
  }
  if (panel.heat_map) {
    for (const double edge : cell_edges(panel.heat_map->x, panel.x.log)) x.add(edge);
    for (const double edge : cell_edges(panel.heat_map->y, panel.y.log)) y.add(edge);
  }
  const auto finish = [&](AxisRange& range, const Scale& scale, double air) {
    if (scale.log) {  // decades: positive data only
      if (!(range.low > 0.0)) range.low = range.high > 0.0 ? range.high * 1e-6 : 1.0;
      if (!(range.high > range.low)) range.high = range.low * 10.0;
    } else {
      if (!(range.high >= range.low)) range = {0.0, 1.0};
      // Flat data: the range is as wide as the value, so that rounding is not magnified.
      const double size = std::max(std::abs(range.low), std::abs(range.high));
      double width = range.high - range.low;
      if (width <= 1e-9 * size || width == 0.0)
        width = size > 0.0 ? size : 1.0, range.low -= 0.5 * width, range.high += 0.5 * width;
      range.low -= air * width;
      range.high += air * width;
    }
    if (scale.min) range.low = *scale.min;
    if (scale.max) range.high = *scale.max;
  };
  finish(x, panel.x, 0.0);
  finish(y, panel.y, panel.heat_map ? 0.0 : panel.notes.empty() ? 0.06 : 0.12);
  return {x, y};
}

/// Widens one range so that a unit of y is as long as `stretch` units of x.
void equalise(AxisRange& x, AxisRange& y, double width, double height, double stretch) {
  const double unit = std::max((x.high - x.low) / width, stretch * (y.high - y.low) / height);
  const auto widen = [unit](AxisRange& range, double pixels) {
    const double centre = 0.5 * (range.low + range.high);
    range = {centre - 0.5 * unit * pixels, centre + 0.5 * unit * pixels};
  };
  widen(x, width);
  widen(y, height / stretch);
}

}  // namespace

std::pair<AxisRange, AxisRange> panel_frame(const Panel& panel, double width, double height) {
  auto [x, y] = ranges(panel);
  if (panel.equal_aspect) equalise(x, y, width, height, panel.stretch);
  return {x, y};
}

}  // namespace accdec
