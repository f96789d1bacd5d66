#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <accdec/plot/path_follower.hpp>
#include <accdec/plot/program_drawing.hpp>

namespace accdec {
namespace {

using Point = std::array<double, 2>;

constexpr double seen = 1.5;  ///< px, shorter moves are put together
constexpr std::size_t strokes_max = 20000, squares_max = 5000;
constexpr double cell_pixels = 3.0;
constexpr int speeds = 20;  ///< colours

/// Rows of cells that strokes pass, each with its lowest value.
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

/// Puts moves together that follow one another until they can be seen. One that can be seen by itself stands alone:
/// behind a short slow move it would take its speed.
class StrokeMaker {
 public:
  explicit StrokeMaker(const ProgramView& view) : view_(view) {}
  void add(const Point& from, const Point& to, double speed, bool rapid) {
    if (!view_.shows(from, to)) {
      open_ = false;
      return;
    }
    const bool alone = std::hypot(to[0] - from[0], to[1] - from[1]) >= seen * view_.pixel;
    if (!open_ || alone || strokes.back().rapid != rapid) strokes.push_back({from, from, INFINITY, rapid});
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

}  // namespace

std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramView& view) {
  StrokeMaker maker(view);
  for (std::size_t b = 0; b < path.blocks(); ++b)
    maker.add(view.at(path.point(b)), view.at(path.point(b + 1)), block_feed(path, b), path.rapid[b] != 0);
  return maker.strokes;
}

std::vector<Stroke> strokes_of(const Toolpath& path, const ProgramMotion& motion, const ProgramView& view) {
  StrokeMaker maker(view);
  PathFollower follower(path);
  Point before{};
  motion.samples([&](std::int64_t k, const double* position, const double* velocity) {
    const Point now = view.at(position);
    follower.follow(position, velocity);
    const double speed = speed_of(velocity, path.dimensions());
    if (k > 0) maker.add(before, now, speed, path.rapid[follower.block()] != 0);
    before = now;
  });
  return maker.strokes;
}

double stroke_width(const std::vector<Stroke>& strokes, const ProgramView& view) {
  double length = 0.0;
  for (const Stroke& s : strokes) length += std::hypot(s.to[0] - s.from[0], s.to[1] - s.from[1]) / view.pixel;
  const double share = 0.35;  // of the plot's pixels at most that may be inked
  return length > 0.0 ? std::clamp(share * view_width * view.height / length, 0.6, 2.2) : 2.2;
}

Series stroke_series(const std::vector<Stroke>& strokes, const ProgramView& view, bool rapid) {
  // Thin black, or thin dashed.
  Series series{"", {}, {}, Mark::line, rapid ? 17 : 16};
  const auto add = [&](double x, double y) {
    series.x.push_back(view.drawn(0, x));
    series.y.push_back(view.drawn(1, y));
  };
  const auto line = [&](const Point& p, const Point& q) {
    const bool goes_on =
        !series.x.empty() && series.x.back() == view.drawn(0, p[0]) && series.y.back() == view.drawn(1, p[1]);
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
  lines.label = "speed / mm/s";
  lines.high = 0.0;
  for (const Stroke& s : strokes) {
    if (!s.rapid) lines.high = std::max(lines.high, 1e3 * s.speed);
  }
  if (lines.high == 0.0) lines.high = 1.0;
  const double step = lines.high / speeds;
  const auto add = [&](const Point& p, const Point& q, double value) {
    const double x = view.drawn(0, p[0]), y = view.drawn(1, p[1]);
    const bool goes_on = !lines.pieces.empty() && lines.pieces.back().value == value &&
                         lines.pieces.back().x.back() == x && lines.pieces.back().y.back() == y;
    if (!goes_on) lines.pieces.push_back({{x}, {y}, value});
    lines.pieces.back().x.push_back(view.drawn(0, q[0]));
    lines.pieces.back().y.push_back(view.drawn(1, q[1]));
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
    const double y = view.drawn(1, p.place[1]);
    pieces.push_back({{view.drawn(0, p.place[0] - half), view.drawn(0, p.place[0] + half)}, {y, y}, p.value});
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return pieces;
}

}  // namespace accdec
