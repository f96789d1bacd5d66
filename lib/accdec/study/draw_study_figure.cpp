#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include <accdec/plot/figure_layout.hpp>
#include <accdec/study/column_titles.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_figure_completion.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

using Kind = StudyFigure::Kind;

std::vector<std::size_t> rows_of(const StudyFigure& figure, const StudyTable& table) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const bool counts = std::all_of(figure.where.begin(), figure.where.end(),
                                    [&](const auto& w) { return table.text(w.first, i) == w.second; });
    if (counts) rows.push_back(i);
  }
  return rows;
}

/// Largest numbers of values on an axis of a map and of points on a line. More would not be visible, and drawings would
/// grow to hundreds of megabytes.
constexpr std::size_t most_heat_values = 400, most_line_points = 8000;

/// Reduces points that are too many to see, in order of x. For a line it keeps the lowest and the highest of every
/// part, so that the picture is the same. For a cloud it keeps every k-th point, and the title says so.
void thin_out(Series& s, std::string& title) {
  const std::size_t count = s.x.size();
  if (count <= most_line_points) return;
  const bool cloud = s.mark == Mark::points;
  const std::size_t parts = cloud ? most_line_points : most_line_points / 2;
  std::vector<std::size_t> kept;
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t begin = p * count / parts, end = (p + 1) * count / parts;
    if (cloud) {
      kept.push_back(begin);
      continue;
    }
    const auto first = s.y.begin();
    const auto [low, high] =
        std::minmax_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end));
    const auto a = static_cast<std::size_t>(low - first), b = static_cast<std::size_t>(high - first);
    kept.insert(kept.end(), {std::min(a, b), std::max(a, b)});
  }
  if (cloud) title = fmt::format("{} of {} points", parts, count);
  for (std::size_t i = 0; i < kept.size(); ++i) s.x[i] = s.x[kept[i]], s.y[i] = s.y[kept[i]];  // kept[i] >= i
  s.x.resize(kept.size());
  s.y.resize(kept.size());
}

/// Points of a curve by rising x; rows without both numbers are left out.
Series sorted_series(std::vector<std::pair<double, double>> points, std::string label, int style) {
  std::erase_if(points, [](const auto& p) { return !std::isfinite(p.first) || !std::isfinite(p.second); });
  std::sort(points.begin(), points.end());
  Series s;
  s.label = std::move(label);
  s.style = style;
  s.mark = points.size() <= 40 ? Mark::line_points : Mark::line;
  for (const auto& [x, y] : points) {
    s.x.push_back(x);
    s.y.push_back(y);
  }
  return s;
}

std::string label_of(const StudyFigure& figure, std::size_t curve, const std::string& otherwise) {
  return curve < figure.labels.size() ? figure.labels[curve] : otherwise;
}

void add_curves(Panel& panel, const StudyFigure& figure, const StudyTable& table,
                const std::vector<std::size_t>& rows) {
  const std::vector<std::string> titles = curve_titles(figure.y);
  for (std::size_t c = 0; c < figure.y.size(); ++c) {
    std::vector<std::pair<double, double>> points;
    for (const std::size_t i : rows) points.emplace_back(table.numbers(figure.x)[i], table.numbers(figure.y[c])[i]);
    panel.series.push_back(sorted_series(std::move(points), label_of(figure, c, figure.y.size() > 1 ? titles[c] : ""),
                                         static_cast<int>(c)));
  }
}

/// Values of a family for the legend: six digits with the unit, more where six do not tell them apart.
std::vector<std::string> member_labels(const StudyFigure& figure, const std::vector<std::string>& members,
                                       const std::vector<double>& numbers) {
  const std::string& unit = figure.family_unit;
  std::vector<std::string> labels;
  for (const bool rounded : {true, false}) {
    labels.clear();
    for (std::size_t c = 0; c < members.size(); ++c) {
      std::string label = members[c];
      if (std::isfinite(numbers[c]))
        label = fmt::format("{}{}{}", rounded ? fmt::format("{:.6g}", numbers[c]) : fmt::format("{}", numbers[c]),
                            unit.empty() ? "" : " ", unit);
      labels.push_back(std::move(label));
    }
    if (std::set<std::string>(labels.begin(), labels.end()).size() == labels.size()) break;
  }
  return labels;
}

void add_family(Panel& panel, const StudyFigure& figure, const StudyTable& table,
                const std::vector<std::size_t>& rows) {
  std::vector<std::string> members = figure.members;
  const auto member = [&](std::size_t i) -> const std::string& { return table.text(figure.family, i); };
  if (members.empty()) {
    for (const std::size_t i : rows) {
      if (std::find(members.begin(), members.end(), member(i)) == members.end()) members.push_back(member(i));
    }
  }
  std::vector<double> numbers(members.size(), std::nan(""));
  std::vector<std::vector<std::pair<double, double>>> points(members.size());
  for (const std::size_t i : rows) {
    const auto c = static_cast<std::size_t>(std::find(members.begin(), members.end(), member(i)) - members.begin());
    if (c == members.size()) continue;
    numbers[c] = table.numbers(figure.family)[i];
    points[c].emplace_back(table.numbers(figure.x)[i], table.numbers(figure.y.front())[i]);
  }
  const std::vector<std::string> labels = member_labels(figure, members, numbers);
  // A computed column may have any number of values.
  const std::size_t every = (members.size() + most_lines - 1) / most_lines;
  if (every > 1)
    panel.title =
        fmt::format("{} of {} values of {}", (members.size() + every - 1) / every, members.size(), figure.family);
  for (std::size_t c = 0; c < members.size(); c += every) {
    panel.series.push_back(
        sorted_series(std::move(points[c]), label_of(figure, c, labels[c]), static_cast<int>(c / every)));
  }
}

