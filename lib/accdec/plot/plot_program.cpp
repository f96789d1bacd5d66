#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <accdec/plot/plot_program.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

constexpr int page_width = 860, page_height = 500;
// What the frame leaves for the path, px; a little less than it is, for the air around the path.
constexpr double plot_width = 640.0, plot_height = 390.0;
constexpr std::size_t points_max = 20000;
constexpr double cell_pixels = 3.0;
constexpr int colours = 20;

bool rotary(std::size_t axis) {
  return axis >= 3 && axis < 6;
}

/// The projection: the two axes of the largest extent, linear ones first.
struct View {
  std::size_t across = 0, up = 0;
  double low[2] = {0.0, 0.0}, high[2] = {0.0, 0.0};
  double pixel = 1.0;  ///< m
  double scale = 1e3;  ///< of the drawing: mm, or m for a path that long
};

View view_of(const Toolpath& path) {
  const std::size_t n = path.dimensions();
  std::vector<double> low(n, INFINITY), high(n, -INFINITY);
  for (std::size_t i = 0; i <= path.blocks(); ++i) {
    for (std::size_t a = 0; a < n; ++a) {
      low[a] = std::min(low[a], path.point(i)[a]);
      high[a] = std::max(high[a], path.point(i)[a]);
    }
  }
  std::vector<std::size_t> order(n);
  for (std::size_t a = 0; a < n; ++a) order[a] = a;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (rotary(path.axes[a]) != rotary(path.axes[b])) return !rotary(path.axes[a]);
    return high[a] - low[a] > high[b] - low[b];
  });
  View view;
  view.across = n > 1 ? std::min(order[0], order[1]) : order[0];
  view.up = n > 1 ? std::max(order[0], order[1]) : order[0];
  view.low[0] = low[view.across], view.high[0] = high[view.across];
  view.low[1] = n > 1 ? low[view.up] : 0.0, view.high[1] = n > 1 ? high[view.up] : 0.0;
  view.pixel = std::max({(view.high[0] - view.low[0]) / plot_width, (view.high[1] - view.low[1]) / plot_height, 1e-9});
  if (std::max({-view.low[0], view.high[0], -view.low[1], view.high[1]}) > 50.0)
    view.scale = 1.0;  // tics of six digits do not fit
  return view;
}

/// Error over tolerance of a joint in steps of the colour bar; 0 where there is no tolerance.
int colour_of(const ProgramResult& result, std::size_t joint) {
  const Toolpath& path = result.path;
  if (joint + 1 >= path.blocks() || !(path.tolerance[joint] < unlimited)) return 0;
  const double error = result.plan.errors[joint] <= position_floor ? 0.0 : result.plan.errors[joint];
  const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[joint]);
  return static_cast<int>(std::lround(std::clamp(use, 0.0, 1.0) * colours));
}

using Point = std::array<double, 2>;
using Half = std::pair<Point, int>;  // where a half block ends, and its colour

/// The path as half blocks, those shorter than a pixel together merged; the first entry is the start.
std::vector<Half> halves_of(const ProgramResult& result, const View& view) {
  const Toolpath& path = result.path;
  const auto at = [&](std::size_t i) {
    return Point{path.point(i)[view.across], path.dimensions() > 1 ? path.point(i)[view.up] : 0.0};
  };
  std::vector<Half> halves{{at(0), 0}};
  int worst = 0;
  const auto offer = [&](const Point& to, int colour, bool last) {
    worst = std::max(worst, colour);
    const Point& from = halves.back().first;
    if (!last && std::hypot(to[0] - from[0], to[1] - from[1]) < 1.5 * view.pixel) return;
    halves.emplace_back(to, worst);
    worst = 0;
  };
  int before = 0;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const Point p = at(b), q = at(b + 1);
    const int after = colour_of(result, b);
    if (after != before) offer({0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])}, before, false);
    offer(q, after, b + 1 == path.blocks());
    before = after;
  }
  return halves;
}

