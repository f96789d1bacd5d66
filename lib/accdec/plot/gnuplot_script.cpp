#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <accdec/plot/figure_frame.hpp>
#include <accdec/plot/figure_layout.hpp>
#include <accdec/plot/figure_looks.hpp>
#include <accdec/plot/figure_style.hpp>

namespace accdec {
namespace {

using namespace figure_style;

/// A double-quoted gnuplot string; all characters with a meaning (quotes, backslashes, backticks, ...) are octal codes.
/// Single quotes do not work: gnuplot 5.4 ends ''''...' early.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : clean_title(text)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool harmless = byte >= 0x80 || std::isalnum(byte) != 0 ||
                          (c != '\0' && std::string_view(" .,:;=()/-+").find(c) != std::string_view::npos);
    out += harmless ? std::string(1, c) : fmt::format("\\{:03o}", byte);
  }
  return out + "\"";
}

/// Lines below one another as one string.
std::string quoted(const std::vector<std::string>& lines) {
  std::string out = "\"";
  for (const std::string& line : lines) {
    const std::string one = quoted(line);
    out.append(out.size() > 1 ? "\\n" : "").append(one, 1, one.size() - 2);
  }
  return out + "\"";
}

/// Ten significant digits: more than visible, but fewer than those that differ between machines by rounding.
std::string number(double x) {
  return std::isfinite(x) ? fmt::format("{:.10g}", x == 0.0 ? 0.0 : x) : "NaN";
}

void check(const Panel& panel) {
  for (const Series& s : panel.series) {
    if (s.x.size() != s.y.size())
      throw std::invalid_argument(fmt::format("series \"{}\": {} x and {} y", s.label, s.x.size(), s.y.size()));
  }
  if (panel.coloured) {
    if (panel.heat_map) throw std::invalid_argument("a panel has one colour bar: a heat map or coloured lines");
    for (const ColouredLines::Piece& piece : panel.coloured->pieces) {
      if (piece.x.size() != piece.y.size())
        throw std::invalid_argument(fmt::format("coloured lines: {} x and {} y", piece.x.size(), piece.y.size()));
    }
  }
  if (panel.heat_map) {
    const HeatMap& map = *panel.heat_map;
    const auto fit = [](const std::vector<double>& v, const Scale& scale) {
      return !v.empty() && std::is_sorted(v.begin(), v.end(), std::less_equal<>()) && (!scale.log || v.front() > 0.0);
    };
    if (!fit(map.x, panel.x) || !fit(map.y, panel.y) || map.values.size() != map.x.size() * map.y.size()) {
      throw std::invalid_argument(
          "a heat map needs rising x and y, positive on a logarithmic scale, and a value for each pair");
    }
  }
}

std::string with(const Series& s) {
  const char* colour = colour_of(s);
  const std::string line = line_of(s), point = fmt::format("pt {} ps 0.6", symbol_of(s));
  switch (s.mark) {
    case Mark::line: return "lines " + line;
    case Mark::points: return fmt::format("points lc rgb '{}' {}", colour, point);
    case Mark::line_points: return fmt::format("linespoints {} {}", line, point);
    case Mark::marked_line: return "lines " + line;
    case Mark::steps: return "fsteps " + line;
    case Mark::bars: return fmt::format("boxes fc rgb '{}' fs solid border lc rgb '#ffffff'", colour);
    case Mark::impulses: return fmt::format("impulses lc rgb '{}' lw 1.5", colour);
  }
  return "lines";
}

/// The symbols of a marked line, and its sample in the legend.
std::string marks_with(const Series& s) {
  return fmt::format("points lc rgb '{}' lw 1.4 pt {} ps 0.8", colour_of(s), symbol_of(s));
}
std::string sample_with(const Series& s) {
  return fmt::format("{} pt {} ps 0.8 pi -1", line_of(s), symbol_of(s));
}

