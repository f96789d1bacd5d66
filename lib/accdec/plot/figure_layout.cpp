#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <accdec/plot/figure_layout.hpp>

namespace accdec {
namespace {

constexpr double left = 70, right = 18, top = 30, bottom = 56;  // px around a plot
constexpr double title_line = 16, heading_line = 20;            // px
constexpr double long_legend_sample = 58, legend_air = 18;
constexpr double narrowest_plot = 320, closest_lines = 12.6, line_height = 18, colour_bar = 104;
constexpr double narrow_label = 220, wide_label = 300, longest_label = 420, longest_name = 200;
constexpr double all_of_a_label = 840;  // px, on several lines

std::size_t character_length(const std::string& text, std::size_t i) {
  std::size_t length = 1;
  while (i + length < text.size() && (text[i + length] & 0xC0) == 0x80) ++length;
  return length;
}

/// px, from the font's tables, in groups.
double character_width(const std::string& text, std::size_t i) {
  const auto c = static_cast<unsigned char>(text[i]);
  if (c >= 0xE1) return 12.0;  // ideographs and the like; a guess for the rest
  if (c >= 0x80) return 8.5;
  const auto among = [c](std::string_view set) { return set.find(static_cast<char>(c)) != std::string_view::npos; };
  if (among("ijlI.,:;'!| ")) return 4.0;
  if (among("frt()[]-/\\\"")) return 5.0;
  if (among("mw%MW@")) return 11.9;
  if (among("OQGDNHUAVXYCRK=+<>#~^&")) return 10.0;
  return 7.7;
}

/// A legend in its lines, px.
struct Legend {
  double line = longest_label, width = 0.0, height = 0.0;
  std::size_t lines = 0;
};

/// The narrowest legend whose lines fit beside a plot `height` px high.
Legend legend_of(const Panel& panel, LegendKind kind, double height) {
  Legend legend;
  if (panel.heat_map || panel.coloured) legend.width = colour_bar;
  if (legend.width > 0.0 || kind == LegendKind::none || kind == LegendKind::title) return legend;
  const std::vector<std::string> labels = legend_labels(panel);
  double widest = 0.0;
  if (kind == LegendKind::ends) {
    for (const std::string& label : labels) {
      for (const std::string& part : wrapped(label, longest_end_label)) {
        widest = std::max(widest, text_width(part));
        legend.height += closest_end_lines;
      }
    }
    legend.width = leader + widest + legend_air;
    return legend;
  }
  for (const double line : {narrow_label, wide_label, longest_label}) {
    legend.line = line, legend.lines = 0, widest = 0.0;
    for (const std::string& label : labels) {
      for (const std::string& part : wrapped(label, line)) widest = std::max(widest, text_width(part)), ++legend.lines;
    }
    if (closest_lines * static_cast<double>(legend.lines) <= height) break;
  }
  const double sample = has_marked_lines(panel) ? long_legend_sample : legend_sample;
  if (widest > 0.0) legend.width = widest + sample + legend_air;
  legend.height = closest_lines * static_cast<double>(legend.lines) + line_height;
  return legend;
}

/// Width that tick labels of the y axis need beyond the margin for four characters.
double tick_overhang(const Panel& panel) {
  if (!panel.y.names.empty()) {
    double widest = 0.0;
    for (const std::string& name : panel.y.names) widest = std::max(widest, text_width(axis_name(name)));
    return std::max(0.0, widest - 4.0 * 8.0);
  }
  double low = INFINITY, high = 0.0;
  bool minus = false;
  const auto see = [&](double y) {
    if (!std::isfinite(y) || y == 0.0) return;
    minus = minus || y < 0.0;
    low = std::min(low, std::abs(y));
    high = std::max(high, std::abs(y));
  };
  for (const Series& s : panel.series) std::for_each(s.y.begin(), s.y.end(), see);
  for (const LimitLine& limit : panel.limits) see(limit.y);
  for (const std::optional<double>& end : {panel.y.min, panel.y.max}) see(end.value_or(0.0));
  if (panel.heat_map) std::for_each(panel.heat_map->y.begin(), panel.heat_map->y.end(), see);
  if (!(high > 0.0)) return 0.0;
  double characters = std::floor(std::log10(high) + 1e-9) + 1.0 + (minus ? 1.0 : 0.0);           // 14000 is five
  if (panel.y.log) characters = std::max(characters, 2.0 - std::floor(std::log10(low) + 1e-9));  // 0.001 is five
  constexpr double character = 8.0;
  return character * std::clamp(characters - 4.0, 0.0, 4.0);
}

std::string power_of_ten(int exponent) {
  constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent))) text += digits[c - '0'];
  return text;
}

}  // namespace

