#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <accdec/plot/figure_frame.hpp>
#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/figure_legend.hpp>

namespace accdec {
namespace {

constexpr std::size_t most_end_labels = 8;

/// Whether a title has the label as words of its own, whatever their case.
bool in_words(std::string title, std::string label) {
  const auto lower = [](std::string& of) {
    for (char& c : of) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  };
  lower(title), lower(label);
  const auto inside = [&](std::size_t i) {
    return i < title.size() && std::isalnum(static_cast<unsigned char>(title[i]));
  };
  for (std::size_t at = title.find(label); at != title.npos; at = title.find(label, at + 1)) {
    if ((at == 0 || !inside(at - 1)) && !inside(at + label.size())) return true;
  }
  return false;
}

/// How far along an axis a value is, 0 at its low end and 1 at its high one.
double along(const Scale& scale, const AxisRange& range, double value) {
  const auto at = [&](double v) { return scale.log ? std::log(v) : v; };
  return (at(value) - at(range.low)) / (at(range.high) - at(range.low));
}

/// Index of the last point that is drawn; npos if there is none.
std::size_t last_drawn(const Panel& panel, const Series& series) {
  const auto shown = [](const Scale& scale, double v) { return std::isfinite(v) && (!scale.log || v > 0.0); };
  for (std::size_t i = series.x.size(); i-- > 0;) {
    if (shown(panel.x, series.x[i]) && shown(panel.y, series.y[i])) return i;
  }
  return std::string::npos;
}

bool is_labelled(const Series& series) {
  return !series.label.empty() && !series.x.empty();
}

bool ends_at_the_right(const Panel& panel, const Series& series, const AxisRange& x, const AxisRange& y) {
  constexpr double near = 0.02;
  if (series.mark == Mark::points || series.mark == Mark::impulses || series.mark == Mark::bars) return false;
  const std::size_t last = last_drawn(panel, series);
  if (last == std::string::npos) return false;
  const double right = along(panel.x, x, series.x[last]), up = along(panel.y, y, series.y[last]);
  return std::abs(right - 1.0) <= near && up >= 0.0 && up <= 1.0;
}

/// Labels that stand below each other without air between them.
struct Stack {
  std::vector<EndPlace> labels;
  double top = 0.0, height = 0.0;

