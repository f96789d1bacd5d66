#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <accdec/plot/program_view.hpp>

namespace accdec {
namespace {

using Point = std::array<double, 2>;

// Size of the plot on its page; slightly less than its real size, for the margin around the path.
constexpr double highest_plot = 390.0, lowest_plot = 160.0;
constexpr double least_extent = 1e-9;  ///< m a pixel
constexpr std::size_t nowhere = program_axis_count;

/// How far moves go along each of the path's columns in all, m.
std::vector<double> ways(const Toolpath& path, bool feeds_only) {
  std::vector<double> way(path.dimensions(), 0.0);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (feeds_only && path.rapid[b] != 0) continue;
    for (std::size_t a = 0; a < way.size(); ++a) way[a] += std::abs(path.point(b + 1)[a] - path.point(b)[a]);
  }
  return way;
}

std::size_t column_of(const Toolpath& path, std::size_t axis) {
  const auto found = std::find(path.axes.begin(), path.axes.end(), axis);
  return found == path.axes.end() ? nowhere : static_cast<std::size_t>(found - path.axes.begin());
}

/// The program axes of a plane, in the order of the alphabet.
std::pair<std::size_t, std::size_t> axes_of(Plane plane) {
  return plane == Plane::xy ? std::pair{0, 1} : plane == Plane::zx ? std::pair{0, 2} : std::pair{1, 2};
}

/// The only column of all feed moves, where it stands upright on the plane in force or is the only one that moves.
std::optional<std::size_t> drilled_column(const Toolpath& path, const std::vector<double>& feeds) {
  const auto moved = [](double way) { return way > 0.0; };
  if (std::count_if(feeds.begin(), feeds.end(), moved) != 1) return std::nullopt;
  const auto column = static_cast<std::size_t>(std::find_if(feeds.begin(), feeds.end(), moved) - feeds.begin());
  const auto [p, q] = axes_of(path.plane);
  const bool upright = path.axes[column] == 3 - p - q;
  return upright || path.dimensions() == 1 ? std::optional(column) : std::nullopt;
}

/// The two program axes that are shown of a path by itself.
std::pair<std::size_t, std::size_t> automatic_axes(const Toolpath& path, const std::vector<double>& feeds) {
  const auto [p, q] = axes_of(path.plane);
  const std::size_t first = column_of(path, p), second = column_of(path, q);
  const bool both = first != nowhere && second != nowhere;
  if (both && (drilled_column(path, feeds) || (feeds[first] > 0.0 && feeds[second] > 0.0))) return {p, q};
  const std::vector<double> all = ways(path, false);
  std::vector<std::size_t> order(path.dimensions());
  for (std::size_t a = 0; a < order.size(); ++a) order[a] = a;
  const auto key = [&, p = p, q = q](std::size_t a) {
    const bool in_plane = path.axes[a] == p || path.axes[a] == q;
    return std::tuple(!rotary_axis(path.axes[a]), feeds[a], in_plane, all[a]);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) > key(b); });
  if (order.size() == 1) return {path.axes[order[0]], nowhere};
  return std::minmax(path.axes[order[0]], path.axes[order[1]]);
}

void fit(ProgramView& view) {
  const double width = view.high[0] - view.low[0], height = view.high[1] - view.low[1];
  view.height = width > 0.0 ? std::clamp(view_width * height / width, lowest_plot, highest_plot) : highest_plot;
  view.pixel = std::max({width / view_width, height / view.height, least_extent});
}

void show_axis(ProgramView& view, std::size_t row, const Toolpath& path, std::size_t axis) {
  if (axis == nowhere) return;
  view.names[row] = std::string(1, static_cast<char>(program_axes[axis] | 0x20));
  view.rotary[row] = rotary_axis(axis);
  if (const std::size_t column = column_of(path, axis); column != nowhere) view.rows[row][column] = 1.0;
}

void show_isometric(ProgramView& view, const Toolpath& path) {
  view.names = {"isometric", "isometric"};
  const double cos30 = std::sqrt(0.75);
  const std::array<Point, 3> drawn{{{cos30, -0.5}, {cos30, 0.5}, {0.0, 1.0}}};
  for (std::size_t axis = 0; axis < drawn.size(); ++axis) {
    const std::size_t column = column_of(path, axis);
    if (column == nowhere) continue;
    for (std::size_t row = 0; row < 2; ++row) view.rows[row][column] = drawn[axis][row];
  }
}

}  // namespace