double text_width(const std::string& text) {
  double width = 0.0;
  for (std::size_t i = 0; i < text.size(); i += character_length(text, i)) width += character_width(text, i);
  return width;
}

std::string shortened(const std::string& text, double width) {
  if (text_width(text) <= width) return text;
  std::vector<std::string> characters;
  for (std::size_t i = 0; i < text.size(); i += characters.back().size())
    characters.push_back(text.substr(i, character_length(text, i)));
  std::string head, tail;
  double room = width - 12.0;
  for (std::size_t first = 0, last = characters.size(); first < last;) {
    const bool at_head = first <= characters.size() - last;
    const std::string& next = characters[at_head ? first : last - 1];
    room -= text_width(next);
    if (room < 0.0) break;
    if (at_head)
      head += next, ++first;
    else
      tail.insert(0, next), --last;
  }
  return head + "…" + tail;
}

std::vector<std::string> wrapped(const std::string& text, double width) {
  std::vector<std::string> lines(1);
  double used = 0.0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find(' ', i), text.size());
    std::string word = text.substr(i, end - i);
    i = end + 1;
    if (used > 0.0 && used + 4.0 + text_width(word) > width) {
      lines.emplace_back();
      used = 0.0;
    }
    if (used > 0.0) word.insert(word.begin(), ' ');
    for (std::size_t k = 0; k < word.size();) {
      const std::size_t length = character_length(word, k);
      const double wide = character_width(word, k);
      if (used > 0.0 && used + wide > width) {
        lines.emplace_back();
        used = 0.0;
      }
      lines.back().append(word, k, length);
      used += wide;
      k += length;
    }
  }
  return lines;
}

std::string axis_name(const std::string& name) {
  return shortened(clean_title(name), longest_name);
}

std::string legend_label(const std::string& label) {
  return shortened(clean_title(label), all_of_a_label);
}

std::vector<std::string> legend_lines(const std::string& label, double width) {
  return wrapped(legend_label(label), width);
}

bool has_marked_lines(const Panel& panel) {
  return std::any_of(panel.series.begin(), panel.series.end(),
                     [](const Series& s) { return s.mark == Mark::marked_line; });
}

