#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <accdec/plot/program_drawing.hpp>

namespace accdec {
namespace {

using Point = std::array<double, 2>;

// Of the plot on its page; a little less than it is, for the air around the path.
constexpr double plot_width = 640.0, highest_plot = 390.0, lowest_plot = 160.0;
constexpr double least_extent = 1e-9;  ///< m a pixel
constexpr double seen = 1.5;           ///< px, shorter moves are put together
constexpr std::size_t strokes_max = 20000, squares_max = 5000;
constexpr double cell_pixels = 3.0;
constexpr int speeds = 20;  ///< colours

bool is_rotary(std::size_t axis) {
  return axis >= 3 && axis < 6;
}

/// Rows of cells that strokes pass, by the value that counts where several do: the lowest.
class Cells {
 public:
  explicit Cells(const ProgramView& view)
      : view_(view), cell_(cell_pixels * view.pixel), columns_(count(0)), rows_(count(1)) {
    values_.assign(columns_ * rows_, NAN);
  }
  void mark(const Stroke& stroke, double value) {
    const double dx = stroke.to[0] - stroke.from[0], dy = stroke.to[1] - stroke.from[1];
    const int steps = 1 + static_cast<int>(std::hypot(dx, dy) / (0.5 * cell_));
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      double& cell = values_[index(stroke.from[1] + t * dy, 1) * columns_ + index(stroke.from[0] + t * dx, 0)];
      cell = std::isnan(cell) ? value : std::min(cell, value);
    }
  }
  /// Calls `run(x from, x to, y, value)`, m, for neighbours in a row that have one value.
  template <typename Run>
  void runs(Run run) const {
    for (std::size_t j = 0; j < rows_; ++j) {
      const double* row = values_.data() + j * columns_;
      for (std::size_t i = 0, end = 0; i < columns_; i = end) {
        end = i + 1;
        while (end < columns_ && row[end] == row[i]) ++end;
        if (!std::isnan(row[i])) run(edge(i, 0), edge(end, 0), edge(j, 1) + 0.5 * cell_, row[i]);
      }
    }
  }

 private:
  std::size_t count(std::size_t axis) const {
    return static_cast<std::size_t>((view_.high[axis] - view_.low[axis]) / cell_) + 1;
  }
  std::size_t index(double x, std::size_t axis) const {
    const double at = std::max(0.0, (x - view_.low[axis]) / cell_);
    return std::min(static_cast<std::size_t>(at), (axis == 0 ? columns_ : rows_) - 1);
  }
  double edge(std::size_t i, std::size_t axis) const { return view_.low[axis] + static_cast<double>(i) * cell_; }

  const ProgramView& view_;
  double cell_;
  std::size_t columns_, rows_;
  std::vector<double> values_;
};

/// Puts moves together that follow one another until they can be seen.
class StrokeMaker {
 public:
  explicit StrokeMaker(const ProgramView& view) : view_(view) {}
  void add(const Point& from, const Point& to, double speed, bool rapid) {
    if (!view_.shows(from, to)) {
      open_ = false;
      return;
    }
    if (!open_ || strokes.back().rapid != rapid) strokes.push_back({from, from, INFINITY, rapid});
    Stroke& stroke = strokes.back();
    stroke.to = to;
    stroke.speed = std::min(stroke.speed, speed);
    open_ = std::hypot(to[0] - stroke.from[0], to[1] - stroke.from[1]) < seen * view_.pixel;
  }
  std::vector<Stroke> strokes;

 private:
  const ProgramView& view_;
  bool open_ = false;
};

void fit(ProgramView& view) {
  const double width = view.high[0] - view.low[0], height = view.high[1] - view.low[1];
  view.height = width > 0.0 ? std::clamp(plot_width * height / width, lowest_plot, highest_plot) : highest_plot;
  view.pixel = std::max({width / plot_width, height / view.height, least_extent});
}

}  // namespace

Point ProgramView::at(const Toolpath& path, std::size_t point) const {
  return {path.point(point)[across], path.dimensions() > 1 ? path.point(point)[up] : 0.0};
}

bool ProgramView::shows(const Point& p, const Point& q) const {
  for (std::size_t a = 0; a < 2; ++a) {
    const double air = 40.0 * pixel;  // more than any plot is larger than its window
    if (std::max(p[a], q[a]) < low[a] - air || std::min(p[a], q[a]) > high[a] + air) return false;
  }
  return true;
}

ProgramView whole_view(const Toolpath& path) {
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
    if (is_rotary(path.axes[a]) != is_rotary(path.axes[b])) return !is_rotary(path.axes[a]);
    return high[a] - low[a] > high[b] - low[b];
  });
  ProgramView view;
  view.across = n > 1 ? std::min(order[0], order[1]) : order[0];
  view.up = n > 1 ? std::max(order[0], order[1]) : order[0];
  view.low = {low[view.across], n > 1 ? low[view.up] : 0.0};
  view.high = {high[view.across], n > 1 ? high[view.up] : 0.0};
  fit(view);
  if (std::max({-view.low[0], view.high[0], -view.low[1], view.high[1]}) > 50.0)
    view.scale = 1.0;  // tics of six digits do not fit
  return view;
}