void add_fronts(Panel& panel, const StudyFigure& figure, const StudyTable& table,
                const std::vector<std::size_t>& rows) {
  const std::vector<std::string> titles = curve_titles(figure.y);
  for (std::size_t c = 0; c < figure.y.size(); ++c) {
    std::vector<std::pair<double, double>> points;
    for (const std::size_t i : rows) {
      points.emplace_back(table.numbers(figure.y[c] + ".error_um")[i],
                          table.numbers(figure.y[c] + ".cycle_time_ms")[i]);
    }
    Series all = sorted_series(std::move(points), label_of(figure, c, titles[c]), static_cast<int>(c));
    Series front = all;
    front.x.clear();
    front.y.clear();
    for (std::size_t i = 0; i < all.x.size(); ++i) {
      if (!front.y.empty() && all.y[i] >= front.y.back()) continue;
      front.x.push_back(all.x[i]);
      front.y.push_back(all.y[i]);
    }
    front.mark = Mark::line_points;
    panel.series.push_back(std::move(front));
  }
}

/// The class of a word: for tied names ("a=b=c") the first one, else there would be more classes than symbols.
std::string class_of(const std::string& word) {
  return word.substr(0, word.find('='));
}

/// Draws words over a plane: one symbol per class, at the true positions, so uneven and logarithmic axes work too.
void add_classes(Panel& panel, const StudyFigure& figure, const StudyTable& table,
                 const std::vector<std::size_t>& rows) {
  std::set<std::string> classes;
  for (const std::size_t i : rows) {
    if (!table.text(figure.z, i).empty()) classes.insert(class_of(table.text(figure.z, i)));
  }
  for (const std::string& name : classes) {
    Series s;
    s.label = study::computation_title(name);
    s.mark = Mark::points;
    s.style = static_cast<int>(panel.series.size());
    for (const std::size_t i : rows) {
      if (class_of(table.text(figure.z, i)) != name) continue;
      s.x.push_back(table.numbers(figure.x)[i]);
      s.y.push_back(table.numbers(figure.y.front())[i]);
    }
    panel.series.push_back(std::move(s));
  }
  // A frame half a step wider, so that no symbol lies on it.
  const auto frame = [&](Scale& scale, const std::string& column) {
    std::set<double> values;
    for (const std::size_t i : rows) {
      const double v = table.numbers(column)[i];
      if (std::isfinite(v) && (!scale.log || v > 0.0)) values.insert(v);
    }
    if (values.empty()) return;
    const std::vector<double> edges = cell_edges({values.begin(), values.end()}, scale.log);
    scale.min = edges.front();
    scale.max = edges.back();
  };
  frame(panel.x, figure.x);
  frame(panel.y, figure.y.front());
}

/// Keeps every k-th of values that are too close together for a map, the same ones for all.
std::vector<double> shown_values(const std::set<double>& values) {
  const std::size_t every = (values.size() + most_heat_values - 1) / most_heat_values;
  std::vector<double> shown;
  std::size_t i = 0;
  for (const double v : values) {
    if (i++ % every == 0) shown.push_back(v);
  }
  return shown;
}

void add_heat(Panel& panel, const StudyFigure& figure, const StudyTable& table, const std::vector<std::size_t>& rows) {
  const auto &x = table.numbers(figure.x), &y = table.numbers(figure.y.front()), &z = table.numbers(figure.z);
  std::set<double> xs, ys;
  for (const std::size_t i : rows) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    xs.insert(x[i]);
    ys.insert(y[i]);
  }
  if (xs.empty()) return;
  HeatMap map;
  map.x = shown_values(xs);
  map.y = shown_values(ys);
  if (map.x.size() < xs.size() || map.y.size() < ys.size())
    panel.title =
        fmt::format("{} of {} values of x and {} of {} of y", map.x.size(), xs.size(), map.y.size(), ys.size());
  map.label = figure.z_label;
  map.with_sign = figure.excess;
  map.values.assign(map.x.size() * map.y.size(), std::nan(""));
  const auto place = [](const std::vector<double>& values, double v) {
    return static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), v) - values.begin());
  };
  for (const std::size_t i : rows) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    const std::size_t column = place(map.x, x[i]), line = place(map.y, y[i]);
    if (column == map.x.size() || line == map.y.size() || map.x[column] != x[i] || map.y[line] != y[i]) continue;
    map.values[line * map.x.size() + column] = z[i];
  }
  panel.heat_map = std::move(map);
}

}  // namespace

Figure make_study_figure(const StudyFigure& figure, const StudyTable& table) {
  const std::vector<std::size_t> rows = rows_of(figure, table);
  Panel panel;
  panel.x = {figure.x_label, figure.log_x, {}, {}};
  panel.y = {figure.y_label, figure.log_y, {}, {}};
  switch (figure.kind) {
    case Kind::curve: add_curves(panel, figure, table, rows); break;
    case Kind::family: add_family(panel, figure, table, rows); break;
    case Kind::pareto: add_fronts(panel, figure, table, rows); break;
    case Kind::heat: {
      const auto& z = table.numbers(figure.z);
      const bool words = std::none_of(rows.begin(), rows.end(), [&](std::size_t i) { return std::isfinite(z[i]); });
      words ? add_classes(panel, figure, table, rows) : add_heat(panel, figure, table, rows);
      break;
    }
  }
  if (figure.points_only && figure.kind != Kind::pareto) {
    for (Series& s : panel.series) s.mark = Mark::points;
  }
  for (Series& s : panel.series) thin_out(s, panel.title);
  Figure page;
  page.title = figure.title;
  page.panel_width = 760;
  page.panel_height = 430;
  page.panels.push_back(std::move(panel));
  return page;
}

}  // namespace accdec