std::vector<Tick> log_ticks(double low, double high, double pixels, double room) {
  constexpr double air = 8.0, slack = 1e-9;
  const double first = std::ceil(std::log10(low) - slack), last = std::floor(std::log10(high) + slack);
  const double decade = pixels / (std::log10(high) - std::log10(low));
  // All labels of an axis in one notation.
  const bool powers = low < 1e-4 || high >= 1e6;
  const auto label = [powers](char digit, double exponent) {
    if (!powers) return fmt::format("{:g}", (digit - '0') * std::pow(10.0, exponent));
    const std::string power = power_of_ten(static_cast<int>(exponent));
    return digit == '1' ? power : fmt::format("{}\u00b7{}", digit, power);
  };
  std::vector<Tick> ticks;
  if (last - first < 2.0) {  // powers of ten would be too few
    for (const std::string_view digits : {"125", "15", "13", "123456789"}) {
      ticks.clear();
      bool fit = true;
      for (double exponent = first - 1.0; exponent <= last; ++exponent) {
        for (const char digit : digits) {
          const double value = (digit - '0') * std::pow(10.0, exponent);
          if (value < low * (1.0 - slack) || value > high * (1.0 + slack)) continue;
          std::string text = label(digit, exponent);
          const double before = ticks.empty() ? 0.0 : text_width(ticks.back().label);
          const double needed = room > 0.0 ? room : 0.5 * (text_width(text) + before) + air;
          fit = fit && (ticks.empty() || decade * std::log10(value / ticks.back().value) >= needed);
          ticks.push_back({value, std::move(text)});
        }
      }
      if (fit && ticks.size() >= 2) return ticks;
    }
    if (last < first) return {};
  }
  double widest = 0.0;
  for (double e = first; e <= last; ++e) widest = std::max(widest, room > 0.0 ? room : text_width(label('1', e)) + air);
  if (widest <= decade && last - first < 7.0 && first >= -4.0 && last <= 5.0) return {};
  widest = 0.0;
  for (double e = first; e <= last; ++e)
    widest = std::max(widest, room > 0.0 ? room : text_width(power_of_ten(static_cast<int>(e))) + air);
  const int every = std::max(static_cast<int>(std::ceil(widest / decade)), 1);
  for (double e = first; e <= last; ++e) {
    const int exponent = static_cast<int>(e);
    ticks.push_back({std::pow(10.0, e), exponent % every == 0 ? power_of_ten(exponent) : ""});
  }
  return ticks;
}

std::vector<double> cell_edges(const std::vector<double>& values, bool log) {
  std::vector<double> at, edges;
  for (const double v : values) at.push_back(log ? std::log10(v) : v);
  const double lone =
      log || at.front() == 0.0 ? 0.5 : 0.5 * std::abs(at.front());  // half the width of a cell without neighbours
  edges.push_back(at.size() > 1 ? 1.5 * at[0] - 0.5 * at[1] : at[0] - lone);
  for (std::size_t i = 1; i < at.size(); ++i) edges.push_back(0.5 * (at[i - 1] + at[i]));
  edges.push_back(2.0 * at.back() - edges.back());
  if (log) {
    for (double& e : edges) e = std::pow(10.0, e);
  }
  return edges;
}

bool has_data(const Panel& panel) {
  const auto shown = [](const Scale& scale, double v) { return std::isfinite(v) && (!scale.log || v > 0.0); };
  const auto any = [&](const auto& lines) {
    for (const auto& l : lines) {
      for (std::size_t i = 0; i < l.x.size(); ++i) {
        if (shown(panel.x, l.x[i]) && shown(panel.y, l.y[i])) return true;
      }
    }
    return false;
  };
  if (any(panel.series) || !panel.circles.empty() || (panel.coloured && any(panel.coloured->pieces))) return true;
  if (!panel.heat_map) return false;
  return std::any_of(panel.heat_map->values.begin(), panel.heat_map->values.end(),
                     [](double v) { return std::isfinite(v); });
}

namespace {

/// Room to the left and the right of every plot, px.
struct Sides {
  std::vector<double> indent;
  std::vector<LegendKind> kind;
  std::vector<Legend> legend;
};

Sides sides_of(const Figure& figure, std::size_t columns) {
  Sides sides;
  for (const Panel& panel : figure.panels) {
    sides.indent.push_back(left + tick_overhang(panel));
    sides.kind.push_back(legend_kind(figure, panel));
    sides.legend.push_back(legend_of(panel, sides.kind.back(), figure.panel_height - top - bottom));
  }
  const auto share = [&](auto get) {
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      for (std::size_t k = i % columns; k < figure.panels.size(); k += columns) {
        const std::string& quantity = figure.panels[i].x.label;
        if (!quantity.empty() && quantity == figure.panels[k].x.label) get(i) = std::max(get(i), get(k));
      }
    }
  };
  share([&](std::size_t i) -> double& { return sides.indent[i]; });
  share([&](std::size_t i) -> double& { return sides.legend[i].width; });
  return sides;
}