  static double height_of(const EndPlace& label) { return closest_end_lines * static_cast<double>(label.lines.size()); }
  /// As near as possible to the ends of the lines, within the plot.
  void settle(double first, double last) {
    height = 0.0;
    double sum = 0.0;
    for (const EndPlace& label : labels) {
      sum += label.from - (height + 0.5 * height_of(label));
      height += height_of(label);
    }
    top = std::max(first, std::min(sum / static_cast<double>(labels.size()), last - height));
  }
};

}  // namespace

std::vector<std::string> legend_labels(const Panel& panel) {
  std::vector<std::string> labels;
  const auto add = [&](const auto& items) {
    for (const auto& item : items) {
      if (!item.label.empty()) labels.push_back(legend_label(item.label));
    }
  };
  for (const Series& series : panel.series)
    if (is_labelled(series)) labels.push_back(legend_label(series.label));
  add(panel.limits);
  add(panel.circles);
  add(panel.bands);
  return labels;
}

LegendKind legend_kind(const Figure& figure, const Panel& panel) {
  const std::size_t labels = legend_labels(panel).size();
  if (labels == 0 || figure.one_legend) return LegendKind::none;
  const auto of_series = static_cast<std::size_t>(std::ranges::count_if(panel.series, is_labelled));
  if (of_series != labels || panel.heat_map || panel.coloured) return LegendKind::column;
  if (labels == 1) return panel.series.size() == 1 && panel.limits.empty() ? LegendKind::title : LegendKind::column;
  if (labels > most_end_labels || panel.equal_aspect) return LegendKind::column;
  const auto [x, y] = panel_frame(panel, 1.0, 1.0);
  const bool all = std::ranges::all_of(panel.series, [&, &x = x, &y = y](const Series& s) {
    return !is_labelled(s) || ends_at_the_right(panel, s, x, y);
  });
  return all ? LegendKind::ends : LegendKind::column;
}

std::string panel_title(const Figure& figure, const Panel& panel) {
  if (legend_kind(figure, panel) != LegendKind::title) return panel.title;
  const std::string& label = panel.series.front().label;
  if (in_words(figure.title, label) || in_words(panel.title, label)) return panel.title;
  return panel.title.empty() ? label : panel.title + ": " + label;
}

std::vector<EndPlace> end_places(const Panel& panel, double top, double height) {
  const auto [x, y] = panel_frame(panel, 1.0, 1.0);
  std::vector<EndPlace> ends;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    const Series& series = panel.series[i];
    if (!is_labelled(series)) continue;
    const double up = along(panel.y, y, series.y[last_drawn(panel, series)]);
    ends.push_back({i, top + height * (1.0 - up), 0.0, legend_lines(series.label, longest_end_label)});
  }
  std::ranges::stable_sort(ends, {}, &EndPlace::from);
  std::vector<Stack> stacks;
  for (EndPlace& end : ends) {
    stacks.push_back({{std::move(end)}});
    stacks.back().settle(top, top + height);
    while (stacks.size() > 1 && stacks.back().top < stacks[stacks.size() - 2].top + stacks[stacks.size() - 2].height) {
      Stack& above = stacks[stacks.size() - 2];
      std::ranges::move(stacks.back().labels, std::back_inserter(above.labels));
      stacks.pop_back();
      above.settle(top, top + height);
    }
  }
  ends.clear();
  for (Stack& stack : stacks) {
    double at = stack.top;
    for (EndPlace& label : stack.labels) {
      label.to = at + 0.5 * Stack::height_of(label);
      at += Stack::height_of(label);
      ends.push_back(std::move(label));
    }
  }
  return ends;
}

std::vector<LegendPlace> limit_name_places(const Panel& panel, double right, double top, double height) {
  constexpr double above = 7.0, line = 12.0, air = 8.0, edge = 4.0;
  const auto [x, y] = panel_frame(panel, 1.0, 1.0);
  std::vector<LegendPlace> places;
  for (const LimitLine& limit : panel.limits) {
    if (!limit.name.empty())
      places.push_back(
          {axis_name(limit.name), right - edge, top + height * (1.0 - along(panel.y, y, limit.y)) - above});
  }
  std::ranges::sort(places, std::ranges::greater{}, &LegendPlace::y);
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (places[i - 1].y - places[i].y < line) places[i].x = places[i - 1].x - text_width(places[i - 1].label) - air;
  }
  return places;
}

std::vector<LegendPlace> page_legend(const Figure& figure, double width) {
  constexpr double side = 20.0, air = 18.0;
  const auto columns = static_cast<std::size_t>(figure.columns);
  const double column_width = width / static_cast<double>(columns);
  std::vector<LegendPlace> places;
  std::size_t row_begin = 0, rows = 0;
  double x = side;
  // In the middle of its column.
  const auto end_row = [&] {
    const double shift = static_cast<double>(rows % columns) * column_width + 0.5 * (column_width - side - (x - air));
    for (; row_begin < places.size(); ++row_begin) places[row_begin].x += shift;
    ++rows, x = side;
  };
  for (const Panel& panel : figure.panels) {
    for (const std::string& label : legend_labels(panel)) {
      if (std::ranges::find(places, label, &LegendPlace::label) != places.end()) continue;
      const double wide = legend_sample + text_width(label);
      if (x > side && x + wide > column_width - side) end_row();
      places.push_back({label, x, legend_row * static_cast<double>(rows / columns)});
      x += wide + air;
    }
  }
  end_row();
  return places;
}

}  // namespace accdec