/// Places of the symbols of a marked line: equally far apart for every style but shifted, so that coinciding lines show
/// their own symbols.
std::pair<std::vector<double>, std::vector<double>> marks(const Series& s, const Scale& x_scale, const AxisRange& x,
                                                          const Scale& y_scale) {
  constexpr int count = 6;
  constexpr double golden = 0.6180339887498949;
  const double shift = std::fmod(0.5 + golden * static_cast<double>(style_index(s.style)), 1.0);
  const auto scaled = [](const Scale& scale, double v) { return scale.log ? std::log10(v) : v; };
  const auto unscaled = [](const Scale& scale, double v) { return scale.log ? std::pow(10.0, v) : v; };
  const double from = scaled(x_scale, x.low), width = scaled(x_scale, x.high) - from;
  std::vector<double> xs, ys;
  for (int k = 0; k < count; ++k) {
    const double at = unscaled(x_scale, from + width * (k + shift) / count);
    const auto after = std::upper_bound(s.x.begin(), s.x.end(), at) - s.x.begin();
    if (after == 0 || after == static_cast<std::ptrdiff_t>(s.x.size())) continue;
    const auto i = static_cast<std::size_t>(after);
    const double a = scaled(x_scale, s.x[i - 1]), b = scaled(x_scale, s.x[i]), low = scaled(y_scale, s.y[i - 1]),
                 high = scaled(y_scale, s.y[i]);
    xs.push_back(at);
    ys.push_back(unscaled(y_scale, low + (high - low) * (scaled(x_scale, at) - a) / (b - a)));
  }
  return {xs, ys};
}

/// Smallest distance of neighbours, 1 if there are none.
double narrowest(const std::vector<double>& x) {
  double width = INFINITY;
  for (std::size_t i = 1; i < x.size(); ++i) width = std::min(width, std::abs(x[i] - x[i - 1]));
  return std::isfinite(width) && width > 0.0 ? width : 1.0;
}

class Writer {
 public:
  std::string text;

  void panel(const Panel& panel, const PanelLayout& place, const PageLayout& page) {
    check(panel);
    const auto [x, y] = panel_frame(panel, place.plot_width, place.plot_height);
    line("set lmargin at screen {:.6f}", place.plot_left / page.width);
    line("set rmargin at screen {:.6f}", (place.plot_left + place.plot_width) / page.width);
    line("set tmargin at screen {:.6f}", 1.0 - place.plot_top / page.height);
    line("set bmargin at screen {:.6f}", 1.0 - (place.plot_top + place.plot_height) / page.height);
    line("set title {} offset 0,-0.5", quoted(place.title));
    line("set xlabel {} offset 0,0.7", quoted(shortened(clean_title(panel.x.label), place.width - 20.0)));
    line("set ylabel {} offset 0.6,0", quoted(shortened(clean_title(panel.y.label), place.height - 20.0)));
    scale('x', panel.x, x, place.plot_width, 0.0);
    scale('y', panel.y, y, place.plot_height, 18.0);
    line("set key at screen {:.6f},{:.6f} left top Left reverse samplen {} spacing {:.3g} maxcols 1",
         (place.plot_left + place.plot_width + 8) / page.width, 1.0 - place.plot_top / page.height,
         has_marked_lines(panel) ? "5.6" : "2.6", place.key_spacing);
    line("unset object\nunset colorbox");
    const bool zero = y.low < 0.0 && y.high > 0.0 && !panel.heat_map && !panel.equal_aspect;
    line("{}", zero ? "set xzeroaxis lc rgb '#808080' lw 0.8 dt solid" : "unset xzeroaxis");
    legend_ = place.legend;
    for (const EndPlace& end : place.ends) end_label(panel.series[end.series], end, place, page);
    for (const Note& note : panel.notes) {
      line("set label {} at {},{} center offset 0,{} font 'DejaVu Sans,10' tc rgb '{}' front", quoted(note.text),
           number(note.x), number(note.y), note.below ? "-0.5" : "0.5", colours[binding_style]);
    }
    for (const LegendPlace& name :
         limit_name_places(panel, place.plot_left + place.plot_width, place.plot_top, place.plot_height))
      line("set label {} at screen {:.6f},{:.6f} right font 'DejaVu Sans,10' tc rgb '{}' front", quoted(name.label),
           name.x / page.width, 1.0 - name.y / page.height, limit_colour);
    plot(panel, x, y, place.legend_line);
    line("unset arrow\nunset label");
  }