/// px of every column.
std::vector<double> column_widths(const Figure& figure, const Sides& sides, std::size_t columns) {
  std::vector<double> widths(columns, figure.panel_width);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const double beside = sides.indent[i] + right + sides.legend[i].width;
    widths[i % columns] =
        std::max(widths[i % columns], beside + std::min(narrowest_plot, figure.panel_width - left - right));
  }
  return widths;
}

}  // namespace

double taller_for(double aspect) {
  const Figure usual;
  return (aspect * (usual.panel_width - left - right) + top + bottom) / usual.panel_height;
}

PageLayout layout(const Figure& figure) {
  if (figure.panels.empty() || figure.columns < 1)
    throw std::invalid_argument("a figure needs at least one panel and one column");
  const std::size_t count = figure.panels.size(), columns = std::min(static_cast<std::size_t>(figure.columns), count),
                    rows = (count + columns - 1) / columns;
  PageLayout page;
  const Sides sides = sides_of(figure, columns);
  const std::vector<double> widths = column_widths(figure, sides, columns);
  std::vector<double> heights(rows, figure.panel_height);
  for (const double w : widths) page.width += w;
  if (!figure.title.empty()) {
    constexpr double of_body = 15.0 / 12.0;
    page.title = wrapped(clean_title(figure.title), (page.width - 40.0) / of_body);
  }
  const double heading = page.title.empty() ? 0.0 : 14.0 + heading_line * static_cast<double>(page.title.size());
  page.height = heading;
  if (figure.one_legend) page.legend = page_legend(figure, page.width);
  for (LegendPlace& place : page.legend) place.y += heading + 0.5 * legend_row;
  if (!page.legend.empty()) page.height = page.legend.back().y + legend_row;
  page.panels.resize(count);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t begin = row * columns, end = std::min(begin + columns, count);
    double titles = 0.0, x = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      PanelLayout& p = page.panels[i];
      const double indent = sides.indent[i];
      p.x = x;
      p.y = page.height;
      p.width = end - begin == 1 ? page.width : widths[i - begin];  // alone in its row, it leaves no empty half
      p.plot_left = x + indent;
      p.plot_width = std::max(p.width - indent - right - sides.legend[i].width, 80.0);
      p.legend = sides.kind[i];
      p.legend_line = sides.legend[i].line;
      x += p.width;
      // Titles stand over the middle of the plot.
      const double middle = indent + 0.5 * p.plot_width;
      p.title =
          wrapped(clean_title(panel_title(figure, figure.panels[i])), 2.0 * std::min(middle, p.width - middle) - 12.0);
      titles = std::max(titles, title_line * static_cast<double>(p.title.size() - 1));
    }
    for (std::size_t i = begin; i < end; ++i) {
      heights[row] = std::max(heights[row], top + titles + bottom + std::max(60.0, sides.legend[i].height));
    }
    double taller = 1.0;
    for (std::size_t i = begin; i < end; ++i) taller = std::max(taller, figure.panels[i].taller);
    heights[row] = std::max(heights[row], taller * figure.panel_height + titles);
    for (std::size_t i = begin; i < end; ++i) {
      PanelLayout& p = page.panels[i];
      p.height = heights[row];
      p.plot_top = p.y + top + titles;
      p.plot_height = p.height - top - titles - bottom;
      // Closer if there are many, so that they end with the panel.
      const double lines = static_cast<double>(std::max<std::size_t>(sides.legend[i].lines, 1));
      p.key_spacing = std::clamp((p.plot_height - 4.0) / (line_height * lines), closest_lines / line_height, 1.15);
      if (p.legend == LegendKind::ends) p.ends = end_places(figure.panels[i], p.plot_top, p.plot_height);
    }
    page.height += heights[row];
  }
  return page;
}

}  // namespace accdec