ViewFrom view_from(const std::string& name) {
  constexpr std::array<std::pair<const char*, ViewFrom>, 5> views{{{"auto", ViewFrom::automatic},
                                                                   {"xy", ViewFrom::xy},
                                                                   {"xz", ViewFrom::xz},
                                                                   {"yz", ViewFrom::yz},
                                                                   {"iso", ViewFrom::iso}}};
  for (const auto& [known, from] : views) {
    if (name == known) return from;
  }
  throw std::invalid_argument("unknown view \"" + name + "\"; allowed: auto, xy, xz, yz, iso");
}

Point ProgramView::at(const double* point) const {
  Point place{};
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t a = 0; a < dimensions; ++a) {
      if (rows[row][a] != 0.0) place[row] += rows[row][a] * point[a];
    }
  }
  return place;
}

bool ProgramView::shows(const Point& p, const Point& q) const {
  for (std::size_t a = 0; a < 2; ++a) {
    const double air = 40.0 * pixel;  // more than any plot is larger than its window
    if (std::max(p[a], q[a]) < low[a] - air || std::min(p[a], q[a]) > high[a] + air) return false;
  }
  return true;
}

ProgramView whole_view(const Toolpath& path, ViewFrom from) {
  ProgramView view;
  view.dimensions = path.dimensions();
  std::vector<double> feeds = ways(path, true);
  if (std::count(feeds.begin(), feeds.end(), 0.0) == std::ssize(feeds)) feeds = ways(path, false);
  if (from == ViewFrom::iso) {
    show_isometric(view, path);
  } else {
    const auto [across, up] = from == ViewFrom::automatic ? automatic_axes(path, feeds)
                              : from == ViewFrom::xy      ? axes_of(Plane::xy)
                              : from == ViewFrom::xz      ? axes_of(Plane::zx)
                                                          : axes_of(Plane::yz);
    show_axis(view, 0, path, across);
    show_axis(view, 1, path, up);
  }
  if (from == ViewFrom::automatic) view.over_time = drilled_column(path, feeds);
  view.low = {INFINITY, INFINITY}, view.high = {-INFINITY, -INFINITY};
  for (std::size_t i = 0; i <= path.blocks(); ++i) {
    const Point place = view.at(path.point(i));
    for (std::size_t a = 0; a < 2; ++a) {
      view.low[a] = std::min(view.low[a], place[a]);
      view.high[a] = std::max(view.high[a], place[a]);
    }
  }
  fit(view);
  if (std::max({-view.low[0], view.high[0], -view.low[1], view.high[1]}) > 50.0)
    view.scale = 1.0;  // tics of six digits do not fit
  return view;
}

ProgramView stretched(ProgramView view) {
  constexpr double thin = 1.0 / 3.0, straight = 200.0;
  if (view.names[0] == view.names[1]) return view;
  const std::array<double, 2> room{view_width, view.height};
  for (std::size_t a = 0; a < 2; ++a) {
    const double pixels = (view.high[a] - view.low[a]) / view.pixel;
    if (!(pixels < thin * room[a]) || !(pixels * straight > room[a])) continue;
    for (const double factor : {2.0, 3.0, 4.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
      if (factor * pixels <= room[a]) view.stretch[a] = factor;
    }
    for (double& part : view.rows[a]) part *= view.stretch[a];
    view.low[a] *= view.stretch[a], view.high[a] *= view.stretch[a];
  }
  fit(view);
  return view;
}

ProgramView enlarged(const ProgramView& view, const std::vector<Point>& places) {
  constexpr int steps = 13;  // windows that overlap
  ProgramView window = view, best = view;
  std::size_t most = 0;
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const std::array<int, 2> step{i, j};
      for (std::size_t a = 0; a < 2; ++a) {
        const double extent = view.high[a] - view.low[a], part = view.stretch[a] > 1.0 ? 0.5 : 0.25;
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
  const std::array<double, 2> room{view_width * best.pixel, best.height * best.pixel};
  for (std::size_t a = 0; a < 2; ++a) {
    const double middle = 0.5 * (best.low[a] + best.high[a]);
    best.low[a] = middle - 0.5 * room[a], best.high[a] = middle + 0.5 * room[a];
  }
  return best;
}

}  // namespace accdec