ProgramView enlarged(const ProgramView& view, const std::vector<Point>& places) {
  constexpr double part = 0.25;
  constexpr int steps = 13;  // windows that overlap
  ProgramView window = view, best = view;
  std::size_t most = 0;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const std::array<int, 2> step{i, j};
      for (std::size_t a = 0; a < 2; ++a) {
        const double extent = view.high[a] - view.low[a];
        window.low[a] = view.low[a] + (1.0 - part) * extent * step[a] / (steps - 1);
        window.high[a] = window.low[a] + part * extent;
      }
      const auto inside = static_cast<std::size_t>(std::count_if(places.begin(), places.end(), [&](const Point& p) {
        return p[0] >= window.low[0] && p[0] <= window.high[0] && p[1] >= window.low[1] && p[1] <= window.high[1];
      }));
      if (inside > most) most = inside, best = window;
    }
  }
  fit(best);
  // As much as the plot has room for.
  const std::array<double, 2> room{plot_width * best.pixel, best.height * best.pixel};
  for (std::size_t a = 0; a < 2; ++a) {
    const double middle = 0.5 * (best.low[a] + best.high[a]);
    best.low[a] = middle - 0.5 * room[a], best.high[a] = middle + 0.5 * room[a];
  }
  return best;
}

std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramView& view) {
  StrokeMaker maker(view);
  for (std::size_t b = 0; b < path.blocks(); ++b)
    maker.add(view.at(path, b), view.at(path, b + 1), block_feed(path, b), path.rapid[b] != 0);
  return maker.strokes;
}

std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramMotion& motion, const ProgramView& view) {
  StrokeMaker maker(view);
  PathFollower follower(path);
  Point before{};
  visit_speeds(path, Machine{}, motion, [&](std::int64_t k, const double* position, double speed, int) {
    const Point now{position[view.across], path.dimensions() > 1 ? position[view.up] : 0.0};
    follower.follow(position);
    if (k > 0) maker.add(before, now, speed, path.rapid[follower.block()] != 0);
    before = now;
  });
  return maker.strokes;
}

double stroke_width(const std::vector<Stroke>& strokes, const ProgramView& view) {
  double length = 0.0;
  for (const Stroke& s : strokes) length += std::hypot(s.to[0] - s.from[0], s.to[1] - s.from[1]) / view.pixel;
  const double share = 0.35;  // of the plot's pixels at most that may be inked
  return length > 0.0 ? std::clamp(share * plot_width * view.height / length, 0.6, 2.2) : 2.2;
}

Series stroke_series(const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid) {
  // Thin black, or thin dashed.
  Series series{"", {}, {}, Mark::line, rapid ? 17 : 16};
  const auto add = [&](double x, double y) {
    series.x.push_back(x * view.scale);
    series.y.push_back(y * view.scale);
  };
  const auto line = [&](const Point& p, const Point& q) {
    const bool goes_on =
        !series.x.empty() && series.x.back() == p[0] * view.scale && series.y.back() == p[1] * view.scale;
    if (!goes_on && !series.x.empty()) add(NAN, NAN);
    if (!goes_on) add(p[0], p[1]);
    add(q[0], q[1]);
  };
  const bool dense = strokes.size() > strokes_max;
  Cells cells(view);
  for (const Stroke& s : strokes) {
    if (s.rapid == rapid) dense ? cells.mark(s, 0.0) : line(s.from, s.to);
  }
  if (dense) cells.runs([&](double from, double to, double y, double) { line({from, y}, {to, y}); });
  return series;
}

ColouredLines speed_lines(const std::vector<Stroke>& strokes, const ProgramView& view) {
  ColouredLines lines;
  lines.label = "speed / (mm/s)";
  lines.high = 0.0;
  for (const Stroke& s : strokes) {
    if (!s.rapid) lines.high = std::max(lines.high, 1e3 * s.speed);
  }
  if (lines.high == 0.0) lines.high = 1.0;
  const double step = lines.high / speeds;
  const auto add = [&](const Point& p, const Point& q, double value) {
    const double x = p[0] * view.scale, y = p[1] * view.scale;
    const bool goes_on = !lines.pieces.empty() && lines.pieces.back().value == value &&
                         lines.pieces.back().x.back() == x && lines.pieces.back().y.back() == y;
    if (!goes_on) lines.pieces.push_back({{x}, {y}, value});
    lines.pieces.back().x.push_back(q[0] * view.scale);
    lines.pieces.back().y.push_back(q[1] * view.scale);
  };
  const bool dense = strokes.size() > strokes_max;
  Cells cells(view);
  for (const Stroke& s : strokes) {
    const double value = step * std::lround(1e3 * s.speed / step);
    if (!s.rapid) dense ? cells.mark(s, value) : add(s.from, s.to, value);
  }
  if (dense) cells.runs([&](double from, double to, double y, double value) { add({from, y}, {to, y}, value); });
  lines.line_width = dense ? cell_pixels + 0.4 : stroke_width(strokes, view);
  std::stable_sort(lines.pieces.begin(), lines.pieces.end(),
                   [](const auto& a, const auto& b) { return a.value > b.value; });
  return lines;
}

std::vector<ColouredLines::Piece> squares(const std::vector<PlaceValue>& places, const ProgramView& view,
                                          double& line_width) {
  // Few are large, many small and set apart by cells.
  const bool dense = places.size() > squares_max;
  line_width = places.size() > 400 ? 4.0 : 6.0;
  const double cell = (dense ? 1.0 : 0.5) * line_width * view.pixel;
  std::map<std::pair<long, long>, PlaceValue> kept;
  for (const PlaceValue& p : places) {
    if (!view.shows(p.place, p.place)) continue;
    const auto [it, is_new] = kept.try_emplace({std::lround(p.place[0] / cell), std::lround(p.place[1] / cell)}, p);
    if (!is_new && p.value > it->second.value) it->second = p;
  }
  std::vector<ColouredLines::Piece> pieces;
  const double half = 0.5 * line_width * view.pixel;
  for (const auto& [where, p] : kept) {
    const double y = p.place[1] * view.scale;
    pieces.push_back({{(p.place[0] - half) * view.scale, (p.place[0] + half) * view.scale}, {y, y}, p.value});
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return pieces;
}

}  // namespace accdec