  void legend(const Figure& figure, const PageLayout& page) {
    for (const LegendPlace& place : page.legend) {
      const auto [drawn, point] = sample_of(figure, place.label);
      constexpr double wide = 26.0;
      // gnuplot 5.4 keeps the dashes of the line before unless its colour was another.
      segment(place.x, place.y, place.x, place.y, "lc rgb '#ffffff'", page);
      if (!drawn.empty()) segment(place.x, place.y, place.x + wide, place.y, drawn, page);
      if (!point.empty()) text_at(place.x + 0.5 * wide, place.y, "", " point " + point, page);
      text_at(place.x + legend_sample, place.y, place.label, "", page);
    }
  }

 private:
  template <typename... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    text += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }

  /// On the page, px from its top left corner.
  void segment(double x0, double y0, double x1, double y1, const std::string& look, const PageLayout& page) {
    line("set arrow from screen {:.6f},{:.6f} to screen {:.6f},{:.6f} nohead {}", x0 / page.width,
         1.0 - y0 / page.height, x1 / page.width, 1.0 - y1 / page.height, look);
  }
  void text_at(double x, double y, const std::string& words, const std::string& look, const PageLayout& page) {
    line("set label {} at screen {:.6f},{:.6f} left{}", quoted(words), x / page.width, 1.0 - y / page.height, look);
  }
  /// A label and the line that leads to it.
  void end_label(const Series& s, const EndPlace& end, const PanelLayout& place, const PageLayout& page) {
    const double right = place.plot_left + place.plot_width;
    segment(right + 2.0, end.from, right + leader - 4.0, end.to,
            fmt::format("lc rgb '{}' lw 1.2 dt solid", colour_of(s)), page);
    double y = end.to - 0.5 * closest_end_lines * (static_cast<double>(end.lines.size()) - 1.0);
    for (const std::string& words : end.lines)
      text_at(right + leader, std::exchange(y, y + closest_end_lines), words, "", page);
  }

  /// @param room  px a tick label needs along the axis, 0: its width
  void scale(char axis, const Scale& scale, const AxisRange& range, double pixels, double room) {
    line("{} logscale {}", scale.log ? "set" : "unset", axis);
    // All numbers of an axis in one notation; '%g' would write 500000 beside 1e+06.
    const double most = std::max(std::abs(range.low), std::abs(range.high));
    line("set format {} '{}'", axis, !scale.log && most >= 1e6 && most < 1e8 ? "%.8g" : "%g");
    line("set {}range [{}:{}] noextend", axis, number(range.low), number(range.high));
    std::string ticks;
    if (scale.log) {
      for (const Tick& tick : log_ticks(range.low, range.high, pixels, room)) {
        ticks +=
            fmt::format("{}{} {}", ticks.empty() ? "" : ", ", quoted(tick.label),
                        number(std::clamp(tick.value, range.low * (1.0 + 1e-9),
                                          range.high * (1.0 - 1e-9))));  // gnuplot leaves out ticks at the very end
      }
    }
    for (std::size_t i = 0; i < scale.names.size(); ++i) {
      ticks += fmt::format("{}{} {}", ticks.empty() ? "" : ", ", quoted(axis_name(scale.names[i])), i + 1);
    }
    const bool few = scale.whole && !scale.log && range.high - range.low < 8.0;
    line("set {}tics {}", axis, !ticks.empty() ? fmt::format("({})", ticks) : few ? "1" : "autofreq");
  }

  /// A drawn item with its place in the legend, where lines after the first have no sample.
  void add(std::vector<std::string>& items, const std::string& item, const std::string& label, double width) const {
    if (label.empty() || legend_ != LegendKind::column) {
      items.push_back(item + " notitle");
      return;
    }
    const std::vector<std::string> lines = legend_lines(label, width);
    items.push_back(item + " title " + quoted(lines[0]));
    for (std::size_t i = 1; i < lines.size(); ++i)
      items.push_back("NaN with lines lc rgb '#ffffff' title " + quoted(lines[i]));
  }

  /// @param legend_line  px of a line in the legend
  void plot(const Panel& panel, const AxisRange& x, const AxisRange& y, double legend_line) {
    int object = 0;
    for (const Band& band : panel.bands) {
      line("set object {} rectangle from {},graph 0 to {},graph 1 behind fc rgb '{}' fs solid noborder", ++object,
           number(std::clamp(band.from, x.low, x.high)), number(std::clamp(band.to, x.low, x.high)), band_colour);
    }
    for (const Circle& circle : panel.circles) {
      if (!circle.disc) continue;
      line("set object {} ellipse at {},{} size {},{} units xy behind fc rgb '{}' fs solid noborder", ++object,
           number(circle.x), number(circle.y), number(2.0 * circle.radius), number(2.0 * circle.radius), disc_colour);
    }
    std::vector<std::string> items;
    const auto data = [&](const std::vector<double>& xs, const std::vector<double>& ys) {
      std::string name = fmt::format("$d{}", ++block_);
      text += name + " << END_OF_DATA\n";
      for (std::size_t i = 0; i < xs.size(); ++i) text += number(xs[i]) + " " + number(ys[i]) + "\n";
      text += "END_OF_DATA\n";
      return name;
    };
    const auto draw = [&](const std::string& item, const std::string& label) { add(items, item, label, legend_line); };
    if (panel.heat_map && has_data(panel)) items.push_back(heat(*panel.heat_map, panel.x.log, panel.y.log));
    for (const Series& s : panel.series) {
      if (s.x.empty()) continue;
      const std::string columns = s.mark == Mark::bars ? fmt::format("1:2:({})", number(narrowest(s.x))) : "1:2";
      if (s.mark != Mark::marked_line) {
        draw(fmt::format("{} using {} with {}", data(s.x, s.y), columns, with(s)), s.label);
        continue;
      }
      const auto [xs, ys] = marks(s, panel.x, x, panel.y);
      items.push_back(fmt::format("{} using 1:2 with {} notitle", data(s.x, s.y), with(s)));
      if (!xs.empty()) {
        const std::string at = data(xs, ys);
        items.push_back(at +
                        " using 1:2 with points lc rgb '#ffffff' pt 7 ps 0.9 notitle");  // clears the line away, or a
                                                                                         // wide one would hide crosses
        items.push_back(fmt::format("{} using 1:2 with {} notitle", at, marks_with(s)));
      }
      if (!s.label.empty() && legend_ == LegendKind::column)
        draw(fmt::format("NaN with linespoints {}", sample_with(s)), s.label);
    }
    if (panel.coloured) items.push_back(coloured(*panel.coloured));
    for (const LimitLine& limit : panel.limits) {
      draw(fmt::format("{} using 1:2 with lines {}", data({x.low, x.high}, {limit.y, limit.y}), limit_line()),
           limit.label);
    }
    for (const Circle& circle : panel.circles) {
      if (!circle.disc)
        draw(round(circle, data), circle.label);
      else if (!circle.label.empty())
        draw("NaN with lines " + band_line(disc_colour), circle.label);
    }
    for (const Band& band : panel.bands) {
      if (!band.label.empty() && legend_ == LegendKind::column) draw("NaN with lines " + band_line(), band.label);
    }
    if (!has_data(panel)) line("set label 2 'no data' at graph 0.5,0.5 center font 'DejaVu Sans,15' tc rgb '#606060'");
    if (items.empty()) items.push_back(fmt::format("{} using 1:2 with dots notitle", data({x.low}, {y.low})));
    text += "plot " + fmt::format("{}", fmt::join(items, ", \\\n  ")) + "\n";
  }

  template <typename Data>
  std::string round(const Circle& circle, Data data) {
    std::vector<double> xs, ys;
    constexpr int corners = 120;
    for (int i = 0; i <= corners; ++i) {
      const double turn = 2.0 * M_PI * i / corners;
      xs.push_back(circle.x + circle.radius * std::cos(turn));
      ys.push_back(circle.y + circle.radius * std::sin(turn));
    }
    return fmt::format("{} using 1:2 with lines {}", data(xs, ys), circle_line());
  }

  /// Uses rectangles instead of an image, which gnuplot would put into a separate file.
  std::string heat(const HeatMap& map, bool log_x, bool log_y) {
    const std::string name = fmt::format("$d{}", ++block_);
    text += name + " << END_OF_DATA\n";
    const std::vector<double> x = cell_edges(map.x, log_x), y = cell_edges(map.y, log_y);
    for (std::size_t j = 0; j < map.y.size(); ++j) {
      for (std::size_t i = 0; i < map.x.size(); ++i) {
        text += fmt::format("{} {} {} {} {} {} {}\n", number(map.x[i]), number(map.y[j]), number(x[i]),
                            number(x[i + 1]), number(y[j]), number(y[j + 1]), number(map.values[j * map.x.size() + i]));
      }
    }
    text += "END_OF_DATA\n";
    line("set colorbox");
    double low = 0.0, high = 0.0;
    for (const double v : map.values) {
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    }
    if (low < high && (map.with_sign || (low < 0.0 && high > 0.0))) {
      const double most = std::max(-low, high);
      line("set palette defined ({})", signed_palette);
      line("set cbrange [{}:{}]", number(-most), number(most));
    } else {
      line("set palette defined ({})", heat_palette);
      line("set cbrange [*:*]");
    }
    line("set cblabel {} offset 0.4,0", quoted(map.label));
    return fmt::format("{} using 1:2:3:4:5:6:7 with boxxyerror fc palette fs solid noborder notitle", name);
  }

  /// Pieces are set apart by empty lines.
  std::string coloured(const ColouredLines& lines) {
    const std::string name = fmt::format("$d{}", ++block_);
    text += name + " << END_OF_DATA\n";
    for (const ColouredLines::Piece& piece : lines.pieces) {
      for (std::size_t i = 0; i < piece.x.size(); ++i)
        text += fmt::format("{:.7g} {:.7g} {:.4g}\n", piece.x[i], piece.y[i], piece.value);
      text += "\n";
    }
    text += "END_OF_DATA\n";
    line("set palette defined ({})", line_palette);
    line("set colorbox\nset cbrange [{}:{}]", number(lines.low), number(lines.high));
    line("set cblabel {} offset 0.4,0", quoted(lines.label));
    return fmt::format("{} using 1:2:3 with lines lw {} lc palette notitle", name, number(lines.line_width));
  }

  int block_ = 0;
  LegendKind legend_ = LegendKind::none;  ///< of the panel being written
};

}  // namespace

std::string gnuplot_script(const Figure& figure) {
  const PageLayout page = layout(figure);
  Writer writer;
  writer.text = fmt::format(
      "set encoding utf8\n"
      "set terminal svg size {:.0f},{:.0f} noenhanced font 'DejaVu Sans,12' background '#ffffff' butt\n"
      "set output\n"
      "set border lw 0.8\nset tics nomirror out scale 0.6\nset xtics offset 0,0.3\nset grid lc rgb '#dddddd' lw 0.6 dt "
      "solid\n"
      "set multiplot\n",
      page.width, page.height);
  if (!page.title.empty()) {
    writer.text += fmt::format("set label 1 {} at screen 0.5,{:.6f} center font 'DejaVu Sans,15'\n", quoted(page.title),
                               1.0 - 20.0 / page.height);
  }
  writer.legend(figure, page);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) writer.panel(figure.panels[i], page.panels[i], page);
  writer.text += "unset multiplot\n";
  return writer.text;
}

}  // namespace accdec