/// Connected halves of one colour as one piece; light pieces first, so that dark ones are seen.
std::vector<ColouredLines::Piece> pieces_of(const std::vector<Half>& halves, double scale) {
  std::vector<ColouredLines::Piece> pieces;
  const auto add = [scale](ColouredLines::Piece& piece, const Point& p) {
    piece.x.push_back(p[0] * scale);
    piece.y.push_back(p[1] * scale);
  };
  for (std::size_t i = 1; i < halves.size(); ++i) {
    const double value = 100.0 * halves[i].second / colours;
    if (pieces.empty() || pieces.back().value != value) {
      pieces.emplace_back().value = value;
      add(pieces.back(), halves[i - 1].first);
    }
    add(pieces.back(), halves[i].first);
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return pieces;
}

/// The same as rows of cells, neighbours of one colour together.
std::vector<ColouredLines::Piece> raster_of(const std::vector<Half>& halves, const View& view) {
  const double cell = cell_pixels * view.pixel;
  const auto columns = static_cast<std::size_t>((view.high[0] - view.low[0]) / cell) + 1;
  const auto rows = static_cast<std::size_t>((view.high[1] - view.low[1]) / cell) + 1;
  std::vector<int> cells(columns * rows, -1);
  const auto mark = [&](double x, double y, int colour) {
    const auto i = std::min(static_cast<std::size_t>(std::max(0.0, (x - view.low[0]) / cell)), columns - 1);
    const auto j = std::min(static_cast<std::size_t>(std::max(0.0, (y - view.low[1]) / cell)), rows - 1);
    cells[j * columns + i] = std::max(cells[j * columns + i], colour);
  };
  for (std::size_t i = 1; i < halves.size(); ++i) {
    const Point &p = halves[i - 1].first, &q = halves[i].first;
    const int steps = 1 + static_cast<int>(std::hypot(q[0] - p[0], q[1] - p[1]) / (0.5 * cell));
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      mark(p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]), halves[i].second);
    }
  }
  std::vector<ColouredLines::Piece> pieces;
  for (std::size_t j = 0; j < rows; ++j) {
    const double y = (view.low[1] + (static_cast<double>(j) + 0.5) * cell) * view.scale;
    for (std::size_t i = 0; i < columns;) {
      std::size_t end = i + 1;
      const int colour = cells[j * columns + i];
      while (end < columns && cells[j * columns + end] == colour) ++end;
      const auto x = [&](std::size_t column) {
        return (view.low[0] + static_cast<double>(column) * cell) * view.scale;
      };
      if (colour >= 0) pieces.push_back({{x(i), x(end)}, {y, y}, 100.0 * colour / colours});
      i = end;
    }
  }
  return pieces;
}

Panel path_panel(const ProgramResult& result) {
  const View view = view_of(result.path);
  const std::vector<Half> halves = halves_of(result, view);
  Panel panel;
  panel.title = fmt::format("path, {} blocks", result.path.blocks());
  const auto label = [&](std::size_t dimension) {
    return fmt::format("{} / {}", result.path.axis_name(dimension),
                       rotary(result.path.axes[dimension]) ? (view.scale == 1.0 ? "1000 deg" : "deg")
                                                           : (view.scale == 1.0 ? "m" : "mm"));
  };
  panel.x.label = label(view.across);
  if (result.path.dimensions() > 1) panel.y.label = label(view.up);
  ColouredLines lines;
  const bool dense = halves.size() > points_max;
  lines.pieces = dense ? raster_of(halves, view) : pieces_of(halves, view.scale);
  lines.line_width = dense ? cell_pixels + 0.4 : halves.size() > 2000 ? 1.3 : 2.0;
  lines.high = 100.0;
  lines.label = "corner error / tolerance, %";
  panel.coloured = std::move(lines);
  panel.equal_aspect = true;
  const double air = 8.0 * view.pixel;
  panel.x.min = (view.low[0] - air) * view.scale, panel.x.max = (view.high[0] + air) * view.scale;
  panel.y.min = (view.low[1] - air) * view.scale, panel.y.max = (view.high[1] + air) * view.scale;
  return panel;
}

Panel delay_panel(const ProgramResult& result) {
  const Toolpath& path = result.path;
  std::map<int, std::int64_t> counts;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int delay = result.plan.delays[b];
    if (path.joint[b] != Joint::straight || delay != 0) ++counts[delay];
  }
  Panel panel;
  panel.title = fmt::format("delays of {} corners, {:.6g} s of the {:.6g} s", result.corners, result.delay_total,
                            result.cycle_time);
  panel.x.label = fmt::format("delay / samples of {:.6g} ms", result.sample_period * 1e3);
  panel.y.label = "corners";
  const int first = counts.empty() ? 0 : counts.begin()->first, last = counts.empty() ? 1 : counts.rbegin()->first;
  const int width = (last - first) / 200 + 1;  // delays in a bar
  Series bars{"", {}, {}, Mark::bars, 1};
  double most = 1.0;
  for (int d = first; d <= last; d += width) {
    double sum = 0.0;
    for (auto it = counts.lower_bound(d); it != counts.end() && it->first < d + width; ++it)
      sum += static_cast<double>(it->second);
    bars.x.push_back(d + 0.5 * (width - 1));
    bars.y.push_back(sum);
    most = std::max(most, sum);
  }
  if (width > 1) panel.x.label += fmt::format(", {} in a bar", width);
  panel.x.min = first - 1.0, panel.x.max = last + 1.0;
  panel.y.log = most > 100.0;
  panel.y.min = panel.y.log ? 0.5 : 0.0;
  panel.y.max = most * (panel.y.log ? 1.6 : 1.06);
  panel.series.push_back(std::move(bars));
  return panel;
}

}  // namespace

Figure plot_program(const ProgramResult& result) {
  Figure figure;
  const std::string name = result.program.substr(result.program.find_last_of('/') + 1);
  figure.title = fmt::format("{}: {:.6g} s, {} taps{}", name, result.cycle_time, result.filter.order() + 1,
                             result.legs.single() ? "" : ", length by leg");
  figure.panel_width = page_width;
  figure.panel_height = page_height;
  figure.panels = {path_panel(result), delay_panel(result)};
  return figure;
}

}  // namespace accdec
